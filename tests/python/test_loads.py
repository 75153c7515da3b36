"""`latsch loads` against the packages that fatigue engineers know: rainflow and fatpack, and against numpy."""

import csv

import fatpack
import numpy as np
import pytest
import rainflow
from conftest import latsch
from scipy import stats

SLOPE = 5.0
CLASSES = 64


def history(seed, scale=1.0, seconds=20.0):
    """A link's force over a stop, made up: a level, two modes and noise, at 400 Hz."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 1 / 400)
    noise = np.convolve(random.normal(size=time.size), np.ones(9) / 9, "same")
    force = 2000 + 1500 * np.sin(2 * np.pi * 1.1 * time) + 600 * np.sin(2 * np.pi * 10.3 * time) + 900 * noise
    return time, scale * force


def write(path, time, force, name="F_SS", unit="N", pressure=None):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", f"{name} [{unit}]"] + (["p [bar]"] if pressure is not None else []))
        for k, (t, f) in enumerate(zip(time, force)):
            writer.writerow([t, f] + ([pressure[k]] if pressure is not None else []))


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def loads(*arguments):
    run = latsch("loads", *arguments)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_recordings_of_another_program_are_read_with_a_map(tmp_path):
    write(tmp_path / "simulated.csv", *history(1))
    time, force = history(2)
    write(tmp_path / "recorded.csv", time, force)
    write(tmp_path / "foreign.csv", time, force, name="Kanal 7", unit="-")
    (tmp_path / "map.toml").write_text('[channels]\n"Kanal 7" = { variable = "F_SS", unit = "N" }\n')
    plain = loads(tmp_path / "simulated.csv", "--recording", tmp_path / "recorded.csv")
    assert "F_SS [N]" in plain
    assert loads(tmp_path / "simulated.csv", "--recording", tmp_path / "foreign.csv", "--map", tmp_path / "map.toml") == plain


def test_cycles_and_damage_are_those_of_rainflow_and_fatpack(tmp_path):
    for name, seed in [("simulated", 1), ("recorded", 2)]:
        write(tmp_path / f"{name}.csv", *history(seed))
    loads(
        tmp_path / "simulated.csv", "--recording", tmp_path / "recorded.csv", "--gate", 0,
        "--table", tmp_path / "table.csv", "--counts", tmp_path / "counts.csv",
    )
    found = {row["quantity"]: row for row in table(tmp_path / "table.csv")}
    counts = table(tmp_path / "counts.csv")
    both = {"simulated": history(1)[1], "recorded_1": history(2)[1]}
    damage = {}
    for column, force in both.items():
        # (range, mean, count, start, end), of the ASTM standard
        cycles = np.array([(c[0], c[2]) for c in rainflow.extract_cycles(force)])
        assert float(found["cycles"][column]) == pytest.approx(cycles[:, 1].sum(), abs=1e-9)
        assert float(found["largest range"][column]) == pytest.approx(cycles[:, 0].max(), rel=1e-12)
        damage[column] = (cycles[:, 1] * cycles[:, 0] ** SLOPE).sum()
        # each class of ranges
        edges = np.array([float(row["range_from"]) for row in counts] + [float(counts[-1]["range_to"])])
        pairs, _ = np.histogram(cycles[:, 0], bins=edges, weights=cycles[:, 1])
        ours = [float(row[f"{column}_cycles"]) for row in counts]
        # a range on an edge may fall to either side
        assert np.abs(np.cumsum(ours) - np.cumsum(pairs)).max() <= 1.0
        assert np.abs(ours - pairs).sum() <= 2.0
        # fatpack counts whole cycles with the residue run through twice: closed ones are the same, and the largest
        ranges = fatpack.find_rainflow_ranges(force, k=2**20)
        assert ranges.max() == pytest.approx(cycles[:, 0].max(), rel=1e-5)
        assert (ranges**SLOPE).sum() == pytest.approx(damage[column], rel=0.05)
    ratio = damage["simulated"] / damage["recorded_1"]
    assert float(found["damage"]["recorded_1"]) == pytest.approx(1.0, rel=1e-12)
    assert float(found["damage"]["simulated"]) == pytest.approx(ratio, rel=1e-9)


def test_matrices_are_those_of_the_package(tmp_path):
    """Each cell against the package's cycles, sorted into classes one by one; the simulation reaches beyond the recorded span."""
    write(tmp_path / "simulated.csv", *history(6, scale=1.3))
    write(tmp_path / "recorded.csv", *history(7))
    loads(
        tmp_path / "simulated.csv", "--recording", tmp_path / "recorded.csv", "--gate", 0, "--classes", 20,
        "--matrix", tmp_path / "matrix.csv", "--counts", tmp_path / "counts.csv", "--table", tmp_path / "table.csv",
    )
    rows = table(tmp_path / "matrix.csv")
    pairs = table(tmp_path / "counts.csv")
    found = {row["quantity"]: row for row in table(tmp_path / "table.csv")}
    low, high = (f(history(7)[1]) for f in (min, max))
    width = (high - low) / 20
    for run, force in [("simulated", history(6, scale=1.3)[1]), ("recorded_1", history(7)[1])]:
        ours = {}
        for row in (row for row in rows if row["run"] == run):
            assert row["channel"] == "F_SS" and row["unit"] == "N"
            assert float(row["from_high"]) - float(row["from_low"]) == pytest.approx(width, rel=1e-9)
            cell = tuple(round((float(row[name]) - low) / width) for name in ("from_low", "to_low"))
            assert cell not in ours
            ours[cell] = float(row["cycles"])
        theirs = {}
        for _, _, count, start, end in rainflow.extract_cycles(force):
            cell = tuple(19 if v == high else int(np.floor((v - low) / width)) for v in (force[start], force[end]))
            theirs[cell] = theirs.get(cell, 0.0) + count
        assert ours == theirs
        assert sum(ours.values()) == sum(float(row[f"{run}_cycles"]) for row in pairs) == float(found["cycles"][run])
        # ends of a range of k classes are k or k + 1 classes apart, or one less where the highest value belongs to the last class
        for k, row in enumerate(pairs[:39]):
            both = sum(n for (a, b), n in ours.items() if abs(a - b) in (k - 1, k, k + 1))
            assert both >= float(row[f"{run}_cycles"])
    assert min(min(cell) for cell in ours) == 0 and max(max(cell) for cell in ours) == 19
    assert any(row["run"] == "simulated" and float(row["to_low"]) >= high - 1e-9 for row in rows)


