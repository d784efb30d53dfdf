"""Tables that answers hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _drivemon

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Table:
    """Rows of an answer. Units are in the names of the columns; `t` is in s.

    It speaks the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)` and whatever else takes Arrow
    streams read it.
    """

    def __init__(self, native: _drivemon.Table) -> None:
        self._native = native

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self._native.columns

    def __len__(self) -> int:
        return len(self._native)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._native.__arrow_c_stream__(requested_schema)

    def to_pyarrow(self) -> pyarrow.Table:
        """The table for pyarrow, which must be installed."""
        import pyarrow

        return pyarrow.table(self)

    def to_polars(self) -> polars.DataFrame:
        """The table for polars, which must be installed."""
        import polars

        return polars.DataFrame(self)

    def to_pandas(self) -> pandas.DataFrame:
        """The table for pandas, which must be installed, and pyarrow with it."""
        frame: Any = self.to_pyarrow().to_pandas()
        return frame  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return repr(self._native)
