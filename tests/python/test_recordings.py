"""Recordings of other programs: MDF 4 as asammdf writes it, MATLAB as scipy does, Parquet as pyarrow does, and back."""

import asammdf
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
from asammdf.blocks import v4_blocks
from conftest import latsch

pytestmark = pytest.mark.quick

TIME = np.round(np.arange(400) * 2e-3, 6)
STOP = 0.59
# by what stands in the file: unit, values; some of them what a recorder stores as scaled whole numbers
RIG = {
    "deflection": ("mm", 10 + np.round(4 * np.sin(9 * TIME), 2)),
    "slip_angle": ("deg", np.round(3 * np.sin(5 * TIME), 3)),
    "path_speed": ("km/h", 30 + np.round(5 * TIME, 1)),
}
MAP = """
[channels]
time = { variable = "time", unit = "s" }
deflection = { variable = "deflection", unit = "mm" }
slip_angle = { variable = "slip_angle", unit = "deg" }
path_speed = { variable = "path_speed", unit = "km/h" }
"""


def simulated(folder, file, *arguments):
    done = latsch("simulate", "fiala-flat-track", "--inputs", file, "--set", "slip=0.02", "--stop", STOP, "--output", folder / "out.csv", *arguments)
    assert done.returncode == 0, done.stderr
    return (folder / "out.csv").read_bytes()


@pytest.fixture
def expected(tmp_path):
    """What a simulation along the same numbers in a CSV file gives."""
    titles = ["time [s]", *(f"{name} [{unit}]" for name, (unit, _) in RIG.items())]
    rows = zip(TIME.tolist(), *(values.tolist() for _, values in RIG.values()))
    (tmp_path / "rig.csv").write_text("\n".join([",".join(titles), *(",".join(map(repr, row)) for row in rows)]))
    return simulated(tmp_path, tmp_path / "rig.csv")


def signals(rig=RIG, time=TIME):
    return [asammdf.Signal(values, time, name=name, unit=unit) for name, (unit, values) in rig.items()]


def text_signals():
    """What such files have beside numbers."""
    return [
        asammdf.Signal(np.array([b"warm"] * TIME.size), TIME, name="note", encoding="utf-8"),
        asammdf.Signal(np.zeros((TIME.size, 3)), TIME, name="picture"),
    ]


@pytest.mark.parametrize("version", ["4.00", "4.10", "4.11", "4.20"])
@pytest.mark.parametrize("compression", [0, 1, 2])
def test_mdf_files_are_read_as_they_are_stored(tmp_path, expected, version, compression):
    with asammdf.MDF(version=version) as file:
        file.append(signals() + text_signals(), common_timebase=True)
        file.append([asammdf.Signal(np.arange(3.0), np.arange(3.0), name="rare", unit="N")])
        file.save(tmp_path / "rig.mf4", compression=compression)
    (tmp_path / "map.toml").write_text("only_named = true\n" + MAP)
    assert simulated(tmp_path, tmp_path / "rig.mf4", "--map", tmp_path / "map.toml") == expected


def test_scaled_whole_numbers_and_both_orders_of_bytes_are_read(tmp_path):
    """The value is what asammdf makes of the same file."""
    time = np.arange(300) * 2e-3
    stored = (2000 + 1500 * np.sin(4 * time)).astype(int)
    kinds = {"deflection": ("m", "<u2"), "path_speed": ("m/s", ">i4"), "slip_angle": ("rad", "<f8")}
    with asammdf.MDF(version="4.10") as file:
        for name, (unit, kind) in kinds.items():
            conversion = v4_blocks.ChannelConversion(conversion_type=1, a=2e-6, b=0.01)
            file.append([asammdf.Signal(stored.astype(kind), time, name=name, unit=unit, conversion=conversion)])
        file.save(tmp_path / "rig.mf4", compression=2)
    with asammdf.MDF(tmp_path / "rig.mf4") as file:
        physical = {name: file.get(name).samples for name in kinds}
    assert all(0.01 < values.min() and values.max() < 0.02 for values in physical.values())
    titles = ["time [s]", *(f"{name} [{unit}]" for name, (unit, _) in kinds.items())]
    rows = zip(time.tolist(), *(values.tolist() for values in physical.values()))
    (tmp_path / "rig.csv").write_text("\n".join([",".join(titles), *(",".join(map(repr, row)) for row in rows)]))
    assert outputs_differ(tmp_path, ["rig.csv"], ["rig.mf4"]) <= 1e-9


