"""What the tests share: the source tree, its recordings, and the program beside which the package is held."""

import os
import pathlib
import subprocess

import pytest

import drivemon

ROOT = pathlib.Path(__file__).resolve().parents[3]
PEER = ROOT / "tests/data/peer"
LOAD_TEST = ROOT / "tests/data/imc_18k5_load_test/load_test.csv"
LOAD_MOTOR = ROOT / "motors/imc-18k5.toml"


def program(*arguments: object, cwd: pathlib.Path = ROOT, codes: tuple[int, ...] = (0, 1, 3)) -> int:
    """Runs `drivemon`, of the same sources; its exit code, one of `codes`."""
    path = os.environ.get("DRIVEMON_PROGRAM", str(ROOT / "target/debug/drivemon"))
    done = subprocess.run([path, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    assert done.returncode in codes, done.stderr
    return done.returncode


@pytest.fixture(scope="session")
def motor() -> drivemon.Motor:
    return drivemon.Motor.from_file(PEER / "none/motor.toml")


@pytest.fixture(scope="session")
def recording() -> drivemon.Recording:
    return drivemon.Recording.from_file(PEER / "none/recording.csv.gz")
