"""A program of a user, which `mypy --strict` passes and which runs."""

from __future__ import annotations

import pathlib
import sys
from typing import Optional

import numpy as np
import polars

import drivemon

ROOT = pathlib.Path(__file__).resolve().parents[3]
PEER = ROOT / "tests/data/peer/none"


def told(what: str, share: float) -> None:
    print(f"{100 * share:5.1f} % {what}", file=sys.stderr)


def main() -> None:
    motor = drivemon.Motor.from_file(PEER / "motor.toml")
    recording = drivemon.Recording.from_file(PEER / "recording_b.csv.gz", progress=told)
    frame: polars.DataFrame = recording.to_polars()
    again = drivemon.Recording.from_table(frame, name="frame", unit={"speed": "rad/s"}, skip_missing=True)
    largest: float = float(np.abs(again["ia"]).max())
    answer = drivemon.monitor(again, motor)
    if isinstance(answer, drivemon.Monitored):
        alarm: Optional[float] = answer.first_alarm_s
        residuals: polars.DataFrame = answer.residuals.to_polars()
        print(answer.state, alarm, residuals.height, largest)
    compared: drivemon.Compared = drivemon.compare(again, motor, progress=told)
    error: Optional[float] = compared.error_over_noise
    print(error)
    try:
        drivemon.Motor.from_text("name = 1")
    except drivemon.InputError as wrong:
        problem: drivemon.Problem = wrong.problems[0]
        print(problem.file, problem.line, problem.column, problem.remedy)


if __name__ == "__main__":
    main()
