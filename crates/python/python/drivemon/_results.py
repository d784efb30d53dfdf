"""Answers as objects."""

from __future__ import annotations

import html
import json as _json
import os
from functools import cached_property
from pathlib import Path
from typing import Any, Optional, Union

from . import _drivemon
from ._motor import Motor
from ._table import Table

PathLike = Union[str, "os.PathLike[str]"]

#: Height of a page in a notebook, pixels.
_HEIGHT = 640


class Result:
    """An answer, the same that a command gives."""

    def __init__(self, native: _drivemon.Answer) -> None:
        self._native = native

    @cached_property
    def json(self) -> str:
        """The text that `--json FILE` of the command writes, to the last byte."""
        return self._native.json()

    @cached_property
    def data(self) -> dict[str, Any]:
        """The same as Python objects; docs/python.md says where its keys are described."""
        found: dict[str, Any] = _json.loads(self.json)
        return found

    def table(self, path: str) -> Table:
        """A list of the JSON as a table: `"signals"`, `"final.parameters"`, `"steps.0.parameters"`.

        Raises KeyError where there is no such list.
        """
        found: Any = self.data
        for key in path.split("."):
            try:
                found = found[int(key) if isinstance(found, list) else key]
            except (IndexError, KeyError, TypeError, ValueError):
                raise KeyError(f"{path}: this answer has no such list") from None
        if not isinstance(found, list):
            raise KeyError(f"{path}: this answer has no such list")
        return Table(found)

    @property
    def motor(self) -> Optional[Motor]:
        """The motor as it is known after the question, where the question teaches something."""
        motor = self._native.motor
        return None if motor is None else Motor(motor)


class Page(Result):
    """An answer with a page of figures."""

    @cached_property
    def page(self) -> str:
        """The page that `--report FILE.html` of the command writes: one file, no network."""
        return self._native.page()

    def report(self, path: PathLike) -> None:
        """Writes the page."""
        Path(path).write_text(self.page, encoding="utf-8")

    def _repr_html_(self) -> str:
        page = html.escape(self.page, quote=True)
        style = f"width:100%;height:{_HEIGHT}px;border:0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'


class Monitored(Page):
    """What the lamps would have shown (`drivemon monitor`)."""

    @property
    def state(self) -> str:
        """`healthy`, `fault` or `not-judged`: at rest and in motion together."""
        return str(self.data["state"])

    @property
    def candidates(self) -> list[dict[str, Any]]:
        """Possible causes of a fault that was seen at rest, likeliest first: `fault`, `phase`, `probability`."""
        return list(self.data["verdict"]["candidates"])

    @property
    def first_alarm_s(self) -> Optional[float]:
        """When FAULT first lit at rest, s."""
        return self.data["first_alarm_s"]  # type: ignore[no-any-return]

    @property
    def motion_alarms(self) -> list[dict[str, Any]]:
        """FAULT in motion: `onset_s`, `raised_s` (s), `statistic`, `cause`."""
        return list(self.data["motion"]["alarms"])

    @property
    def judged(self) -> int:
        """Windows that were judged."""
        return int(self.data["judged"])

    @property
    def windows(self) -> int:
        """All windows."""
        return int(self.data["windows"])

    @property
    def lamps(self) -> Table:
        """The lamps at every change."""
        return self.table("lamps")

    @property
    def residuals(self) -> Table:
        """Residuals of every window: `t` (s), `r_percent` (r1 to r4, percent of their scales), `judged`."""
        return self.table("residuals")

    @property
    def operation(self) -> Table:
        """What the machine did in every window: voltage, current, frequency, speed, torque, unbalance."""
        return self.table("operation")


class OperatingPoints(Page):
    """The points of a load test with what follows from them (`drivemon monitor` on a load table)."""

    @property
    def points(self) -> Table:
        """One row per point: power (W), current (A rms), speed (rpm), slip (percent), torque (N m), losses (W)."""
        return self.table("operating_points")


