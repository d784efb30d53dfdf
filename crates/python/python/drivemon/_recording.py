"""What was measured."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _drivemon
from ._arrow import Columns
from ._columns import arrays, speaks_arrow
from ._motor import Motor
from ._progress import Progress, told
from ._reading import Reading, flags

if TYPE_CHECKING:
    import numpy
    import numpy.typing
    import pandas
    from typing_extensions import Unpack

PathLike = Union[str, "os.PathLike[str]"]


class Recording(Columns[_drivemon.Recording]):
    """Samples over time in SI units, or the operating points of a load test.

    Channels: `t` (s), `va vb vc` (phase to neutral, V), `ia ib ic` (A), `speed` (rad/s), `torque` (N m), `temperature` (degC); a
    second probe has a 2 behind its name. Make one with `from_file`, `from_table` or `drivemon.simulate`.
    """

    def __init__(self, native: _drivemon.Recording) -> None:
        self._native = native

    @staticmethod
    def from_file(path: PathLike, *, progress: Progress = None, **reading: Unpack[Reading]) -> Recording:
        """Reads a file of any recorder: CSV, CSV.gz, Excel, Parquet, MAT, COMTRADE, WAV; the sidecar beside it counts.

        `reading` says what file and sidecar do not: see `Reading`.

        Raises InputError or UnsupportedError with file, line, column and remedy.
        """
        with told(progress) as tell:
            return Recording(_drivemon.Recording.from_file(path, flags(reading), tell))

    @staticmethod
    def from_table(
        table: Any, *, name: str = "table", copy: bool = False, **reading: Unpack[Reading]
    ) -> Recording:
        """Takes a table that is in memory, its columns named as those of a file would be.

        `table` is anything that exports an Arrow stream (polars, pyarrow, DuckDB), a pandas DataFrame, an xarray Dataset, a
        dict of arrays, a structured array, or a 2-dimensional array with `columns="t,va,vb,vc,ia,ib,ic"`. `name` is what
        errors and results call it.

        Contiguous float64 columns in SI are lent, not copied: the recording reads the numbers where they are, and keeps the
        table alive. Do not write into lent numpy arrays while the recording is in use, or pass `copy=True`. Copied are columns
        of other types or units, with gaps in memory or several Arrow chunks, with missing numbers, and those in which spikes
        were bridged. Stamps (datetime64, Arrow timestamps) become seconds since the first.

        Raises InputError or UnsupportedError with column, row and remedy.
        """
        said = flags(reading)
        if speaks_arrow(table):
            return Recording(_drivemon.Recording.from_arrow(table, name, said))
        return Recording(_drivemon.Recording.from_arrays(arrays(table, copy), name, said))

    @property
    def name(self) -> str:
        """The file as it was named, the scenario, or the name of the table."""
        return self._native.name

    @property
    def is_load_table(self) -> bool:
        """Whether this is a load test: operating points instead of samples."""
        return self._native.is_load_table

    @property
    def columns(self) -> list[str]:
        """Names of the columns, the clock first."""
        return self._native.columns

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample, s."""
        return self._native.duration_s

    @property
    def t_sample_s(self) -> float:
        """Median time between two samples, s."""
        return self._native.t_sample_s

    @property
    def assumptions(self) -> list[str]:
        """What had to be assumed to read it, one sentence each."""
        return self._native.assumptions

    def __getitem__(self, column: str) -> numpy.typing.NDArray[numpy.float64]:
        """A column in SI as a read-only numpy array over the recording's own numbers; needs numpy."""
        return self._native.array(column)

    def to_pandas(self) -> pandas.DataFrame:
        """The columns for pandas, which must be installed."""
        import pandas

        return pandas.DataFrame({column: self[column] for column in self.columns})

    def save(self, path: PathLike) -> None:
        """Writes the samples as .csv, .csv.gz or .parquet, and the sidecar beside them."""
        self._native.save(path)

    def audit(self, motor: Optional[Motor] = None) -> dict[str, Any]:
        """What is wrong with the samples before anything is concluded from them; a motor adds what is expected.

        `supported` says whether they can be judged; `findings` hold code, channel, value, unit and the remedy in words.
        """
        found: dict[str, Any] = json.loads(self._native.audit(None if motor is None else motor._native))
        return found
