"""Makes the files of this folder with other people's writers, and reads them back with other people's readers.

Run: python3 -m pip install numpy scipy pyarrow comtrade && python3 make.py
Made with numpy 2.4.6, scipy 1.17.1, pyarrow 26.0.1, comtrade 0.2.0 on Python 3.

One motor, 0.02 s at 5 kHz: va = 325 cos(100 pi t), ia = 7 cos(100 pi t - 0.6), b and c lag by 120 degrees, 150 rad/s.
COMTRADE has no writer there: its files are packed here by the field list of IEEE C37.111 and judged by `comtrade`.
"""
import datetime
import decimal
import struct

import comtrade
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.io import savemat
from scipy.sparse import csc_matrix

N = 100
RATE = 5000.0
t = np.arange(N) / RATE
LAG = 2 * np.pi / 3


def wave(amplitude, angle):
    return [amplitude * np.cos(100 * np.pi * t - angle - k * LAG) for k in range(3)]


va, vb, vc = wave(325.0, 0.0)
ia, ib, ic = wave(7.0, 0.6)
speed = np.full(N, 150.0)
columns = {"t": t, "va": va, "vb": vb, "vc": vc, "ia": ia, "ib": ib, "ic": ic, "speed": speed}


def parquet():
    # Two groups of rows, a float, a column of words, one sample missing.
    ic_holes = [None if k == 7 else float(x) for k, x in enumerate(ic)]
    table = pa.table({**columns, "ic": ic_holes, "speed": pa.array(speed, pa.float32()), "note": ["steady"] * N})
    pq.write_table(table, "pyarrow-snappy.parquet", compression="snappy", row_group_size=60)
    # An instant as clock, a decimal, an unsigned integer.
    start = datetime.datetime(2026, 3, 1, 12, 0, 0)
    stamps = [start + datetime.timedelta(microseconds=200 * k) for k in range(N)]
    torque = [decimal.Decimal("14.625")] * N
    odd = pa.table({**columns, "t": pa.array(stamps, pa.timestamp("us")), "torque": pa.array(torque, pa.decimal128(9, 3)),
                    "speed": pa.array([1500] * N, pa.uint32())})
    pq.write_table(odd, "pyarrow-zstd.parquet", compression="zstd", store_decimal_as_integer=True)
    # Clocks of other kinds, and currents that are no numbers.
    short = {name: x[:20] for name, x in columns.items()}
    micro = (np.arange(20) * 200).astype("int64")
    clocks = {
        "int96": pa.array(stamps[:20], pa.timestamp("ns")),
        "time64": pa.array(np.int64(12 * 3600e6) + micro, pa.int64()).cast(pa.time64("us")),
        "duration": pa.array(micro * 1000, pa.duration("ns")),
    }
    for name, clock in clocks.items():
        pq.write_table(pa.table({**short, "t": clock}), f"pyarrow-{name}.parquet",
                       use_deprecated_int96_timestamps=name == "int96")
    phases = {
        "decimal": pa.array([decimal.Decimal(f"{x:.6f}") for x in ic[:20]], pa.decimal128(20, 6)),
        "text": pa.array([str(x) for x in ic[:20]]),
        "bool": pa.array([bool(x > 0) for x in ic[:20]]),
        "list": pa.array([[float(x)] for x in ic[:20]]),
    }
    for name, phase in phases.items():
        pq.write_table(pa.table({**short, "ic": phase}), f"pyarrow-{name}.parquet")
    pq.write_table(pa.table(short), "pyarrow-checked.parquet", write_page_checksum=True, use_dictionary=False)
    plain = pa.table(columns)
    for codec in ["gzip", "lz4", "brotli"]:
        pq.write_table(plain.slice(0, 20), f"pyarrow-{codec}.parquet", compression=codec)


def mat():
    savemat("scipy-v6.mat", columns, do_compression=False, oned_as="column")
    savemat("scipy-v7.mat", {**columns, "speed": speed.astype(np.int16), "fs": RATE, "note": "bench 3"},
            do_compression=True, oned_as="row")
    savemat("scipy-struct.mat", {"time": t, "i": np.column_stack([ia, ib, ic]),
                                 "drive": {"va": va, "vb": vb, "vc": vc, "label": "x", "deep": {"n": speed}},
                                 "cells": np.array([1, "two"], dtype=object)},
            do_compression=True, oned_as="column")
    short = {name: x[:20] for name, x in columns.items()}
    phases = {"complex": short["ic"] + 1j, "cell": np.array(list(short["ic"]), dtype=object),
              "sparse": csc_matrix(short["ic"].reshape(-1, 1))}
    for name, phase in phases.items():
        savemat(f"scipy-{name}-phase.mat", {**short, "ic": phase}, oned_as="column")
    savemat("scipy-complex.mat", {"t": t, "ia": ia + 1j * ib}, oned_as="column")