def outputs_differ(folder, *runs):
    """By how much of the greatest number the results of two runs differ."""
    one, other = (np.loadtxt(simulated(folder, folder / file, *arguments).decode().splitlines(), delimiter=",", skiprows=1)
                  for file, *arguments in runs)
    return np.abs(one - other).max() / np.abs(one).max()


def test_channels_of_several_rates_are_read_where_it_is_said_when(tmp_path):
    slow = TIME[::10]
    with asammdf.MDF(version="4.10") as file:
        file.append(signals({"deflection": RIG["deflection"]}))
        file.append(signals({name: (unit, values[::10]) for name, (unit, values) in RIG.items() if name != "deflection"}, slow))
        file.save(tmp_path / "rig.mf4")
    refused = latsch("simulate", "fiala-flat-track", "--inputs", tmp_path / "rig.mf4", "--output", tmp_path / "out.csv")
    assert refused.returncode == 2
    for words in ["deflection every 2.000e-3 s", "slip_angle every 2.000e-2 s", 'times_of = "deflection"', "only_named"]:
        assert words in refused.stderr, refused.stderr
    span = TIME[TIME <= slow[-1]]
    titles = ["time [s]", *(f"{name} [{unit}]" for name, (unit, _) in RIG.items())]
    columns = [RIG["deflection"][1][: span.size], *(np.interp(span, slow, values[::10]) for _, values in list(RIG.values())[1:])]
    np.savetxt(tmp_path / "rig.csv", np.column_stack([span, *columns]), delimiter=",", header=",".join(titles), comments="", fmt="%.17g")
    (tmp_path / "map.toml").write_text('times_of = "deflection"\n')
    assert outputs_differ(tmp_path, ["rig.csv"], ["rig.mf4", "--map", tmp_path / "map.toml"]) <= 1e-9


def test_what_an_mdf_file_marks_as_invalid_is_no_number(tmp_path):
    invalid = np.zeros(TIME.size, dtype=bool)
    invalid[[7, 9]] = True
    with asammdf.MDF(version="4.10") as file:
        one, *others = signals()
        one.invalidation_bits = invalid
        file.append([one, *others], common_timebase=True)
        file.save(tmp_path / "rig.mf4")
    refused = latsch("simulate", "fiala-flat-track", "--inputs", tmp_path / "rig.mf4", "--output", tmp_path / "out.csv")
    assert refused.returncode == 2
    assert "deflection (column 2), row 8: NaN is no finite number (and 1 more)" in refused.stderr, refused.stderr


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("form", ["variables", "structure", "matrix"])
def test_matlab_files_are_read_with_a_map(tmp_path, expected, form, compressed):
    columns = {"time": TIME, **{name: values for name, (_, values) in RIG.items()}}
    beside = {"note": "warm", "runs": np.array([[1, 2], [3, 4]], dtype=object), "mass": 12.0}
    prefix = lambda name, _: name
    if form == "structure":
        columns, prefix = {"rig": columns | beside}, lambda name, _: f"rig.{name}"
    elif form == "matrix":
        columns, prefix = {"rig": np.column_stack(list(columns.values()))}, lambda _, k: f"rig(:,{k})"
    scipy.io.savemat(tmp_path / "rig.mat", columns | beside, do_compression=compressed, oned_as="column")
    text = MAP
    for k, name in enumerate(["time", *RIG], 1):
        text = text.replace(f"\n{name} =", f'\n"{prefix(name, k)}" =')
    (tmp_path / "map.toml").write_text(text)
    assert simulated(tmp_path, tmp_path / "rig.mat", "--map", tmp_path / "map.toml") == expected


def test_a_matlab_file_without_a_map_says_what_is_in_it(tmp_path):
    refuse = lambda *arguments: latsch("simulate", "fiala-flat-track", "--inputs", tmp_path / "rig.mat", "--output", tmp_path / "out.csv", *arguments)
    scipy.io.savemat(tmp_path / "rig.mat", {"t": TIME, "SA": RIG["slip_angle"][1], "note": "warm"})
    refused = refuse()
    assert refused.returncode == 2 and 'variable = "time"' in refused.stderr and "t (400), SA (400), note (text)" in refused.stderr, refused.stderr
    (tmp_path / "map.toml").write_text('[channels]\nt = { variable = "time", unit = "s" }\n')
    refused = refuse("--map", tmp_path / "map.toml")
    assert refused.returncode == 2 and "SA (column 2): no unit" in refused.stderr, refused.stderr
    whole = (tmp_path / "rig.mat").read_bytes()
    (tmp_path / "rig.mat").write_bytes(whole[:-40])
    assert "cut off" in refuse("--map", tmp_path / "map.toml").stderr
    (tmp_path / "rig.mat").write_bytes(b"MATLAB 7.3 MAT-file".ljust(512))
    assert "-v7" in refuse().stderr


