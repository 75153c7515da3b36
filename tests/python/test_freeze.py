"""`latsch freeze`: a manifest of a system is the same wherever that lies, and what was changed is named, and nothing else."""

import hashlib
import json
import shutil
import tomllib

import pytest
from conftest import ROOT, latsch

SYSTEM = """
step = 1e-3
stop = 1.0
order = ["brake", "corner", "other"]
[component.brake]
model = "brake-hydraulics"
parameters = "brake.toml"
[component.corner]
model = "magic-formula-corner"
set = { initial_speed = "72 km/h", road_kind = "sine" }
[component.other]
model = "magic-formula-corner"
[connect]
"brake.brake_torque" = "corner.brake_torque"
"corner.wheel_speed" = { to = "other.friction_factor", factor = 1e-3, offset = 0.9 }
[[inputs]]
file = "parts/driver.csv"
connect = { p = "brake.driver_pressure" }
"""
FILES = {
    "system.toml": SYSTEM,
    "brake.toml": "[parameters]\npiston_area = 30e-4\n",
    "parts/driver.csv": "time [s],p [bar]\n0,0\n1,50\n",
}


@pytest.fixture
def system(tmp_path):
    folder = tmp_path / "here"
    (folder / "parts").mkdir(parents=True)
    for name, text in FILES.items():
        (folder / name).write_text(text)
    return folder


def frozen(folder, manifest):
    done = latsch("freeze", folder / "system.toml", "--output", manifest)
    assert done.returncode == 0, done.stderr
    return tomllib.loads(manifest.read_text())


def change(folder, file, old, new):
    text = (folder / file).read_text()
    assert text.count(old) == 1
    (folder / file).write_text(text.replace(old, new))


@pytest.mark.quick
def test_a_manifest_has_all_that_is_in_force_and_nothing_of_the_machine(system, tmp_path):
    said = frozen(system, system / "frozen.toml")
    assert said["system"]["file"] == "system.toml"
    assert said["system"]["order"] == ["brake", "corner", "other"] and said["system"]["step"] == 1e-3
    for stamp, name in [
        (said["system"], "system.toml"),
        (said["component"]["brake"]["parameters"], "brake.toml"),
        (said["input"]["brake.driver_pressure"], "parts/driver.csv"),
    ]:
        assert stamp["file"] == name
        assert stamp["sha256"] == hashlib.sha256((system / name).read_bytes()).hexdigest()
    # set here, from the file of parameters, and as the model has them
    corner, brake = (said["component"][name]["values"] for name in ("corner", "brake"))
    assert corner["initial_speed"] == "20.0 m/s" and corner["road_kind"] == "sine"
    assert brake["piston_area"] == "0.003 m2"
    described = json.loads(latsch("describe", "magic-formula-corner", "--format", "json").stdout)
    driven = {"brake_torque"}
    expected = {v["name"] for v in described["variables"] if v["causality"] in ("parameter", "input")} - driven
    assert set(corner) == expected
    assert said["connection"]["other.friction_factor"] == {"from": "corner.wheel_speed", "factor": 1e-3, "offset": 0.9}
    # elsewhere it is the same text
    other = tmp_path / "elsewhere" / "deeper"
    shutil.copytree(system, other)
    (other / "frozen.toml").unlink()
    frozen(other, tmp_path / "second.toml")
    text = (system / "frozen.toml").read_text()
    assert text == (tmp_path / "second.toml").read_text() and str(tmp_path) not in text
    # named from where it lies, too
    done = latsch("freeze", "system.toml", "--against", "frozen.toml", cwd=system)
    assert done.returncode == 0 and "0 differences" in done.stdout, done.stdout + done.stderr


CHANGES = [
    ("system.toml", '"72 km/h"', '"90 km/h"', ["corner.initial_speed: 20.0 m/s -> 25.0 m/s"]),
    ("brake.toml", "30e-4", "31e-4", ["brake.piston_area: 0.003 m2 -> 0.0031 m2"]),
    ("parts/driver.csv", "1,50", "1,51", ["bytes of parts/driver.csv: sha256 "]),
    ("system.toml", '{ to = "other.friction_factor", factor = 1e-3', '{ to = "other.friction_factor", factor = 2e-3',
     ["source of other.friction_factor: corner.wheel_speed, times 0.001 plus 0.9 -> corner.wheel_speed, times 0.002 plus 0.9"]),
    ("system.toml", '"brake.brake_torque" = "corner.brake_torque"', '"brake.brake_torque" = "other.brake_torque"',
     ["corner.brake_torque: not there -> 0.0 N.m", "other.brake_torque: 0.0 N.m -> not there",
      "source of corner.brake_torque: brake.brake_torque -> not there",
      "source of other.brake_torque: not there -> brake.brake_torque"]),
    ("system.toml", "step = 1e-3", "step = 5e-4", ["communication step: 0.001 s -> 0.0005 s"]),
    ("system.toml", '["brake", "corner"', '["corner", "brake"', ["order: brake, corner, other -> corner, brake, other"]),
    ("system.toml", "stop = 1.0", "# nothing\nstop = 1.0", ["bytes of system.toml: sha256 "]),
    ("brake.toml", "[parameters]", "[parameters] # nothing", ["bytes of brake.toml: sha256 "]),
]


