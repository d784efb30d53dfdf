"""Prints what the package costs beside the work itself: memory of a table, time of a call, time until a question ends."""

from __future__ import annotations

import subprocess
import sys
import time

import drivemon
from conftest import LOAD_MOTOR, LOAD_TEST, PEER
from test_tables import MEMORY

CALLS = 500


def memory() -> None:
    for kind, how in [("dict", "lend"), ("polars", "lend"), ("pyarrow", "lend"), ("pandas", "lend"), ("dict", "copy")]:
        done = subprocess.run([sys.executable, "-c", MEMORY, kind, how], capture_output=True, text=True, check=True)
        grown, size = map(float, done.stdout.split())
        what = "numpy arrays" if kind == "dict" else kind
        print(f"{size:.0f} MiB of numbers, {what}, {how}: the process grows by {grown:.0f} MiB")


def calls() -> None:
    table, motor = drivemon.Recording.from_file(LOAD_TEST), drivemon.Motor.from_file(LOAD_MOTOR)
    begin = time.perf_counter()
    for _ in range(CALLS):
        drivemon.monitor(table, motor)
    print(f"a call, work on 14 points included: {1e3 * (time.perf_counter() - begin) / CALLS:.2f} ms")


class Enough(Exception):
    pass


def ends() -> None:
    folder = PEER / "magnetizing-saturation"
    pair = [drivemon.Recording.from_file(folder / name) for name in ("recording.csv.gz", "recording_b.csv.gz")]
    motor = drivemon.Motor.from_file(folder / "motor.toml")
    begin = time.process_time()
    drivemon.explain(pair, motor)
    print(f"explain of two recordings: {time.process_time() - begin:.1f} s of processor time")
    for share in (0.0, 0.1, 0.5):

        def tell(what: str, done: float) -> None:
            if done >= share:
                raise Enough

        try:
            drivemon.explain(pair, motor, progress=tell)
        except Enough:
            begin = time.process_time()
            before = -1.0
            while time.process_time() - before > 0.01:
                before = time.process_time()
                time.sleep(0.3)
            print(f"broken off at {100 * share:.0f} %: {time.process_time() - begin:.1f} s of processor time more")


if __name__ == "__main__":
    memory()
    calls()
    ends()
