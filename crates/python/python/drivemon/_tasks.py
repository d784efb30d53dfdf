"""Work of many like items as tasks of Ray.

A task is a range of items. What it made comes back whole as bytes, so no folder needs to be shared for results; a task that is lost
is made again, and one that ran twice says the same.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Iterator, Optional

from ._errors import Error
from ._progress import Progress, ProgressCallback

_MOST_ITEMS = 100_000
"""A task is lost with its worker: it stays small enough to be made again."""
_IN_FLIGHT = 2
"""Tasks handed out for each core, so that no worker waits."""
_RETRIES = 100
"""How often a task whose worker died is given to another one."""


@dataclass(frozen=True)
class Work:
    """What is done with the items."""

    share: Callable[..., tuple[bytes, float]]
    """On a worker: the bytes of the items `begin..end`, its last arguments, and the time that each took, s."""
    arguments: tuple[Any, ...]
    """Its first arguments."""
    keep: Callable[[range, bytes], None]
    """Here: keeps what a task made, whole or not at all."""
    first: int
    """Items of the first tasks, which tell how long one takes, and of the smallest."""
    said: str
    """What progress says."""


def module() -> Any:
    """Ray."""
    try:
        import ray
    except ImportError as error:
        raise ImportError("this engine is Ray, which is not installed: pip install ray") from error
    return ray


@contextmanager
def cluster(address: Optional[str]) -> Iterator[Any]:
    """Ray, connected or started: what was started here is ended."""
    ray = module()
    started = not ray.is_initialized()
    if started:
        ray.init(address=address, include_dashboard=False if address is None else None, log_to_driver=False)
    try:
        yield ray
    finally:
        if started:
            ray.shutdown()


def on_one_core() -> None:
    """On a worker: one thread, because Ray gives each core a task."""
    # Not as an environment of Ray's: for it, the workers that are there already would be ended and others started.
    os.environ["RAYON_NUM_THREADS"] = "1"


def spread(ray: Any, work: Work, gaps: list[range], task_seconds: float, tell: Optional[ProgressCallback]) -> None:
    """Hands out the items of `gaps`, and keeps what comes back."""
    task = ray.remote(num_cpus=1, max_retries=_RETRIES)(work.share)
    gaps = list(gaps)
    wanted, made = sum(map(len, gaps)), 0
    at_once = _IN_FLIGHT * max(1, int(ray.cluster_resources().get("CPU", 1)))
    size = work.first
    pending: dict[Any, range] = {}
    while gaps or pending:
        while gaps and len(pending) < at_once:
            items, rest = gaps[0][:size], gaps[0][size:]
            gaps[:1] = [rest] if rest else []
            pending[task.remote(*work.arguments, items.start, items.stop)] = items
        ready, _ = ray.wait(list(pending), num_returns=1)
        for one in ready:
            items = pending.pop(one)
            content, seconds = ray.get(one)
            work.keep(items, content)
            made += len(items)
            # What is left ends at the same time on all cores.
            left = sum(map(len, gaps))
            fair = math.ceil(left / at_once) if left else work.first
            size = max(work.first, min(math.ceil(task_seconds / max(seconds, 1e-6)), _MOST_ITEMS, fair))
            if tell is not None:
                tell(work.said, made / wanted)


def name(fingerprint: str, items: range) -> str:
    """The file of a range of items."""
    return f"{fingerprint}-{items.start:09}-{items.stop:09}.parquet"


def write_whole(path: Path, content: bytes) -> None:
    """A file is whole or absent."""
    unfinished = path.with_suffix(".unfinished")
    unfinished.write_bytes(content)
    os.replace(unfinished, path)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What every command line that uses Ray takes."""
    parser.add_argument("--address", help="address of a Ray cluster, or auto; without it Ray starts on this machine")
    parser.add_argument("--task-seconds", metavar="S", type=float, default=10.0, help="time that a task takes, s")


def answered(ask: Callable[[Progress], int]) -> int:
    """The exit code of a command: what `ask` gives, or 2 with the reason."""
    try:
        return ask(_line if sys.stderr.isatty() else None)
    except (Error, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _line(what: str, share: float) -> None:
    end = "\n" if share >= 1.0 else ""
    print(f"\r{what} {share:4.0%}", end=end, file=sys.stderr, flush=True)