@pytest.mark.quick
@pytest.mark.parametrize("file, old, new, lines", CHANGES)
def test_each_change_is_named_and_nothing_else(system, file, old, new, lines):
    frozen(system, system / "frozen.toml")
    change(system, file, old, new)
    done = latsch("freeze", system / "system.toml", "--against", system / "frozen.toml")
    assert done.returncode == 1, done.stderr
    *said, last = done.stdout.splitlines()
    assert last.endswith(f"{len(lines)} differences"), done.stdout
    assert len(said) == len(lines) and all(line.startswith(start) for line, start in zip(said, lines)), done.stdout
    done = latsch("freeze", system / "system.toml", "--against", system / "frozen.toml", "--format", "json")
    assert done.returncode == 1 and len(json.loads(done.stdout)["differences"]) == len(lines)
    # and back
    change(system, file, new, old)
    assert latsch("freeze", system / "system.toml", "--against", system / "frozen.toml").returncode == 0


@pytest.mark.quick
def test_another_part_is_named(system, exported):
    """A model exchanged for another one, one for its FMU, and that for one with another parameter."""
    frozen(system, system / "frozen.toml")
    against = ("--against", system / "frozen.toml")
    change(system, "system.toml", '[component.other]\nmodel = "magic-formula-corner"', '[component.other]\nmodel = "ring-brush-corner"')
    said = latsch("freeze", system / "system.toml", *against).stdout
    assert "component other: model magic-formula-corner -> model ring-brush-corner" in said and "corner.initial_speed" not in said
    fmu = system / "parts" / "other.fmu"
    shutil.copy(exported("magic-formula-corner"), fmu)
    change(system, "system.toml", 'model = "ring-brush-corner"', 'fmu = "parts/other.fmu"')
    said = latsch("freeze", system / "system.toml", *against).stdout
    assert "component other: model magic-formula-corner -> parts/other.fmu (magic-formula-corner)" in said
    part = frozen(system, system / "frozen.toml")["component"]["other"]
    assert part["fmu"] == {"file": "parts/other.fmu", "sha256": hashlib.sha256(fmu.read_bytes()).hexdigest()}
    assert part["guid"].startswith("{") and "latsch" in part["generation_tool"]
    parameters = system / "p.toml"
    parameters.write_text("[parameters]\nsuspension_stiffness = 21e3\n")
    done = latsch("export", "magic-formula-corner", "--parameters", parameters, "--output", fmu)
    assert done.returncode == 0, done.stderr
    said = latsch("freeze", system / "system.toml", *against).stdout
    assert "bytes of parts/other.fmu" in said and "GUID of other" in said
    assert "other.suspension_stiffness: " in said and "-> 21000.0 N/m" in said
    assert said.splitlines()[-1].endswith("3 differences"), said


@pytest.mark.quick
def test_what_is_wrong_is_said(system):
    (system / "no.toml").write_text("latsch = 3\n")
    for arguments, words in [
        (["system.toml", "--against", "no.toml"], ["no.toml:1", "no manifest"]),
        (["system.toml"], ["--output", "--against"]),
        (["system.toml", "--output", "system.toml"], ["overwrite"]),
        (["system.toml", "--against", "none.toml"], ["none.toml"]),
    ]:
        done = latsch("freeze", *arguments, cwd=system)
        assert done.returncode == 2 and all(word in done.stderr for word in words), done.stderr
    (system / "parts" / "driver.csv").unlink()
    done = latsch("freeze", "system.toml", "--output", "m.toml", cwd=system)
    assert done.returncode == 2 and "driver.csv" in done.stderr and not (system / "m.toml").exists()


@pytest.mark.quick
def test_the_example_is_frozen(tmp_path):
    """The car with its four brakes: all that a stop depends on, twice the same."""
    path = ROOT / "examples" / "car-abs-stop" / "system.toml"
    texts = []
    for name in ("a.toml", "b.toml"):
        assert latsch("freeze", path, "--output", tmp_path / name).returncode == 0
        texts.append((tmp_path / name).read_text())
    assert texts[0] == texts[1] and "select_low = true" in texts[0]
