"""`latsch pad-friction`: the friction of pads out of a stop's torques and pressures."""

import csv
import json

import pytest
from conftest import ROOT, latsch, read_results

EXAMPLE = ROOT / "examples" / "car-abs-stop"


@pytest.mark.quick
def test_a_stop_tells_the_friction_of_its_pads_and_nothing_where_it_cannot(tmp_path):
    done = latsch("cosimulate", EXAMPLE / "system.toml", "--output", tmp_path / "stop.csv")
    assert done.returncode == 0, done.stderr
    command = ["pad-friction", EXAMPLE / "system.toml", "--recording", tmp_path / "stop.csv", "--output", tmp_path / "pads.csv"]
    done = latsch(*command, "--least", "5 bar", "--format", "json")
    assert done.returncode == 0, done.stderr
    found = {brake["brake"]: brake for brake in json.loads(done.stdout)}
    assert list(found) == ["brake_fl", "brake_fr", "brake_rl", "brake_rr"]
    results = read_results(tmp_path / "stop.csv")
    with open(tmp_path / "pads.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for brake, place in (("brake_fl", "front_left"), ("brake_rr", "rear_right")):
        pressure = results[f"{brake}.caliper_pressure"]
        first = next(k for k, p in enumerate(pressure) if p >= 5e5)
        told = 0
        for n, row in enumerate(rows):
            cell = row[f"{brake}.pad_friction [1]"]
            if not cell:
                continue
            told += 1
            k = first + n
            assert pressure[k] >= 5e5
            assert float(cell) == pytest.approx(results[f"{brake}.pad_friction"][k], rel=1e-9)
        assert told > 300, brake
        # pads of the model: 0.4 in full contact, a quarter of that at first
        assert 0.1 < found[brake]["first"] < 0.15
    assert found["brake_fl"]["level"] == pytest.approx(0.4, rel=1e-9)
    # channels by other names and without units
    text = (tmp_path / "stop.csv").read_text()
    header, rest = text.split("\n", 1)
    (tmp_path / "foreign.csv").write_text(header.replace("brake_fl.caliper_pressure [Pa]", "p_fl") + "\n" + rest)
    (tmp_path / "map.toml").write_text('[channels]\np_fl = { variable = "brake_fl.caliper_pressure", unit = "Pa" }\n')
    foreign = [tmp_path / "foreign.csv" if word == tmp_path / "stop.csv" else word for word in command]
    again = latsch(*foreign, "--map", tmp_path / "map.toml", "--least", "5 bar", "--format", "json")
    assert again.returncode == 0 and again.stdout == done.stdout, again.stderr
    # what is wrong is said
    done = latsch(*command, "--least", "5 s")
    assert done.returncode == 2 and "--least" in done.stderr and "Pa" in done.stderr
    done = latsch(*command, "--least", "300 bar")
    assert done.returncode == 2 and "300.0 bar" in done.stderr
