"""The package says what the program says, bit for bit: JSON, page, motor file, recording."""

import pytest

import drivemon
from conftest import LOAD_MOTOR, LOAD_TEST, PEER, ROOT, program

PEERS = ["none", "inverter-dead-time", "magnetizing-saturation", "supply-unbalance", "voltage-gain-phase-c", "windage"]
SHORTED = ["sc_hlt_001", "sc_a0_b1_c0_001", "sc_a4_b0_c0_003"]


def recordings():
    """Ten recordings, each with a motor file."""
    peers = [(PEER / name / "recording.csv.gz", PEER / name / "motor.toml") for name in PEERS]
    shorted = [(ROOT / f"tests/data/itsc_075hp/{name}.csv.gz", ROOT / "motors/itsc-075hp.toml") for name in SHORTED]
    return [*peers, *shorted, (LOAD_TEST, LOAD_MOTOR)]


def both(tmp_path, result, command, *arguments, page=True):
    """JSON and page of the package beside those of the program."""
    out = tmp_path / "program.json"
    pages = ["--report", tmp_path / "program.html"] if page else []
    program(command, *arguments, "--json", out, *pages)
    assert result.json == out.read_text(encoding="utf-8")
    if page:
        assert result.page == (tmp_path / "program.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("path,motor", recordings(), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_monitor(tmp_path, path, motor):
    result = drivemon.monitor(path, motor)
    both(tmp_path, result, "monitor", path, "--motor", motor)


def test_ten_recordings_are_ten():
    assert len({path for path, _ in recordings()}) == 10


def test_without_a_motor(tmp_path):
    path = ROOT / "tests/data/itsc_075hp/sc_a4_b0_c0_003.csv.gz"
    both(tmp_path, drivemon.monitor(path), "monitor", path)


@pytest.mark.parametrize("name", ["none", "magnetizing-saturation"])
def test_compare(tmp_path, name):
    path, motor = PEER / name / "recording_b.csv.gz", PEER / name / "motor.toml"
    result = drivemon.compare(path, motor)
    both(tmp_path, result, "compare", path, "--motor", motor)
    assert (result.error_over_noise > 1.1) == (name != "none")


def test_flags_are_heard_and_repeated(tmp_path):
    path, motor = PEER / "none/recording_b.csv.gz", PEER / "none/motor.toml"
    recording = drivemon.Recording.from_file(
        path, column={"speed": "speed"}, scale={"speed": 0.095}, delay={"ic": "11.55us"}
    )
    result = drivemon.compare(recording, motor)
    flags = ["--column", "speed=speed", "--scale", "speed=0.095", "--delay", "ic=11.55us"]
    both(tmp_path, result, "compare", path, "--motor", motor, *flags)
    assert "--delay ic=11.55us" in result.data["next_command"]
    # The speed is 2.7 % off.
    assert result.error_over_noise > 2


def test_check(tmp_path):
    path, motor = PEER / "none/recording_b.csv.gz", PEER / "none/motor.toml"
    both(tmp_path, drivemon.check(path, motor), "check", path, "--motor", motor)


def test_check_from_a_plate(tmp_path):
    path = PEER / "supply-unbalance/recording_b.csv.gz"
    plate = {"power_kw": 2.2, "voltage_volt": 400, "frequency_hz": 50, "speed_rpm": 1438, "current_amp": "4.80"}
    flags = [word for key, number in plate.items() for word in (f"--{key.replace('_', '-')}", number)]
    motor = drivemon.Motor.from_nameplate(**plate)
    result = drivemon.check(path, motor, out=tmp_path / "package.toml")
    program("check", path, *flags, "-o", tmp_path / "program.toml")
    assert (tmp_path / "package.toml").read_text() == (tmp_path / "program.toml").read_text()
    assert result.motor is not None and result.motor.text == (tmp_path / "program.toml").read_text()
    interval = motor.parameters["stator_resistance_ohm"]
    assert interval.low < interval.value < interval.high


def test_explain_and_adopt_of_a_load_table(tmp_path):
    explained = drivemon.explain(LOAD_TEST, LOAD_MOTOR)
    both(tmp_path, explained, "explain", LOAD_TEST, "--motor", LOAD_MOTOR)
    assert (explained.verdict, explained.effect) == ("ambiguous", "core-loss")
    out = tmp_path / "better.toml"
    adopted = drivemon.adopt("core-loss", LOAD_TEST, LOAD_MOTOR, out=out)
    written = out.read_text()
    both(tmp_path, adopted, "adopt", "core-loss", LOAD_TEST, "--motor", LOAD_MOTOR, "-o", out)
    assert adopted.proven and written == out.read_text() == adopted.motor.text
    assert adopted.motor.effects == ["core-loss"]


def test_explain_of_two_recordings(tmp_path):
    folder = PEER / "magnetizing-saturation"
    pair, motor = [folder / "recording.csv.gz", folder / "recording_b.csv.gz"], folder / "motor.toml"
    result = drivemon.explain(pair, motor)
    both(tmp_path, result, "explain", *pair, "--motor", motor)
    assert (result.verdict, result.effect) == ("effect", "magnetizing-saturation")


HEALTHY = """
name = "loads"
motor = "motors/assumed-300w.toml"
start = "running"
duration_s = 6.0
[load]
profile = [{ at_s = 0.0, torque_percent = 30.0 }, { at_s = 2.0, torque_percent = 70.0 }, { at_s = 4.0, torque_percent = 100.0 }]
[sensors]
noise_sigma_fraction_of_full_scale = 0.001
"""


def test_simulate_and_calibrate(tmp_path):
    scenario = tmp_path / "loads.toml"
    motor = ROOT / "motors/assumed-300w.toml"
    scenario.write_text(HEALTHY.replace("motors/", f"{ROOT}/motors/"))
    by_program, by_package = tmp_path / "program.csv.gz", tmp_path / "package.csv.gz"
    program("simulate", scenario, "--seed", 3, "-o", by_program)
    drivemon.simulate(scenario, seed=3).save(by_package)
    assert by_package.read_bytes() == by_program.read_bytes()
    sidecars = [path.with_name(path.name.replace(".csv.gz", ".toml")) for path in (by_program, by_package)]
    assert sidecars[0].read_bytes() == sidecars[1].read_bytes()

    out = tmp_path / "calibrated.toml"
    result = drivemon.calibrate(by_program, motor, out=out)
    written = out.read_text()
    both(tmp_path, result, "calibrate", by_program, "--motor", motor, "-o", out, page=False)
    assert written == out.read_text()
    assert result.motor.is_calibrated and not drivemon.Motor.from_file(motor).is_calibrated
    assert drivemon.monitor(by_package, result.motor).state == "healthy"


def test_a_text_is_simulated_like_its_file(tmp_path):
    scenario = tmp_path / "loads.toml"
    scenario.write_text(HEALTHY.replace("motors/", f"{ROOT}/motors/").replace("6.0", "1.0"))
    by_file = drivemon.simulate(scenario)
    by_text = drivemon.simulate(text=HEALTHY.replace("6.0", "1.0"), folder=ROOT)
    assert by_file["ia"].tolist() == by_text["ia"].tolist() and len(by_text) == 10_001
