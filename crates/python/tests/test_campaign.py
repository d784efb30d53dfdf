"""Campaigns as tasks of Ray: the same bytes as one machine's, also where a killed call goes on."""

import os
import subprocess
import sys

import pytest

import drivemon
from conftest import ROOT, program
from drivemon import campaign

PLAN = ROOT / "campaigns/smoke.toml"


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """What one machine writes."""
    output = tmp_path_factory.mktemp("here") / "smoke.parquet"
    program("campaign", "run", PLAN, "-o", output)
    return output.read_bytes()


def test_ray_writes_the_bytes_of_one_machine(here, tmp_path):
    output = tmp_path / "smoke.parquet"
    # Left behind by a call that was killed: runs 3..20 are there, something unfinished is not read.
    shares = tmp_path / "smoke.parquet.shares"
    shares.mkdir()
    plan = drivemon._drivemon.Plan(PLAN)
    plan.share(3, 20, shares / f"{plan.fingerprint}-000000003-000000020.parquet", None)
    (shares / "x.unfinished").write_bytes(b"half")
    heard = []
    done = campaign.run(PLAN, output, task_seconds=0.1, progress=lambda _, share: heard.append(share))
    assert output.read_bytes() == here
    assert done.rows == plan.runs and not shares.exists()
    assert heard == sorted(heard) and heard[-1] == 1.0
    before = output.stat().st_mtime_ns
    assert campaign.run(PLAN, output) == done
    assert output.stat().st_mtime_ns == before


def test_other_campaigns_and_ranges_are_refused(tmp_path):
    output = tmp_path / "smoke.parquet"
    with pytest.raises(drivemon.InputError, match="0..38"):
        campaign.run(PLAN, output, begin=5, end=99)
    shares = tmp_path / "smoke.parquet.shares"
    shares.mkdir(exist_ok=True)
    (shares / "0123-000000000-000000016.parquet").write_bytes(b"")
    with pytest.raises(drivemon.InputError, match="another campaign"):
        campaign.run(PLAN, output)


def test_the_command_hands_over_to_ray(here, tmp_path):
    output = tmp_path / "smoke.parquet"
    drivemon_program = os.environ.get("DRIVEMON_PROGRAM", str(ROOT / "target/debug/drivemon"))
    command = [drivemon_program, "campaign", "run", PLAN, "-o", output, "--engine", "ray"]
    python = {**os.environ, "DRIVEMON_PYTHON": sys.executable}
    ran = subprocess.run(command, env=python, capture_output=True, text=True)
    assert ran.returncode == 1, ran.stderr
    assert "FAULT on a healthy motor" in ran.stdout and output.read_bytes() == here
    nowhere = {**os.environ, "DRIVEMON_PYTHON": "/nonexistent"}
    without = subprocess.run(command, env=nowhere, capture_output=True, text=True)
    assert without.returncode == 2 and "DRIVEMON_PYTHON" in without.stderr
