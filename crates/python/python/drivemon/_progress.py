"""Progress of long questions."""

from __future__ import annotations

from contextlib import contextmanager
from typing import Callable, Iterator, Optional, Union

ProgressCallback = Callable[[str, float], object]
"""Is told what is being done and how far it is, 0 to 1; an exception that it raises ends the question."""

Progress = Union[None, bool, ProgressCallback]
"""`True` shows a bar of tqdm."""


@contextmanager
def told(progress: Progress) -> Iterator[Optional[ProgressCallback]]:
    """What the question calls."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        from tqdm.auto import tqdm

        form = "{l_bar}{bar}| {elapsed}<{remaining}"
        with tqdm(total=100.0, bar_format=form) as bar:

            def tell(what: str, share: float) -> None:
                bar.set_description(what, refresh=False)
                bar.update(100.0 * share - bar.n)

            yield tell
    else:
        yield progress
