"""Monitor a three-phase induction motor, and find out where its model is wrong.

The functions are the commands of `drivemon`, and answer the same, bit for bit: `simulate`, `monitor`, `check`, `calibrate`,
`compare`, `explain`, `adopt`. A `Recording` comes from a file or from a table in memory, a `Motor` from a file, a text or a
nameplate. Everything is in SI units; where it is not, the name holds the unit.

    import drivemon

    motor = drivemon.Motor.from_file("motor.toml")
    recording = drivemon.Recording.from_table(frame, unit={"speed": "rpm"})
    print(drivemon.compare(recording, motor).error_over_noise)

Errors are exceptions: `InputError` for what the user can put right, `UnsupportedError` for sound data that do not support an
answer, both with file, line, column and remedy. Python's lock is free during the work, and Ctrl-C ends it.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Iterable, Optional, Union

from . import _drivemon
from ._drivemon import __version__
from ._errors import Error, InputError, Problem, UnsupportedError
from ._motor import Motor, Parameter
from ._progress import Progress, ProgressCallback, told
from ._reading import Reading
from ._recording import Recording
from ._results import (
    Adopted,
    Calibrated,
    Checked,
    Compared,
    Explained,
    Monitored,
    OperatingPoints,
    Page,
    Result,
)
from ._table import Table

__all__ = [
    "Adopted",
    "Calibrated",
    "Checked",
    "Compared",
    "Error",
    "Explained",
    "InputError",
    "Monitored",
    "Motor",
    "OperatingPoints",
    "Page",
    "Parameter",
    "Problem",
    "Progress",
    "ProgressCallback",
    "Reading",
    "Recording",
    "Result",
    "Table",
    "UnsupportedError",
    "__version__",
    "adopt",
    "calibrate",
    "check",
    "compare",
    "explain",
    "monitor",
    "simulate",
]

PathLike = Union[str, "os.PathLike[str]"]
Motors = Union[Motor, PathLike]
"""A motor, or the path of its file."""
Recordings = Union[Recording, PathLike, Iterable[Union[Recording, PathLike]]]
"""A recording, the path of one, or several."""


def simulate(
    scenario: Optional[PathLike] = None,
    *,
    text: Optional[str] = None,
    folder: PathLike = ".",
    seed: Optional[int] = None,
    progress: Progress = None,
) -> Recording:
    """A recording of a simulated motor: supply, load, faults, effects, instruments as the scenario says (docs/scenarios.md).

    Give the path of a scenario file, or its `text` with the `folder` from which it names its motor file. `seed` replaces the
    scenario's. The same scenario and seed give the same numbers.
    """
    if (scenario is None) == (text is None):
        raise TypeError("give the path of a scenario, or its text")
    if scenario is not None:
        label, folder = os.fspath(scenario), Path(scenario).parent
        try:
            text = Path(scenario).read_text(encoding="utf-8-sig")
        except (OSError, UnicodeError) as error:
            problem = (label, 0, "", f"cannot be read: {error}", "name a scenario file")
            raise InputError(f"{label}: cannot be read: {error}", [problem]) from error
    else:
        label = "the scenario"
    with told(progress) as tell:
        return Recording(_drivemon.simulate(text or "", label, folder, seed, tell))


def monitor(
    recording: Union[Recording, PathLike], motor: Optional[Motors] = None, *, progress: Progress = None
) -> Union[Monitored, OperatingPoints]:
    """Replays a recording through the core that the board runs: lamps, verdict, probabilities.

    Without a motor only the audit and the sequence components are told. A load table gives its operating points.
    """
    measured = _recording(recording)
    believed = None if motor is None else _motor(motor)._native
    with told(progress) as tell:
        answer = _drivemon.monitor(measured._native, believed, tell)
    return OperatingPoints(answer) if measured.is_load_table else Monitored(answer)


def check(
    recordings: Recordings,
    motor: Motors,
    *,
    healthy: Recordings = (),
    out: Optional[PathLike] = None,
    progress: Progress = None,
) -> Checked:
    """Is this motor in good order? `motor` may come from a nameplate; recordings of it in good order (`healthy`) teach more.

    `out` is a motor file to write with what is known afterwards.
    """
    judged, known = _recordings(recordings), _recordings(healthy)
    with told(progress) as tell:
        return Checked(_drivemon.check(judged, _motor(motor)._native, known, out, tell))


def compare(recordings: Recordings, motor: Motors, *, progress: Progress = None) -> Compared:
    """Compares the model of a motor with a recording, nothing refitted: how far off, in which signal, and where.

    The first recording is compared.
    """
    with told(progress) as tell:
        return Compared(_drivemon.compare(_recordings(recordings), _motor(motor)._native, tell))


def explain(
    recordings: Recordings,
    motor: Motors,
    *,
    shapes: Optional[PathLike] = None,
    progress: Progress = None,
) -> Explained:
    """Finds out which physical effect the model misses, and proves it on data that were not fitted.

    The first recording is fitted, the second proves; of more, the first, third, ... are fitted together. A single one is
    proven by blocks of it. `shapes` is a TOML file with formulas that a law is held against. It takes seconds to minutes.
    """
    with told(progress) as tell:
        return Explained(_drivemon.explain(_recordings(recordings), _motor(motor)._native, shapes, tell))


def adopt(
    effect: str,
    recordings: Recordings,
    motor: Motors,
    *,
    formula: Optional[int] = None,
    shapes: Optional[PathLike] = None,
    anyway: bool = False,
    out: Optional[PathLike] = None,
    progress: Progress = None,
) -> Adopted:
    """Adds a physical effect to a motor, refits everything, and shows the error before and after.

    `effect` is a name that `explain` gives, `"law"` for the curve that it proves, or `"parameters"` for the refitted
    parameters alone; `formula` takes a formula of the law instead of the curve, from 1. The result has a `motor` only where the
    gain is proven on data that were not fitted, or `anyway` is set; `out` is a motor file to write it to.
    """
    how = {"shapes": shapes, "formula": formula, "out": out, "anyway": anyway}
    with told(progress) as tell:
        return Adopted(_drivemon.adopt(effect, _recordings(recordings), _motor(motor)._native, how, tell))


def calibrate(
    recordings: Recordings,
    motor: Motors,
    *,
    winding_kelvin: float = 75.0,
    false_alarm_rate: float = 1e-6,
    out: Optional[PathLike] = None,
    progress: Progress = None,
) -> Calibrated:
    """Learns a motor in good order: parameters, gains of the channels, statistics, thresholds.

    `winding_kelvin` is how much warmer or colder than in the recordings the windings may become, K; `false_alarm_rate` how many
    FAULT lamps per judged window are accepted on a healthy motor. `out` is a motor file to write.

    Raises UnsupportedError where a recording is faulty itself, or teaches nothing.
    """
    surroundings = (winding_kelvin, false_alarm_rate)
    with told(progress) as tell:
        answer = _drivemon.calibrate(
            _recordings(recordings), _motor(motor)._native, surroundings, out, tell
        )
    return Calibrated(answer)


def _motor(motor: Motors) -> Motor:
    return motor if isinstance(motor, Motor) else Motor.from_file(motor)


def _recording(recording: Any) -> Recording:
    if isinstance(recording, Recording):
        return recording
    if isinstance(recording, (str, os.PathLike)):
        return Recording.from_file(recording)
    kind = type(recording).__name__
    raise TypeError(f"{kind} is no recording; make one with Recording.from_table or Recording.from_file")


def _recordings(recordings: Recordings) -> list[_drivemon.Recording]:
    if isinstance(recordings, (Recording, str, os.PathLike)):
        recordings = [recordings]
    return [_recording(one)._native for one in recordings]
