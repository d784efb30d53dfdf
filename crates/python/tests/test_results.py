"""Answers as objects."""

import html

import drivemon
from conftest import LOAD_MOTOR, LOAD_TEST, PEER


def test_the_page_stands_in_a_notebook_and_in_a_file(tmp_path):
    result = drivemon.compare(LOAD_TEST, LOAD_MOTOR)
    result.report(tmp_path / "x.html")
    page = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert "Where the model fails" in page and "<script src" not in page
    frame = result._repr_html_()
    assert html.escape(page, quote=True) in frame and 'sandbox="allow-scripts"' in frame


def test_a_faulty_supply_is_seen():
    path, motor = PEER / "supply-unbalance/recording.csv.gz", PEER / "supply-unbalance/motor.toml"
    audit = drivemon.Recording.from_file(path).audit(drivemon.Motor.from_file(motor))
    assert audit["supported"] and "supply-unbalance" in [finding["code"] for finding in audit["findings"]]


def test_main_answers_are_attributes(motor, recording):
    monitored = drivemon.monitor(recording, motor)
    assert (monitored.state, monitored.candidates, monitored.first_alarm_s) == ("healthy", [], None)
    assert 0 < monitored.judged <= monitored.windows == monitored.data["windows"]
    checked = drivemon.check(recording, motor)
    assert checked.state == "healthy" == checked.recordings[0]["verdict"]["state"]
    assert checked.parameters.columns[:2] == ["name", "value"]
    compared = drivemon.compare(recording, motor)
    assert compared.error_over_noise == compared.data["overall"]["error_over_noise"] < 1.1
    assert [name for name in compared.signals.to_polars()["name"]] == ["ia", "ib", "ic", "speed", "v0"]


def test_an_effect_that_is_not_proven_gives_no_motor():
    adopted = drivemon.adopt("stray-load-loss", LOAD_TEST, LOAD_MOTOR)
    if not adopted.proven:
        assert adopted.motor is None
    anyway = drivemon.adopt("stray-load-loss", LOAD_TEST, LOAD_MOTOR, anyway=True)
    assert anyway.motor.effects == ["stray-load-loss"]
    assert anyway.after["held_out_error_over_noise"] > 0


def test_motors_say_what_they_are(motor, tmp_path):
    assert motor.parameters["stator_resistance_ohm"].value == 3.7 and motor.effects == []
    assert motor.path is not None and not motor.is_calibrated and motor.contradictions == []
    again = drivemon.Motor.from_text(motor.text)
    assert (again.name, again.path, again.parameters) == (motor.name, None, motor.parameters)
    plate = tmp_path / "plate.toml"
    plate.write_text("power_kw = 5.5\nvoltage_volt = 400\nspeed_rpm = 1455\n")
    wide = drivemon.Motor.from_nameplate(plate).parameters["rotor_resistance_ohm"]
    narrow = drivemon.Motor.from_nameplate(plate, current_amp="10.4", power_factor=0.85).parameters["rotor_resistance_ohm"]
    assert narrow.high / narrow.low < wide.high / wide.low
