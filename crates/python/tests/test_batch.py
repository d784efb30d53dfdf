"""A folder of recordings as tasks of Ray: the bytes of one machine's table, also where a killed call goes on."""

import os
import shutil
import subprocess
import sys

import pytest

import drivemon
from conftest import PEER, ROOT, program
from drivemon import batch

RECORDINGS = ["none", "supply-unbalance", "magnetizing-saturation"]


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """Recordings of three motors, one that cannot be read, and their map."""
    folder = tmp_path_factory.mktemp("plant")
    entries = []
    for name in RECORDINGS:
        (folder / "recordings" / name).mkdir(parents=True)
        for end in ["csv.gz", "toml"]:
            shutil.copy(PEER / name / f"recording_b.{end}", folder / "recordings" / name)
        entries.append(f'[[motors]]\nrecordings = "{name}/*"\nmotor = "{PEER / name / "motor.toml"}"\n')
    (folder / "recordings/none/x.csv").write_text("t,ia,ib\n0,1,2\n0.1,x,2\n")
    (folder / "map.toml").write_text("\n".join(entries))
    # 2: a recording cannot be read.
    program("batch", "recordings", "--motor-map", "map.toml", "-o", "here.parquet", cwd=folder, codes=(2,))
    return folder


@pytest.fixture
def seen_from(plant, monkeypatch):
    """Paths are seen from the plant's folder, as rows name them."""
    monkeypatch.chdir(plant)
    return plant


def test_ray_writes_the_bytes_of_one_machine(seen_from):
    output = seen_from / "ray.parquet"
    parts = seen_from / "ray.parquet.parts"
    # Left behind by a call that was killed: one part is there, something unfinished is not read.
    begun = drivemon._drivemon.Batch("recordings", "map.toml", output, drivemon._reading.flags({}))
    assert begun.open() == [(0, 4)]
    begun.share(1, 3, parts / f"{begun.fingerprint}-000000001-000000003.parquet", None)
    (parts / "x.unfinished").write_bytes(b"half")
    assert begun.open() == [(0, 1), (3, 4)]
    heard = []
    done = batch.run("recordings", "map.toml", "ray.parquet", progress=lambda _, share: heard.append(share))
    assert output.read_bytes() == (seen_from / "here.parquet").read_bytes()
    assert (done.recordings, done.not_read) == (4, 1) and not parts.exists()
    assert heard == sorted(heard) and heard[-1] == 1.0
    # Nothing is new: no cluster is needed.
    heard.clear()
    assert batch.run("recordings", "map.toml", "ray.parquet", progress=lambda _, share: heard.append(share)) == done
    assert heard == []


def test_the_command_hands_over_to_ray(seen_from):
    drivemon_program = os.environ.get("DRIVEMON_PROGRAM", str(ROOT / "target/debug/drivemon"))
    command = [drivemon_program, "batch", "recordings", "--motor-map", "map.toml", "-o", "command.parquet", "--engine", "ray"]
    python = {**os.environ, "DRIVEMON_PYTHON": sys.executable}
    ran = subprocess.run(command, env=python, capture_output=True, text=True)
    assert ran.returncode == 2 and "x.csv:3: ia" in ran.stderr, ran.stderr
    assert (seen_from / "command.parquet").read_bytes() == (seen_from / "here.parquet").read_bytes()


def test_what_does_not_fit_is_refused(seen_from):
    with pytest.raises(drivemon.InputError, match="parquet"):
        batch.run("recordings", "map.toml", "table.csv")
    with pytest.raises(drivemon.InputError, match="absent.toml"):
        batch.run("recordings", "absent.toml", "table.parquet")
    with pytest.raises(drivemon.InputError, match="sensor"):
        batch.run("recordings", "map.toml", "table.parquet", sensor={"ia": "no scale"})
