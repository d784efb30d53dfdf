"""What is believed of a motor."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple, Optional, Union

from . import _drivemon

PathLike = Union[str, "os.PathLike[str]"]
Number = Union[float, int, str]

#: The order in which numbers of a plate are read: a code letter needs what its current is a ratio to.
_PLATE = (
    "name",
    "power_kw",
    "power_hp",
    "voltage_volt",
    "frequency_hz",
    "speed_rpm",
    "current_amp",
    "power_factor",
    "efficiency_percent",
    "breakdown_torque_ratio",
    "locked_rotor_torque_ratio",
    "locked_rotor_current_ratio",
    "connection",
    "inertia_kg_m2",
    "rotor_bars",
    "dc_resistance_ohm",
    "dc_resistance_degc",
    "nema_code",
)


class Parameter(NamedTuple):
    """A parameter of a motor; its unit is the end of its name."""

    name: str
    value: float
    low: Optional[float]
    """Lower end of the 95 % interval, where one is known."""
    high: Optional[float]
    """Upper end of the 95 % interval, where one is known."""


class Motor:
    """A motor as it is believed to be: nameplate, T model, mechanics, sensors, thresholds, effects.

    One TOML file per motor (docs/motor-file.md). Make one with `from_file`, `from_text` or `from_nameplate`.
    """

    def __init__(self, native: _drivemon.Motor) -> None:
        self._native = native

    @staticmethod
    def from_file(path: PathLike) -> Motor:
        """Reads a motor file.

        Raises InputError with file, line and key where something in it is wrong.
        """
        return Motor(_drivemon.Motor.from_file(path))

    @staticmethod
    def from_text(text: str, name: str = "motor.toml") -> Motor:
        """Reads the text of a motor file; `name` is what errors call it."""
        return Motor(_drivemon.Motor.from_text(text, name))

    @staticmethod
    def from_nameplate(plate: Optional[PathLike] = None, **numbers: Number) -> Motor:
        """A motor from the numbers on its plate, every parameter with a 95 % interval.

        `plate` is a TOML file of the same keys; `numbers` win over it. Power, voltage and speed are enough, every further
        number narrows the intervals. Digits count: give "0.850" as text where the plate prints three digits.

        Keys: name, power_kw or power_hp, voltage_volt (line, rms), frequency_hz, speed_rpm, current_amp (line, rms),
        power_factor, efficiency_percent, breakdown_torque_ratio, locked_rotor_torque_ratio, locked_rotor_current_ratio or
        nema_code, connection ("star" or "delta"), inertia_kg_m2 (all on the shaft), rotor_bars, dc_resistance_ohm (between two
        terminals), dc_resistance_degc.

        Raises InputError where numbers are missing, unknown or outside what motors have. Numbers that contradict each other
        raise nothing: see `contradictions`.
        """
        order = {key: k for k, key in enumerate(_PLATE)}
        texts = [(key, str(number)) for key, number in numbers.items()]
        texts.sort(key=lambda pair: order.get(pair[0], len(order)))
        return Motor(_drivemon.Motor.from_nameplate(plate, texts))

    @property
    def name(self) -> str:
        """What people call the motor."""
        return self._native.name

    @property
    def text(self) -> str:
        """The motor file's text, its author's comments included."""
        return self._native.text

    @property
    def path(self) -> Optional[Path]:
        """Where the motor file lies; None for a text or a plate."""
        path = self._native.path
        return None if path is None else Path(path)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters of the T model by their keys (`stator_resistance_ohm`, ...), with intervals where they are known."""
        return {row[0]: Parameter(*row) for row in self._native.parameters()}

    @property
    def effects(self) -> list[str]:
        """Names of the physical effects in force beyond the T model."""
        return self._native.effects

    @property
    def is_calibrated(self) -> bool:
        """Whether it was ever seen in good order: without that only large faults show."""
        return self._native.is_calibrated

    @property
    def contradictions(self) -> list[str]:
        """Numbers of the plate that exclude each other, in words."""
        return self._native.contradictions

    def save(self, path: PathLike) -> None:
        """Writes the motor file."""
        Path(path).write_text(self.text, encoding="utf-8")

    def __repr__(self) -> str:
        return f'<drivemon.Motor "{self.name}">'