# name, values in the unit, unit, lsb in the unit
CHANNELS = [("VA", va / 1000, "kV", 2e-5), ("VB", vb / 1000, "kV", 2e-5), ("VC", vc / 1000, "kV", 2e-5),
            ("IA", ia, "A", 5e-4), ("IB", ib, "A", 5e-4), ("IC", ic * 1000, "mA", 0.5)]


def codes(x, lsb):
    return np.round(x / lsb).astype(int)


def analog_line(k, name, unit, lsb, rev, ratio):
    line = f"{k},{name},{name[1]},,{unit},{lsb},0,0,-32767,32767"
    return line if rev == 1991 else line + ("," + ratio)


def cfg(ft, rev, rates=((RATE, N),), lsb=None, ratio="1,1,P", station="Pruefstand 3", date="01/03/2026"):
    lines = [f"{station},recorder" + ("" if rev == 1991 else f",{rev}"), f"{len(CHANNELS) + 1},{len(CHANNELS)}A,1D"]
    lines += [analog_line(k + 1, name, unit, lsb or step, rev, ratio)
              for k, (name, _, unit, step) in enumerate(CHANNELS)]
    lines += ["1,TRIP,0" if rev == 1991 else "1,TRIP,,,0", "50"]
    lines += [str(len(rates))] if rates[0][0] else ["0"]
    lines += [f"{rate:g},{end}" for rate, end in rates]
    lines += [f"{date},12:00:00.000000", f"{date},12:00:00.000000", ft]
    lines += [] if rev == 1991 else ["1"]
    lines += ["0,0", "0,3"] if rev == 2013 else []
    return "\r\n".join(lines) + "\r\n"


def rows():
    for k in range(N):
        yield k + 1, 200 * k, [codes(x, lsb)[k] for _, x, _, lsb in CHANNELS]


def ascii_dat():
    return "".join(f"{n},{us},{','.join(str(c) for c in cs)},0\r\n" for n, us, cs in rows())


def binary_dat(code):
    return b"".join(struct.pack(f"<II{len(cs)}{code}H", n, us, *cs, 0) for n, us, cs in rows())


def float_dat():
    return b"".join(struct.pack(f"<II{len(CHANNELS)}fH", k + 1, 200 * k, *[x[k] for _, x, _, _ in CHANNELS], 0)
                    for k in range(N))


def comtrade_files():
    made = {
        "ascii-1991": (cfg("ASCII", 1991), ascii_dat().encode()),
        "ascii-1999": (cfg("ASCII", 1999, rates=((0, N),)), ascii_dat().encode()),
        "binary-1999": (cfg("BINARY", 1999), binary_dat("h")),
        "binary32-2013": (cfg("BINARY32", 2013), binary_dat("i")),
        "float32-2013": (cfg("FLOAT32", 2013, lsb=1), float_dat()),
    }
    for name, (text, data) in made.items():
        open(name + ".cfg", "w", newline="").write(text)
        open(name + ".dat", "wb").write(data)
        check(comtrade.load(name + ".cfg"))
    text = "--- file type: CFG ---\r\n" + cfg("ASCII", 2013)
    text += "--- file type: INF ---\r\n\r\n--- file type: HDR ---\r\n\r\n--- file type: DAT ASCII ---\r\n"
    open("ascii-2013.cff", "w", newline="").write(text + ascii_dat())
    check(comtrade.load("ascii-2013.cff"))
    data = binary_dat("h")
    head = "--- file type: CFG ---\r\n" + cfg("BINARY", 2013) + "--- file type: INF ---\r\n--- file type: HDR ---\r\n"
    head += f"--- file type: DAT BINARY: {len(data)} ---\r\n"
    open("binary-2013.cff", "wb").write(head.encode() + data)
    check(comtrade.load("binary-2013.cff"))


def check(read):
    assert read.total_samples == N
    for (name, x, _, lsb), got in zip(CHANNELS, read.analog):
        assert np.max(np.abs(np.array(got) - x)) <= 0.51 * lsb + 1e-6, name
    assert np.max(np.abs(np.array(read.time) - t)) < 1e-9


parquet()
mat()
comtrade_files()