def test_level_crossings_are_counted_as_by_hand(tmp_path):
    for name, seed in [("simulated", 3), ("recorded", 4)]:
        write(tmp_path / f"{name}.csv", *history(seed))
    loads(
        tmp_path / "simulated.csv", "--recording", tmp_path / "recorded.csv", "--gate", 0,
        "--counts", tmp_path / "counts.csv",
    )
    rows = [row for row in table(tmp_path / "counts.csv") if row["level"]]
    assert len(rows) == CLASSES
    for row in rows:
        for column, seed in [("simulated", 3), ("recorded_1", 4)]:
            above = history(seed)[1] >= float(row["level"])
            assert int(row[f"{column}_crossings"]) == np.sum(~above[:-1] & above[1:])


def test_repeats_make_a_band_and_an_event_makes_the_time(tmp_path):
    """Recordings begin at other times, in kN and under another name; the simulation has 25 % more."""
    time, force = history(5)
    pressure = np.where(time > 2.0, 30.0, 0.0)
    write(tmp_path / "simulated.csv", time, 1.25 * force, pressure=pressure)
    for k, (late, scale) in enumerate([(0.0, 0.97), (1.3, 1.0), (0.4, 1.03)]):
        write(tmp_path / f"{k}.csv", time + late, scale * force / 1e3, name="tie_rod", unit="kN", pressure=pressure)
    recordings = [part for k in range(3) for part in ("--recording", tmp_path / f"{k}.csv")]
    said = loads(
        tmp_path / "simulated.csv", *recordings, "--channel", "F_SS=tie_rod", "--event", "p>10 bar",
        "--window", "-1.001:15.001", "--gate", 0, "--table", tmp_path / "table.csv", "--report", tmp_path / "page.html",
    )
    assert "damage" in said and "ABOVE the" in said
    found = {row["quantity"]: row for row in table(tmp_path / "table.csv")}
    # 1.25^5 over 0.97^5, all from the same 16 s
    assert float(found["damage"]["simulated"]) == pytest.approx((1.25 / 0.97) ** 5, rel=1e-6)
    assert float(found["damage"]["recorded_3"]) == pytest.approx((1.03 / 0.97) ** 5, rel=1e-6)
    # 95 % of a further one, by Student's t
    three = np.array([float(found["damage"][f"recorded_{k}"]) for k in (1, 2, 3)])
    half = stats.t.ppf(0.975, 2) * three.std(ddof=1) * np.sqrt(4 / 3)
    assert float(found["damage"]["further_to"]) == pytest.approx(three.mean() + half, rel=1e-9)
    assert float(found["damage"]["off"]) == pytest.approx((float(found["damage"]["simulated"]) - three.mean()) / half, rel=1e-9)
    assert float(found["damage"]["off"]) > 1
    assert found["cycles"]["off"] == ""
    page = (tmp_path / "page.html").read_text()
    assert "times as far off" in page and "up-crossings" in page and "amplitude" in page


@pytest.mark.quick
@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--channel", "F_XX"], ["F_XX", "F_SS"]),
        (["--event", "p>10"], ["there is no channel", "p"]),
        (["--event", "F_SS>9e9"], ["never above"]),
        (["--event", "F_SS"], ["CHANNEL>VALUE"]),
        (["--window", "5:1"], ["FROM:TO"]),
        (["--window", "50:60"], ["no samples"]),
        (["--window", "1:60"], ["there is only"]),
        (["--over", "F_SS"], ["goes back"]),
        (["--slope", "0"], ["--slope"]),
        (["--classes", "1"], ["--classes"]),
        (["--gate", "1"], ["--gate"]),
    ],
)
def test_what_is_wrong_is_said(tmp_path, arguments, words):
    write(tmp_path / "a.csv", *history(1, seconds=2.0))
    write(tmp_path / "b.csv", *history(2, seconds=2.0))
    run = latsch("loads", tmp_path / "a.csv", "--recording", tmp_path / "b.csv", *arguments)
    assert run.returncode == 2 and all(word in run.stderr for word in words), run.stderr
