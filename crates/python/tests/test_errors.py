"""What is wrong with an input is an exception that names file, line, column and remedy."""

import pickle

import numpy as np
import polars
import pytest

import drivemon
from conftest import LOAD_TEST, PEER, ROOT


def of(kind, work):
    with pytest.raises(kind) as raised:
        work()
    return raised.value


def test_a_motor_file(motor):
    text = motor.text.replace("stator_resistance_ohm = ", "stator_resistance_ohm = -")
    line = 1 + text[: text.index("stator_resistance_ohm")].count("\n")
    error = of(drivemon.InputError, lambda: drivemon.Motor.from_text(text, "mine.toml"))
    assert (error.file, error.line, error.column) == ("mine.toml", line, "parameters.stator_resistance_ohm")
    assert error.remedy.startswith("write above 0") and "mine.toml" in str(error)
    absent = of(drivemon.InputError, lambda: drivemon.Motor.from_file("absent.toml"))
    assert absent.file == "absent.toml" and absent.line is None


def test_a_recording(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("t,ia,ib\n0,1,2\n0.1,x,2\n0.2,1,2\n")
    error = of(drivemon.InputError, lambda: drivemon.Recording.from_file(path))
    assert (error.file, error.line, error.column) == (str(path), 3, "ia") and error.remedy
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.problems) == (str(error), error.problems)


def test_a_table():
    t = np.arange(100) * 1e-4
    gap = {"t": t, "ia": np.where(t == t[7], np.nan, 1.0), "ib": t}
    error = of(drivemon.InputError, lambda: drivemon.Recording.from_table(gap, name="mine"))
    assert (error.file, error.line, error.column) == ("mine", 8, "ia")
    nulls = polars.DataFrame({"t": t, "ia": [None, *t[1:]], "ib": t})
    error = of(drivemon.InputError, lambda: drivemon.Recording.from_table(nulls, name="mine"))
    assert (error.line, error.column) == (1, "ia")
    assert len(drivemon.Recording.from_table(nulls, skip_missing=True)) == 99
    text = {"t": t, "ia": ["x"] * 100, "ib": t}
    assert "ia" in str(of(drivemon.InputError, lambda: drivemon.Recording.from_table(text, column={"ia": "ia"})))
    short = {"t": t, "ia": t[:-1], "ib": t}
    assert "99 values" in str(of(drivemon.InputError, lambda: drivemon.Recording.from_table(short)))
    assert "no table" in str(of(drivemon.InputError, lambda: drivemon.Recording.from_table(7)))
    assert "no column" in str(of(drivemon.InputError, lambda: drivemon.Recording.from_table({})))
    falls = {"t": t[::-1].copy(), "ia": t, "ib": t}
    assert of(drivemon.InputError, lambda: drivemon.Recording.from_table(falls)).column == "t"


def test_a_flag(recording):
    path = PEER / "none/recording.csv.gz"
    error = of(drivemon.InputError, lambda: drivemon.Recording.from_file(path, unit={"speed": "furlong"}))
    assert "rpm" in error.remedy
    with pytest.raises(TypeError, match="units says nothing"):
        drivemon.Recording.from_file(path, units={"speed": "rpm"})


def test_a_question(motor, tmp_path):
    load_table = drivemon.Recording.from_file(LOAD_TEST)
    of(drivemon.UnsupportedError, lambda: drivemon.check(load_table, motor))
    of(drivemon.UnsupportedError, lambda: drivemon.compare([], motor))
    error = of(drivemon.InputError, lambda: drivemon.adopt("core-los", LOAD_TEST, ROOT / "motors/imc-18k5.toml"))
    assert "core-loss" in str(error)
    of(drivemon.InputError, lambda: drivemon.adopt("core-loss", LOAD_TEST, motor, formula=1))
    recording = PEER / "supply-unbalance/recording_b.csv.gz"
    of(drivemon.InputError, lambda: drivemon.calibrate(recording, motor, false_alarm_rate=2.0))
    of(drivemon.InputError, lambda: drivemon.Motor.from_nameplate(power_kw=2.2))
    of(drivemon.InputError, lambda: drivemon.Motor.from_nameplate(horses=3))
    same = tmp_path / "motor.toml"
    motor.save(same)
    error = of(drivemon.InputError, lambda: drivemon.check(recording, drivemon.Motor.from_file(same), out=same))
    assert "overwrite" in str(error) and same.read_text() == motor.text


def test_what_a_recording_does_not_support(motor):
    t = np.arange(20_000) * 1e-4
    rows = {"t": t, "ia": np.sin(314 * t), "ib": np.sin(314 * t - 2.1)}
    recording = drivemon.Recording.from_table(rows, name="two currents")
    error = of(drivemon.UnsupportedError, lambda: drivemon.adopt("core-loss", recording, motor))
    assert error.file == "two currents" and error.remedy and error.problems[0].message in str(error)
    explained = drivemon.explain(recording, motor)
    assert (explained.verdict, explained.effect, explained.error_over_noise) == ("unsupported", None, None)
    assert drivemon.compare(recording, motor).error_over_noise is None
    assert drivemon.monitor(recording, motor).state == "not-judged"


def test_a_scenario():
    error = of(drivemon.InputError, lambda: drivemon.simulate(text='motor = "motors/peer-2k2.toml"', folder=ROOT))
    assert error.column == "duration_s"
    assert of(drivemon.InputError, lambda: drivemon.simulate("absent.toml")).file == "absent.toml"
    with pytest.raises(TypeError):
        drivemon.simulate()
