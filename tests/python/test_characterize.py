"""`latsch characterize`: a model and its FMU tell the same, and a Magic Formula tire what its coefficients say."""

import csv
import json
import math

import pytest
from conftest import ROOT, latsch

MODEL = "magic-formula-flat-track"
LOADS = (2000.0, 4000.0)


def characterized(folder, *arguments):
    done = latsch("characterize", *arguments, "--output", folder, "--loads", ",".join(map(str, LOADS)))
    assert done.returncode == 0, done.stderr
    with open(folder / "readings.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {(row["tire"], row["reading"], float(row["load [N]"])): float(row["value"] or "nan") for row in rows}, done


@pytest.mark.quick
def test_a_model_and_its_fmu_tell_the_same_and_what_the_coefficients_say(tmp_path):
    fmu = tmp_path / "mine.fmu"
    assert latsch("export", MODEL, "--output", fmu).returncode == 0
    found, done = characterized(tmp_path / "curves", "magic-formula", fmu, "--tydex", "--speeds", "10,30")
    assert not done.stderr
    own = {key[1:]: value for key, value in found.items() if key[0] == "magic-formula"}
    its = {key[1:]: value for key, value in found.items() if key[0] == "mine"}
    assert len(own) > 30 and own.keys() == its.keys()
    assert all(own[key] == its[key] or math.isnan(own[key]) and math.isnan(its[key]) for key in own)

    described = json.loads(latsch("describe", MODEL, "--format", "json").stdout)["variables"]
    c = {v["name"]: v["default"] for v in described if isinstance(v.get("default"), (int, float))}
    for load in LOADS:
        # Pacejka 2002: cornering stiffness, slip stiffness and peaks without camber, where nothing is shifted
        dfz = load / c["FNOMIN"] - 1
        cornering = -c["PKY1"] * c["FNOMIN"] * math.sin(2 * math.atan(load / (c["PKY2"] * c["FNOMIN"])))
        slip = load * (c["PKX1"] + c["PKX2"] * dfz) * math.exp(c["PKX3"] * dfz)
        assert found["mine", "cornering_stiffness", load] == pytest.approx(math.radians(cornering), rel=1e-4)
        assert found["mine", "slip_stiffness", load] == pytest.approx(0.01 * slip, rel=1e-4)
        assert found["mine", "braking_peak", load] == pytest.approx(c["PDX1"] + c["PDX2"] * dfz, rel=2e-3)
        assert found["mine", "lateral_peak", load] == pytest.approx(abs(c["PDY1"] + c["PDY2"] * dfz), rel=2e-3)

    # the example has that of the book, whose camber stiffness is 0.92 of the load per rad
    found, _ = characterized(tmp_path / "example", f"magic-formula@{ROOT / 'examples' / 'tires' / '205-60-r15.toml'}")
    tire = "205-60-r15"
    stiffness = 14.95 * 4000 * math.sin(2 * math.atan(1 / 2.13))
    assert found[tire, "cornering_stiffness", 4000.0] == pytest.approx(math.radians(stiffness), rel=1e-3)
    assert found[tire, "camber_stiffness", 4000.0] == pytest.approx(math.radians(0.92 * 4000), rel=5e-3)
    assert found[tire, "slip_stiffness", 4000.0] == pytest.approx(0.01 * 21.51 * 4000, rel=5e-3)
    assert found[tire, "braking_peak", 4000.0] == pytest.approx(1.21, rel=2e-3)

    page = (tmp_path / "curves" / "index.html").read_text()
    assert page.count("<svg") > 20 and "magic-formula, mine" in page and "108 km/h" in page
    with open(tmp_path / "curves" / "curves.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    held = [row for row in rows if row["curve"] == "cornering"]
    assert held and all(float(row["force_z [N]"]) == pytest.approx(float(row["load [N]"]), rel=1e-6) for row in held)
    names = {path.name for path in (tmp_path / "curves" / "tydex").iterdir()}
    assert {"mine-cornering-2000N.tdx", "mine-braking-4000N-30mps.tdx", "magic-formula-vertical.tdx"} <= names
    assert len(names) == 2 * 12


@pytest.mark.quick
def test_what_cannot_be_measured_is_refused_with_the_reason(tmp_path):
    def refused(*arguments):
        done = latsch("characterize", *arguments, "--output", tmp_path / "curves")
        assert done.returncode == 2, done.stderr
        return done.stderr

    assert "flat track" in refused("abs-controller")
    assert "there is no model" in refused("ring-brsh")
    assert "solid-tire" in refused("plan.toml")
    assert "--loads" in refused("ring-brush", "--loads", "4 km")
    assert "rise" in refused("ring-brush", "--loads", "4000,2000")
    assert "missing.tir" in refused("magic-formula@missing.tir")
    names = tmp_path / "names.toml"
    names.write_text('[names]\nslip_angle = "alpha"\n')
    fmu = tmp_path / "tire.fmu"
    assert latsch("export", MODEL, "--output", fmu).returncode == 0
    assert "alpha" in refused(fmu, "--names", names)
