"""Tables that answers hold."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Iterator, Sequence

from . import _drivemon
from ._arrow import Columns

if TYPE_CHECKING:
    import pandas


class Table(Columns[_drivemon.Table]):
    """Rows of an answer. Units are in the names of the columns; `t` is in s.

    It speaks the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)` and whatever else takes Arrow
    streams read it.
    """

    def __init__(self, rows: Sequence[Any]) -> None:
        flat = [dict(_flat("", row)) for row in rows]
        names = list(dict.fromkeys(name for row in flat for name in row))
        columns = [(name, _cells([row.get(name) for row in flat])) for name in names]
        self._native = _drivemon.Table.of_columns(len(rows), columns)

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self._native.columns

    def to_pandas(self) -> pandas.DataFrame:
        """The table for pandas, which must be installed, and pyarrow with it."""
        frame: Any = self.to_pyarrow().to_pandas()
        return frame


def _flat(parent: str, row: Any) -> Iterator[tuple[str, Any]]:
    """Keys and values of an object and of the objects inside it, whose keys follow their parent's after a point."""
    if not isinstance(row, dict):
        yield parent or "value", row
        return
    for key, value in row.items():
        name = f"{parent}.{key}" if parent else key
        if isinstance(value, dict):
            yield from _flat(name, value)
        else:
            yield name, value


def _cells(cells: list[Any]) -> list[Any]:
    """Cells of one kind; those of several kinds, and lists of anything but numbers, become text."""
    known = [cell for cell in cells if cell is not None]
    if all(isinstance(cell, bool) for cell in known) or all(_is_number(cell) for cell in known):
        return cells
    if all(isinstance(cell, list) and all(map(_is_number, cell)) for cell in known):
        return cells
    return [cell if cell is None or isinstance(cell, str) else json.dumps(cell) for cell in cells]


def _is_number(cell: object) -> bool:
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)