class Checked(Page):
    """Whether a motor is in good order (`drivemon check`)."""

    @property
    def state(self) -> str:
        """`healthy`, `fault` or `not-judged`, over all recordings: a fault outweighs what was not judged."""
        states = {str(one["verdict"]["state"]) for one in self.data["recordings"]}
        if "fault" in states:
            return "fault"
        return "healthy" if states == {"healthy"} else "not-judged"

    @property
    def recordings(self) -> list[dict[str, Any]]:
        """The answer for each recording: verdict, what to do, what cannot be seen."""
        return list(self.data["recordings"])

    @property
    def parameters(self) -> Table:
        """Parameters of the motor as it is known in the end, with 95 % intervals; units are in their names."""
        return self.table("parameters")


class Compared(Page):
    """Where the model of a motor fails (`drivemon compare`)."""

    @property
    def error_over_noise(self) -> Optional[float]:
        """Error of the model in units of the sensors' noise: 1 means that nothing is missing. None where the audit refused."""
        overall = self.data["overall"]
        return None if overall is None else float(overall["error_over_noise"])

    @property
    def signals(self) -> Table:
        """Error of each signal, in its unit and over its noise."""
        return self.table("signals")

    @property
    def regions(self) -> Table:
        """Error over noise of each part of the recording, s."""
        return self.table("regions")


class Explained(Page):
    """Which physical effect a model misses (`drivemon explain`)."""

    @property
    def verdict(self) -> str:
        """`adequate`, `effect`, `ambiguous`, `law`, `unknown`, `unsupported` or `implausible`."""
        return str(self.data["verdict"])

    @property
    def effect(self) -> Optional[str]:
        """The first effect that is missing; None where none is proven."""
        steps = self.data["steps"]
        return str(steps[0]["effect"]) if steps else None

    @property
    def to_adopt(self) -> Optional[str]:
        """What `adopt` takes next: an effect, `law`, `parameters`, or None."""
        return self.data["next"]["adopt"]  # type: ignore[no-any-return]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The effects in the order in which they were found, each with its ties and the test that would break them."""
        return list(self.data["steps"])

    @property
    def laws(self) -> list[dict[str, Any]]:
        """What is missing and in no library: place, coordinate, curve, formulas."""
        return list(self.data.get("laws", []))

    @property
    def error_over_noise(self) -> Optional[float]:
        """Error over noise on data that were not fitted, with everything that was found."""
        final = self.data["final"]
        return None if final is None else float(final["held_out_error_over_noise"])

    @property
    def ranking(self) -> Table:
        """All candidates with their error over noise on data that were not fitted."""
        return self.table("ranking")

    @property
    def parameters(self) -> Table:
        """Parameters of the last fit: believed, found, standard error, unit."""
        return self.table("final.parameters")


class Adopted(Page):
    """A model with one more effect (`drivemon adopt`)."""

    @property
    def proven(self) -> bool:
        """Whether the error falls on data that were not fitted, by more than its scatter. Without that `motor` is None."""
        return bool(self.data["proven"])

    @property
    def before(self) -> dict[str, float]:
        """Errors over noise before: `error_over_noise` on the fitted data, `held_out_error_over_noise` on others."""
        return dict(self.data["before"])

    @property
    def after(self) -> dict[str, float]:
        """The same after."""
        return dict(self.data["after"])

    @property
    def parameters(self) -> Table:
        """Parameters of the effect: value, standard error, unit."""
        return self.table("parameters")


class Calibrated(Result):
    """A healthy motor, learnt (`drivemon calibrate`). `motor` is the calibrated one."""

    @property
    def parameters(self) -> Table:
        """Parameters before and after, with standard errors and units; empty where currents alone were recorded."""
        return self.table("parameters")

    @property
    def threshold_percent(self) -> list[float]:
        """Thresholds of r1 to r4, percent of their scales."""
        return [float(x) for x in self.data["threshold_percent"]]

    @property
    def windows(self) -> int:
        """Steady windows that it was learnt from."""
        return int(self.data["windows"])
