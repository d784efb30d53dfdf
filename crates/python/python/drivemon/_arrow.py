"""What everything that holds columns hands to other libraries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from . import _drivemon

if TYPE_CHECKING:
    import polars
    import pyarrow

Native = TypeVar("Native", _drivemon.Recording, _drivemon.Table)


class Columns(Generic[Native]):
    """Columns behind the Arrow PyCapsule interface: whatever takes Arrow streams reads them, without a copy."""

    _native: Native

    def __len__(self) -> int:
        return len(self._native)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._native.__arrow_c_stream__(requested_schema)

    def to_pyarrow(self) -> pyarrow.Table:
        """The columns for pyarrow, which must be installed; nothing is copied."""
        import pyarrow

        return pyarrow.table(self)

    def to_polars(self) -> polars.DataFrame:
        """The columns for polars, which must be installed."""
        import polars

        return polars.DataFrame(self)

    def __repr__(self) -> str:
        return repr(self._native)
