"""Tables of other libraries as columns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Iterator, Optional

from ._errors import InputError

Columns = list[tuple[str, Any]]


def speaks_arrow(table: object) -> bool:
    """Whether a table exports an Arrow stream. A pandas frame has its numbers as numpy arrays, and needs pyarrow to export."""
    return hasattr(table, "__arrow_c_stream__") and not _is_pandas(table)


def arrays(table: Any, copy: bool) -> Columns:
    """The columns of a table as numpy arrays of `float64`; None in the place of one that holds something else."""
    return [(name, _numbers(values, name, copy)) for name, values in _columns(table)]


def _is_pandas(table: object) -> bool:
    return type(table).__module__.split(".")[0] == "pandas"


def _columns(table: Any) -> Iterator[tuple[str, Any]]:
    if _is_pandas(table) and hasattr(table, "columns"):
        if table.index.name == "t":
            yield "t", table.index.to_numpy()
        for k, name in enumerate(table.columns):
            yield str(name), table.iloc[:, k]
        return
    if hasattr(table, "data_vars") and hasattr(table, "variables"):  # xarray.Dataset: its clock is a coordinate
        table = table.variables
    if isinstance(table, Mapping):
        for name, values in table.items():
            yield str(name), values
        return
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names:
        for name in names:
            yield str(name), table[name]
        return
    if getattr(table, "ndim", 0) == 2:
        for k in range(table.shape[1]):
            yield f"column {k + 1}", table[:, k]
        return
    kind = type(table).__name__
    raise InputError(
        f"{kind} is no table; give a polars, pandas, pyarrow or xarray table, a dict of arrays, "
        'or a 2-dimensional array with columns="t,va,..."'
    )


def _numbers(values: Any, name: str, copy: bool) -> Optional[Any]:
    import numpy as np

    array = _array(values)
    if array.ndim != 1:
        raise InputError(f"{name} has {array.ndim} dimensions; give one value per sample")
    if array.dtype.kind == "M":
        since = array - array[:1]
        return since / np.timedelta64(1, "s")
    if array.dtype.kind == "m":
        return array / np.timedelta64(1, "s")
    if array.dtype.kind not in "fiu":
        return None
    if isinstance(array, np.ma.MaskedArray):
        return np.ma.filled(array.astype(np.float64), np.nan)
    if copy:
        return np.array(array, dtype=np.float64)
    return np.ascontiguousarray(array, dtype=np.float64)


def _array(values: Any) -> Any:
    import numpy as np

    if isinstance(values, np.ndarray):
        return values
    if _is_pandas(values) and not isinstance(values.dtype, np.dtype) and values.dtype.kind in "fiu":
        # pandas' own number types: a missing number is its NA.
        return values.to_numpy(dtype="float64", na_value=np.nan)
    return np.asarray(values)
