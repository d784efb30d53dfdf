"""Campaigns on many machines: the runs of a plan as tasks of Ray.

    from drivemon import campaign

    campaign.run("campaigns/detection.toml", "detection.parquet")                      # on this machine
    campaign.run("campaigns/detection.toml", "detection.parquet", address="auto")      # on the cluster that it belongs to

`python -m drivemon.campaign PLAN -o RESULT` is the same, and what `drivemon campaign run PLAN -o RESULT --engine ray` calls.

A run follows from its index alone, so a task is a range of indices. What a task made comes back whole and is kept in
`RESULT.shares`, named by the campaign and the range: a task that is lost is made again, one that ran twice changes nothing, and
the same call goes on where a killed one was. The result has the bytes of one machine's.
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, Optional, Union

from . import _drivemon
from ._errors import Error, InputError
from ._progress import Progress, told

__all__ = ["Done", "run"]

PathLike = Union[str, "os.PathLike[str]"]

_FIRST_RUNS = 16
"""Runs of the first tasks, which tell how long one takes."""
_MOST_RUNS = 100_000
"""A task is lost with its worker: it stays small enough to be made again."""
_IN_FLIGHT = 2
"""Tasks handed out for each core, so that no worker waits."""
_RETRIES = 100
"""How often a task whose worker died is given to another one."""


@dataclass(frozen=True)
class Done:
    """A finished campaign."""

    output: Path
    """Its results."""
    rows: int
    """Runs in them."""
    fault_on_healthy: int
    """Runs in which FAULT was lit on a healthy motor."""


def run(
    plan: PathLike,
    output: PathLike,
    *,
    begin: int = 0,
    end: Optional[int] = None,
    address: Optional[str] = None,
    task_seconds: float = 10.0,
    progress: Progress = None,
) -> Done:
    """Makes runs `begin..end` of a plan with Ray and writes them to `output`.

    `address` is that of a Ray cluster (`"auto"`: the one that this machine belongs to); without it Ray starts here. Each machine
    needs this package, and the plan with its motor files at the same path; one whose files differ is refused. A task takes about
    `task_seconds`, so that its overhead does not count.

    Raises InputError for a plan or a result that does not fit, ImportError without Ray.
    """
    ray = _ray()
    path, output = Path(plan).resolve(), Path(output)
    about = _drivemon.Plan(path)
    last = about.runs if end is None else end
    if not 0 <= begin < last <= about.runs:
        raise InputError(f"runs {begin}..{last}: the plan has runs 0..{about.runs}, none of them in this range", [])
    finished = about.finished(begin, last, output)
    if finished is not None:
        return Done(output, *finished)
    shares = output.with_name(output.name + ".shares")
    shares.mkdir(parents=True, exist_ok=True)
    started = not ray.is_initialized()
    if started:
        # One thread per task: Ray gives each core one.
        threads = {"env_vars": {"RAYON_NUM_THREADS": "1"}}
        ray.init(address=address, runtime_env=threads, include_dashboard=False if address is None else None, log_to_driver=False)
    try:
        with told(progress) as tell:
            _make(ray, path, about.fingerprint, _missing(shares, about.fingerprint, begin, last), shares, task_seconds, tell)
    finally:
        if started:
            ray.shutdown()
    parts = [share for share, _, _ in _there(shares, about.fingerprint)]
    rows, lit = _drivemon.merge(parts, output)
    shutil.rmtree(shares)
    return Done(output, rows, lit)


def _ray() -> Any:
    try:
        import ray
    except ImportError as error:
        raise ImportError("this engine is Ray, which is not installed: pip install ray") from error
    return ray


def _share(path: Path, fingerprint: str, begin: int, end: int) -> tuple[bytes, float]:
    """On a worker: the file of these runs, and the time that each took, s."""
    plan = _drivemon.Plan(path)
    if plan.fingerprint != fingerprint:
        raise InputError(f"{path}: this machine has another plan, other motor files or another version of drivemon", [])
    before = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "share.parquet"
        plan.share(begin, end, part, None)
        return part.read_bytes(), (time.process_time() - before) / (end - begin)


def _make(
    ray: Any, path: Path, fingerprint: str, gaps: list[range], shares: Path, task_seconds: float, tell: Any
) -> None:
    """Hands out the missing runs, and keeps what comes back."""
    task = ray.remote(num_cpus=1, max_retries=_RETRIES)(_share)
    wanted, made = sum(map(len, gaps)), 0
    at_once = _IN_FLIGHT * max(1, int(ray.cluster_resources().get("CPU", 1)))
    size = _FIRST_RUNS
    pending: dict[Any, range] = {}
    while gaps or pending:
        while gaps and len(pending) < at_once:
            runs, rest = gaps[0][:size], gaps[0][size:]
            gaps[:1] = [rest] if rest else []
            pending[task.remote(path, fingerprint, runs.start, runs.stop)] = runs
        ready, _ = ray.wait(list(pending), num_returns=1)
        for one in ready:
            runs = pending.pop(one)
            content, seconds = ray.get(one)
            _keep(shares, fingerprint, runs, content)
            made += len(runs)
            # What is left ends at the same time on all cores.
            left = sum(map(len, gaps))
            fair = math.ceil(left / at_once) if left else _FIRST_RUNS
            size = max(_FIRST_RUNS, min(math.ceil(task_seconds / max(seconds, 1e-6)), _MOST_RUNS, fair))
            if tell is not None:
                tell("making runs", made / wanted)


def _name(fingerprint: str, runs: range) -> str:
    return f"{fingerprint}-{runs.start:09}-{runs.stop:09}.parquet"


def _keep(shares: Path, fingerprint: str, runs: range, content: bytes) -> None:
    """A share is whole or absent."""
    share = shares / _name(fingerprint, runs)
    unfinished = share.with_suffix(".unfinished")
    unfinished.write_bytes(content)
    os.replace(unfinished, share)


def _there(shares: Path, fingerprint: str) -> Iterator[tuple[Path, int, int]]:
    """Shares of this campaign that are there, in their order."""
    for share in sorted(shares.glob(f"{fingerprint}-*.parquet")):
        _, begin, end = share.stem.rsplit("-", 2)
        yield share, int(begin), int(end)


def _missing(shares: Path, fingerprint: str, begin: int, end: int) -> list[range]:
    """Ranges that no share holds."""
    strangers = [share for share in shares.glob("*.parquet") if not share.name.startswith(fingerprint)]
    if strangers:
        raise InputError(
            f"{strangers[0]}: belongs to another campaign: plan, motor files or program have changed since; remove the folder", []
        )
    gaps, at = [], begin
    for _, first, last in _there(shares, fingerprint):
        if first < begin or last > end:
            raise InputError(f"{shares}: holds runs outside {begin}..{end}: finish that range first, or remove the folder", [])
        if at < first:
            gaps.append(range(at, first))
        at = max(at, last)
    if at < end:
        gaps.append(range(at, end))
    return gaps


def _main() -> int:
    parser = argparse.ArgumentParser(
        prog="drivemon campaign run --engine ray", description="Make the runs of a plan with Ray.", allow_abbrev=False
    )
    parser.add_argument("plan", metavar="PLAN", help="plan file")
    parser.add_argument("-o", "--output", metavar="RESULT", required=True, help="results to write (.parquet)")
    parser.add_argument("--from", dest="begin", metavar="INDEX", type=int, default=0, help="first run")
    parser.add_argument("--to", dest="end", metavar="INDEX", type=int, help="run after the last")
    parser.add_argument("--address", help="address of a Ray cluster, or auto; without it Ray starts on this machine")
    parser.add_argument("--task-seconds", metavar="S", type=float, default=10.0, help="time that a task takes, s")
    given = parser.parse_args()
    progress: Progress = _line if sys.stderr.isatty() else None
    try:
        done = run(
            given.plan,
            given.output,
            begin=given.begin,
            end=given.end,
            address=given.address,
            task_seconds=given.task_seconds,
            progress=progress,
        )
    except (Error, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{done.output}: {done.rows} runs, FAULT on a healthy motor in {done.fault_on_healthy} of them")
    return 1 if done.fault_on_healthy else 0


def _line(what: str, share: float) -> None:
    end = "\n" if share >= 1.0 else ""
    print(f"\r{what} {share:4.0%}", end=end, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(_main())
