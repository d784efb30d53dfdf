"""Why there is no answer: what is wrong, where, and what to do about it."""

from __future__ import annotations

from typing import Iterable, NamedTuple, Optional


class Problem(NamedTuple):
    """One problem at one place of an input."""

    file: str
    """The file or table, as it was named."""
    line: int
    """Line of a file or row of a table, counted from 1; 0 where the whole is meant."""
    column: str
    """Column of a recording, or key of a motor file, scenario or sidecar; empty where none is to blame."""
    message: str
    """What is wrong."""
    remedy: str
    """What to do about it; empty where the message says it."""


class Error(Exception):
    """No answer. `str()` says everything; `problems` holds it in pieces, the first of them as attributes too."""

    def __init__(self, message: str, problems: Iterable[tuple[str, int, str, str, str]] = ()) -> None:
        super().__init__(message)
        self.problems: tuple[Problem, ...] = tuple(Problem(*problem) for problem in problems)

    def __reduce__(self) -> tuple[type[Error], tuple[str, tuple[Problem, ...]]]:
        return type(self), (str(self), self.problems)

    @property
    def file(self) -> Optional[str]:
        """The file or table of the first problem."""
        return self.problems[0].file if self.problems else None

    @property
    def line(self) -> Optional[int]:
        """The line or row of the first problem, counted from 1."""
        return (self.problems[0].line or None) if self.problems else None

    @property
    def column(self) -> Optional[str]:
        """The column or key of the first problem."""
        return (self.problems[0].column or None) if self.problems else None

    @property
    def remedy(self) -> Optional[str]:
        """What to do about the first problem."""
        return (self.problems[0].remedy or None) if self.problems else None


class InputError(Error):
    """The input is malformed, or the question is: the user corrects it. The commands end with exit code 2."""


class UnsupportedError(Error):
    """The input is sound, but does not support an answer. The commands end with exit code 3."""
