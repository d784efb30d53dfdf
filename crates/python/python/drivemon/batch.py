"""A folder of recordings judged on many machines: ranges of recordings as tasks of Ray.

    from drivemon import batch

    batch.run("recordings", "motors.toml", "judged.parquet")                        # on this machine
    batch.run("recordings", "motors.toml", "judged.parquet", address="auto")        # on the cluster that it belongs to

`drivemon batch DIR --motor-map MAP -o OUT --engine ray` calls `python -m drivemon.batch`.

The list of recordings is sorted by name, and a task is a range of it. What a task made comes back whole and is kept in `OUT.parts`,
named by the list and the range: a task that is lost is made again, one that ran twice changes nothing, and the same call goes on
where a killed one was. The table has the bytes of one machine's.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Optional, Union

from . import _drivemon, _tasks
from ._errors import InputError
from ._progress import Progress, told
from ._reading import Reading, flags

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["Done", "run"]

PathLike = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Done:
    """A finished table."""

    output: Path
    """Its file."""
    recordings: int
    """Rows in it."""
    fault: int
    """Recordings in which FAULT lit."""
    not_judged: int
    """Recordings of which no window could be judged."""
    not_read: int
    """Recordings that could not be read; their rows say why."""


def run(
    folder: PathLike,
    motor_map: PathLike,
    output: PathLike,
    *,
    address: Optional[str] = None,
    task_seconds: float = 10.0,
    progress: Progress = None,
    **reading: Unpack[Reading],
) -> Done:
    """Judges the recordings in `folder` with Ray and writes one row each to `output` (.parquet).

    `motor_map` says which motor file belongs to which recordings. `address` is that of a Ray cluster (`"auto"`: the one that this
    machine belongs to); without it Ray starts here. Each machine needs this package, and recordings, map and motor files at the same
    path; one that sees others is refused. A task takes about `task_seconds`, so that its overhead does not count. Rows that `output`
    holds already are kept where recording, motor file and `reading` are the same.

    Raises InputError for a map, a folder or a table that does not fit, ImportError without Ray.
    """
    return _run(folder, motor_map, output, flags(reading), address, task_seconds, progress)


def _run(
    folder: PathLike,
    motor_map: PathLike,
    output: PathLike,
    found: Mapping[str, Any],
    address: Optional[str],
    task_seconds: float,
    progress: Progress,
) -> Done:
    _tasks.module()
    output = Path(output)
    asked = (os.fspath(folder), os.fspath(motor_map), os.fspath(output), dict(found))
    batch = _drivemon.Batch(*asked)
    gaps = [range(begin, end) for begin, end in batch.open()]
    parts = output.with_name(output.name + ".parts")
    work = _tasks.Work(
        share=_share,
        arguments=(os.getcwd(), asked, batch.fingerprint),
        keep=lambda items, content: _tasks.write_whole(parts / _tasks.name(batch.fingerprint, items), content),
        first=1,
        said="judging",
    )
    with told(progress) as tell:
        if gaps:
            with _tasks.cluster(address) as ray:
                _tasks.spread(ray, work, gaps, task_seconds, tell)
    return Done(output, *batch.finish())


def _share(home: str, asked: tuple[Any, ...], fingerprint: str, begin: int, end: int) -> tuple[bytes, float]:
    """On a worker: the part of these recordings, and the time that each took, s."""
    _tasks.on_one_core()
    # Rows name files as they were given: seen from where the question was asked.
    with contextlib.suppress(OSError):
        os.chdir(home)
    batch = _drivemon.Batch(*asked)
    if batch.fingerprint != fingerprint:
        raise InputError(
            f"{asked[0]}: this machine has other recordings, another map, other motor files or another version of drivemon", []
        )
    before = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "part.parquet"
        batch.share(begin, end, part, None)
        return part.read_bytes(), (time.process_time() - before) / (end - begin)


def _main() -> int:
    parser = argparse.ArgumentParser(
        prog="drivemon batch --engine ray", description="Judge a folder of recordings with Ray.", allow_abbrev=False
    )
    parser.add_argument("folder", metavar="DIR", help="folder with recordings")
    parser.add_argument("--motor-map", metavar="MAP.toml", required=True, help="which motor file belongs to which recordings")
    parser.add_argument("-o", "--output", metavar="OUT.parquet", required=True, help="table to write")
    parser.add_argument("--reading", metavar="JSON", type=json.loads, default=flags({}), help="flags that say how recordings are read")
    _tasks.add_arguments(parser)
    given = parser.parse_args()

    def ask(progress: Progress) -> int:
        _run(given.folder, given.motor_map, given.output, given.reading, given.address, given.task_seconds, progress)
        return 0

    return _tasks.answered(ask)


if __name__ == "__main__":
    sys.exit(_main())
