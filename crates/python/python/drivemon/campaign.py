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
import os
import shutil
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, Optional, Union

from . import _drivemon, _tasks
from ._errors import InputError
from ._progress import Progress, told

__all__ = ["Done", "run"]

PathLike = Union[str, "os.PathLike[str]"]

_FIRST_RUNS = 16
"""Runs of the first tasks, which tell how long one takes."""


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
    _tasks.module()
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
    work = _tasks.Work(
        share=_share,
        arguments=(path, about.fingerprint),
        keep=lambda runs, content: _tasks.write_whole(shares / _tasks.name(about.fingerprint, runs), content),
        first=_FIRST_RUNS,
        said="making runs",
    )
    missing = _missing(shares, about.fingerprint, begin, last)
    with _tasks.cluster(address) as ray, told(progress) as tell:
        _tasks.spread(ray, work, missing, task_seconds, tell)
    parts = [share for share, _, _ in _there(shares, about.fingerprint)]
    rows, lit = _drivemon.merge(parts, output)
    shutil.rmtree(shares)
    return Done(output, rows, lit)


def _share(path: Path, fingerprint: str, begin: int, end: int) -> tuple[bytes, float]:
    """On a worker: the file of these runs, and the time that each took, s."""
    _tasks.on_one_core()
    plan = _drivemon.Plan(path)
    if plan.fingerprint != fingerprint:
        raise InputError(f"{path}: this machine has another plan, other motor files or another version of drivemon", [])
    before = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "share.parquet"
        plan.share(begin, end, part, None)
        return part.read_bytes(), (time.process_time() - before) / (end - begin)


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
    _tasks.add_arguments(parser)
    given = parser.parse_args()

    def ask(progress: Progress) -> int:
        done = run(
            given.plan,
            given.output,
            begin=given.begin,
            end=given.end,
            address=given.address,
            task_seconds=given.task_seconds,
            progress=progress,
        )
        print(f"{done.output}: {done.rows} runs, FAULT on a healthy motor in {done.fault_on_healthy} of them")
        return 1 if done.fault_on_healthy else 0

    return _tasks.answered(ask)


if __name__ == "__main__":
    sys.exit(_main())
