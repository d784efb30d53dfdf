"""Tables in memory: whose numbers a recording reads, and what comes out again."""

import subprocess
import sys

import numpy as np
import pandas
import polars
import pyarrow
import pytest
import xarray

import drivemon
from conftest import LOAD_MOTOR, LOAD_TEST, PEER


@pytest.fixture(scope="module")
def columns(recording):
    return {name: recording[name].copy() for name in recording.columns}


def frames(columns):
    t, others = columns["t"], {name: values for name, values in columns.items() if name != "t"}
    return {
        "dict": columns,
        "polars": polars.DataFrame(columns),
        "pyarrow": pyarrow.table(columns),
        "pandas": pandas.DataFrame(columns),
        "pandas with an index": pandas.DataFrame(others, index=pandas.Index(t, name="t")),
        "xarray": xarray.Dataset({name: ("t", values) for name, values in others.items()}, coords={"t": t}),
        "record batch": pyarrow.RecordBatch.from_pydict(columns),
    }


KINDS = ["dict", "polars", "pyarrow", "pandas", "pandas with an index", "xarray", "record batch"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_table_gives_the_same_answer(columns, motor, kind):
    expected = drivemon.monitor(drivemon.Recording.from_table(columns, copy=True), motor)
    table = frames(columns)[kind]
    result = drivemon.monitor(drivemon.Recording.from_table(table), motor)
    assert result.json == expected.json and result.judged > 100


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_stay_where_they_are(columns, kind):
    table = frames(columns)[kind]
    lent = drivemon.Recording.from_table(table)
    for name in ["t", "va", "ib", "speed"]:
        if kind == "pyarrow":
            theirs = table[name].chunk(0).to_numpy()
        elif name == "t" and kind == "pandas with an index":
            theirs = table.index.to_numpy()
        elif kind == "xarray":
            theirs = table.variables[name].to_numpy()
        else:
            theirs = np.asarray(table[name])
        assert np.shares_memory(theirs, lent[name]), name


def test_copy_takes_numbers_of_its_own(columns):
    mine = {name: values.copy() for name, values in columns.items()}
    own = drivemon.Recording.from_table(mine, copy=True)
    mine["ia"][:] = 0.0
    assert own["ia"].tolist() == columns["ia"].tolist()


def test_the_table_may_go_before_the_recording(columns, motor):
    expected = drivemon.monitor(drivemon.Recording.from_table(columns), motor).json
    lent = [drivemon.Recording.from_table(table) for table in frames(columns).values()]
    views = [one["ia"] for one in lent]
    assert all(drivemon.monitor(one, motor).json == expected for one in lent)
    del lent
    assert all(view.tolist() == columns["ia"].tolist() for view in views)


#: Grows by the size of the numbers where they are copied, by next to nothing where they are lent.
MEMORY = """
import sys
import numpy as np
import polars, pandas, pyarrow
import drivemon

def resident_mb():
    for line in open("/proc/self/status"):
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024

rows = 2_000_000
t = np.arange(rows) * 1e-5
names = ["va", "vb", "vc", "ia", "ib", "ic", "speed"]
columns = {"t": t, **{name: 10.0 * np.sin(314.0 * t + k) for k, name in enumerate(names)}}
kind, copy = sys.argv[1], sys.argv[2] == "copy"
table = {"dict": dict, "polars": polars.DataFrame, "pandas": pandas.DataFrame, "pyarrow": pyarrow.table}[kind](columns)
del columns, t
small = {name: np.linspace(0.0, 1.0, 50) for name in ["t", "ia", "ib"]}
drivemon.Recording.from_table(small)
before = resident_mb()
kept = drivemon.Recording.from_table(table, copy=copy)
print(resident_mb() - before, rows * 8 * 8 / 2**20)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize(
    "kind,how", [("dict", "lend"), ("polars", "lend"), ("pyarrow", "lend"), ("pandas", "lend"), ("dict", "copy")]
)
def test_memory_grows_only_where_numbers_are_copied(kind, how):
    done = subprocess.run([sys.executable, "-c", MEMORY, kind, how], capture_output=True, text=True, check=True)
    grown, size = map(float, done.stdout.split())
    print(f"{kind}, {how}: {size:.0f} MiB of numbers, the process grew by {grown:.0f} MiB")
    # What the allocator keeps of scratch space of one column counts as grown.
    if how == "lend":
        assert grown < 0.25 * size
    else:
        assert grown > 0.6 * size


def test_other_types_units_and_clocks_are_converted(columns):
    few = {name: values[:2000] for name, values in columns.items()}
    plain = drivemon.Recording.from_table(few)
    stamps = np.datetime64("2026-03-01T12:00:00", "ns") + (few["t"] * 1e9).round().astype("timedelta64[ns]")
    odd = {
        "Zeit": stamps,
        "ia": (1e3 * few["ia"]).astype(np.float32),
        "ib": few["ib"].tolist(),
        "ic": np.stack([few["ic"], few["ic"]], axis=1)[:, 0],
        "n": few["speed"] * 60 / (2 * np.pi),
        "note": ["x"] * 2000,
    }
    reading = {"column": {"t": "Zeit", "speed": "n"}, "unit": {"ia": "mA", "speed": "rpm"}}
    for table in [odd, pandas.DataFrame(odd), polars.DataFrame(odd), pyarrow.table(odd)]:
        converted = drivemon.Recording.from_table(table, **reading)
        assert np.allclose(converted["t"], plain["t"], atol=1e-9)
        assert np.allclose(converted["ia"], plain["ia"], atol=2e-5)
        for name in ["ib", "ic", "speed"]:
            assert np.allclose(converted[name], plain[name], rtol=1e-12)
    cut = pyarrow.concat_tables([pyarrow.table(few).slice(0, 700), pyarrow.table(few).slice(700)])
    assert drivemon.Recording.from_table(cut)["ia"].tolist() == plain["ia"].tolist()
    matrix = np.column_stack([few[name] for name in ["t", "ia", "ib", "ic"]])
    assert drivemon.Recording.from_table(matrix, columns="t,ia,ib,ic")["ic"].tolist() == few["ic"].tolist()
    structured = np.rec.fromarrays([few["t"], few["ia"], few["ib"]], names="t,ia,ib")
    assert drivemon.Recording.from_table(structured)["ib"].tolist() == few["ib"].tolist()


def test_a_sidecar_and_a_rate_count_for_tables_too(columns, tmp_path):
    few = {name: values[:2000] for name, values in columns.items() if name != "t"}
    sidecar = tmp_path / "s.toml"
    sidecar.write_text('load_torque = "free"\n')
    recording = drivemon.Recording.from_table(few, sample_rate_hz=10_000, sidecar=sidecar)
    assert recording.t_sample_s == pytest.approx(1e-4) and recording["t"][0] == 0.0


def test_a_load_table_is_told_by_its_columns():
    frame = polars.read_csv(LOAD_TEST)
    table = drivemon.Recording.from_table(frame, name=str(LOAD_TEST))
    assert table.is_load_table and len(table) == 14
    assert drivemon.compare(table, LOAD_MOTOR).data["signals"] == drivemon.compare(LOAD_TEST, LOAD_MOTOR).data["signals"]
    assert table.to_polars().columns == list(table.columns)
    points = drivemon.monitor(table, LOAD_MOTOR)
    assert isinstance(points, drivemon.OperatingPoints) and len(points.points) == 14


def test_recordings_and_answers_go_out_as_tables(recording, motor):
    for frame in [recording.to_polars(), recording.to_pandas(), recording.to_pyarrow().to_pandas()]:
        assert list(frame.columns) == recording.columns and len(frame) == len(recording)
        assert frame["ic"].to_numpy().tolist() == recording["ic"].tolist()
    with pytest.raises(ValueError):
        recording["ia"][0] = 1.0
    with pytest.raises(KeyError, match="no column ix"):
        recording["ix"]
    result = drivemon.monitor(recording, motor)
    residuals = result.residuals.to_polars()
    assert residuals.columns == ["t", "r_percent", "judged"]
    rows = result.data["residuals"]
    assert residuals["t"].to_list() == [row["t"] for row in rows]
    assert residuals["r_percent"].to_list() == [row["r_percent"] for row in rows]
    assert residuals["judged"].to_list() == [row["judged"] for row in rows]
    assert result.lamps.to_pandas()["fault"].tolist() == [row["fault"] for row in result.data["lamps"]]
    assert len(result.operation.to_pyarrow()) == len(result.data["operation"])
    with pytest.raises(KeyError):
        result.table("nothing.here")


def test_a_saved_table_is_the_recording(recording, motor, tmp_path):
    path = tmp_path / "again.parquet"
    recording.save(path)
    again = drivemon.Recording.from_file(path)
    assert drivemon.compare(again, motor).data["overall"] == drivemon.compare(recording, motor).data["overall"]
    assert PEER.exists()
