"""How a file or a table is to be read, in the words of the commands' flags."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, Sequence, TypedDict, Union

if TYPE_CHECKING:
    PathLike = Union[str, os.PathLike[str]]


class Reading(TypedDict, total=False):
    """How the columns become channels in SI units. All keys may be left out; a sidecar beside a file says the same things.

    Channels are `t`, `va vb vc` (V), `ia ib ic` (A), `speed` (rad/s), `torque` (N m), `temperature` (degC).
    """

    column: Mapping[str, str]
    """The column that a channel is read from: `{"ia": "I1", "speed": "n"}`; line voltages are `vab`, `vbc`, `vca`."""
    columns: Union[str, Sequence[str]]
    """The channels of all columns in their order, `-` for one that is not used: `"t,va,vb,vc,-,ia"`."""
    sensor: Mapping[str, str]
    """The sensor behind a column: `{"i": "100mV/A", "va": "1000:1", "speed": "60V/1000rpm"}`."""
    unit: Mapping[str, str]
    """The unit of a column: `{"speed": "rpm", "ia": "mA", "t": "ms"}`."""
    scale: Mapping[str, Union[float, str]]
    """Factor on a channel, applied after the offset; `{"speed": "unknown"}` lets compare, explain and adopt fit it."""
    offset: Mapping[str, float]
    """Raw reading of a channel at zero."""
    delay: Mapping[str, str]
    """How much later than its row a channel was sampled: `{"ia": "11.55us"}`."""
    sample_rate_hz: float
    """Sampling rate of a table without a clock, Hz."""
    line_voltages: bool
    """Whether `va vb vc` hold the line voltages v_ab, v_bc, v_ca."""
    skip_missing: bool
    """Whether rows without a number are left out instead of refused."""
    delimiter: str
    """What separates the columns of a text file, where the file does not show it."""
    decimal_comma: bool
    """Whether numbers of a text file are written 3,7."""
    thousands: str
    """Separator of thousands: `.`, `,`, `'`, `space` or `none`."""
    date_order: str
    """Order of day and month in dates: `dmy` or `mdy`."""
    pulses_per_revolution: int
    """Pulses of the encoder in one turn, where the speed column holds its counts or the time between them."""
    sidecar: "PathLike"
    """The sidecar: voltages held or instantaneous, full scales, noise, what the load is."""


_LISTS = ("column", "sensor", "unit", "scale", "offset", "delay")
_TEXTS = ("delimiter", "thousands", "date_order")
_SWITCHES = ("line_voltages", "skip_missing", "decimal_comma")
_KNOWN = {*_LISTS, *_TEXTS, *_SWITCHES, "columns", "sample_rate_hz", "pulses_per_revolution", "sidecar"}


def flags(reading: Mapping[str, Any]) -> dict[str, Any]:
    """The flags as the commands take them."""
    unknown = sorted(set(reading) - _KNOWN)
    if unknown:
        raise TypeError(f"{unknown[0]} says nothing about how to read; use one of {', '.join(sorted(_KNOWN))}")
    found: dict[str, Any] = {key: [f"{k}={v}" for k, v in reading.get(key, {}).items()] for key in _LISTS}
    found.update({key: reading.get(key) for key in _TEXTS})
    found.update({key: bool(reading.get(key, False)) for key in _SWITCHES})
    columns = reading.get("columns")
    found["columns"] = columns if columns is None or isinstance(columns, str) else ",".join(columns)
    rate = reading.get("sample_rate_hz")
    found["sample_rate"] = None if rate is None else float(rate)
    found["pulses_per_revolution"] = reading.get("pulses_per_revolution")
    found["sidecar"] = reading.get("sidecar")
    return found