def table(unit=True):
    columns = {"time [s]" if unit else "time": TIME}
    columns |= {f"{name} [{u}]" if unit else name: values for name, (u, values) in RIG.items()}
    return pyarrow.table(columns | {"note": ["warm"] * TIME.size, "when": pyarrow.array(range(TIME.size), pyarrow.timestamp("us"))})


@pytest.mark.parametrize("compression", ["none", "snappy", "gzip", "lz4"])
def test_parquet_files_are_read(tmp_path, expected, compression):
    pyarrow.parquet.write_table(table(), tmp_path / "rig.parquet", compression=compression, row_group_size=150)
    assert simulated(tmp_path, tmp_path / "rig.parquet") == expected
    pyarrow.parquet.write_table(table(unit=False), tmp_path / "rig.parquet", compression=compression)
    (tmp_path / "map.toml").write_text(MAP)
    assert simulated(tmp_path, tmp_path / "rig.parquet", "--map", tmp_path / "map.toml") == expected


def test_what_is_missing_in_a_parquet_file_or_cannot_be_read_is_told(tmp_path):
    file = tmp_path / "rig.parquet"
    refuse = lambda: latsch("simulate", "fiala-flat-track", "--inputs", file, "--output", tmp_path / "out.csv")
    holes = pyarrow.table({"time [s]": TIME, "slip_angle [deg]": pyarrow.array([None, 1.0] * 200)})
    pyarrow.parquet.write_table(holes, file)
    assert "slip_angle (column 2), row 1: NaN" in refuse().stderr
    pyarrow.parquet.write_table(table(unit=False), file)
    assert "time (column 1): no unit, and 3 more have none" in refuse().stderr
    pyarrow.parquet.write_table(table(), file, compression="zstd")
    refused = refuse()
    assert refused.returncode == 2 and "zstd" in refused.stderr.lower(), refused.stderr
    file.write_bytes(file.read_bytes()[:-20])
    refused = refuse()
    assert refused.returncode == 2 and "Parquet" in refused.stderr, refused.stderr


def test_results_are_written_as_other_programs_read_them(tmp_path, expected):
    del expected
    for name in ["out.mf4", "out.parquet", "out.csv"]:
        done = latsch("simulate", "fiala-flat-track", "--inputs", tmp_path / "rig.csv", "--stop", STOP, "--output", tmp_path / name)
        assert done.returncode == 0, done.stderr
    head = (tmp_path / "out.csv").read_text().split("\n", 1)[0].split(",")
    rows = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)
    parquet = pyarrow.parquet.read_table(tmp_path / "out.parquet")
    assert parquet.column_names == head
    assert np.array_equal(np.column_stack([column.to_numpy() for column in parquet.columns]), rows)
    with asammdf.MDF(tmp_path / "out.mf4") as file:
        for title, values in zip(head[1:], rows.T[1:], strict=True):
            name, unit = title.removesuffix("]").split(" [")
            signal = file.get(name)
            assert signal.unit == unit and np.array_equal(signal.samples, values) and np.array_equal(signal.timestamps, rows[:, 0])
    refused = latsch("simulate", "fiala-flat-track", "--inputs", tmp_path / "rig.csv", "--output", tmp_path / "out.mat")
    assert refused.returncode == 2 and "not written" in refused.stderr


def test_an_identification_reads_them_with_a_map(tmp_path):
    """The map is read for each recording of the folder: what is wrong with one is told with its name."""
    (tmp_path / "rig").mkdir()
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(TIME, TIME, name="Fz", unit="N")])
        file.save(tmp_path / "rig" / "run-1.mf4")
    (tmp_path / "map.toml").write_text('[channels]\nFz = { variable = "force_z", unit = "furlong" }\n')
    done = latsch("identify", "ring-brush-flat-track", "--recordings", tmp_path / "rig", "--map", tmp_path / "map.toml", "--output", tmp_path / "p.toml")
    assert done.returncode == 2 and "run-1.mf4: force_z (column 2)" in done.stderr and "furlong" in done.stderr, done.stderr
