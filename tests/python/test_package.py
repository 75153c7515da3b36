"""The Python package: a wheel of this build, installed into a folder of its own, in a process of its own."""

import json
import os
import re
import subprocess
import sys

import pytest
from conftest import PROGRAM, ROOT, TARGET

SCRIPT = """
import json, pathlib, sys, zipfile
import numpy as np
import latsch

assert pathlib.Path(latsch.__file__).is_relative_to(sys.argv[1])
names = [m["name"] for m in latsch.models()]
assert "ring-brush-flat-track" in names
assert {v["name"] for v in latsch.describe("magic-formula-flat-track")["variables"]} >= {"slip_angle", "force_y"}

t = np.linspace(0, 0.5, 51)
inputs = latsch.Recording(t, {"slip_angle": 2 * np.sin(4 * np.pi * t)}, {"slip_angle": "deg"})
values = {"path_speed": "72 km/h", "load_control": True, "load": 3000}
run = latsch.simulate("magic-formula-flat-track", inputs, values=values, parameters={"VERTICAL_STIFFNESS": "250 N/mm"}, channels=["force_y", "force_z", "slip_angle"])
assert run.time[0] == 0 and run.time[-1] == 0.5 and run.units == {"force_y": "N", "force_z": "N", "slip_angle": "rad"}
assert np.allclose(np.interp(t, run.time, run["slip_angle"]), np.radians(inputs["slip_angle"]), atol=1e-9)
assert np.abs(run["force_z"] - 3000).max() < 60 and np.corrcoef(run["force_y"], run["slip_angle"])[0, 1] < -0.9
assert any("command_actuators" in note for note in run.notes)

fmu = latsch.export("magic-formula-flat-track", "tire.fmu", parameters={"VERTICAL_STIFFNESS": 250e3})
again = latsch.simulate(fmu, inputs, values=values, channels=list(run))
assert all(np.array_equal(run[name], again[name]) for name in run)

with zipfile.ZipFile(latsch.export("linear-wheel", "three.fmu", fmi=3)) as three:
    assert b'fmiVersion="3.0"' in three.read("modelDescription.xml")

tires = latsch.characterize("magic-formula", fmu, loads=["2 kN", "4 kN"])
assert tires.reading("vertical_stiffness", 4000.0, "tire") - 250 < 1e-6
for asked, words in ((("locked", 4000), "magic-formula, tire"), (("grip", 4000, "tire"), "cornering_stiffness"), (("locked", 3000, "tire"), "2000.0, 4000.0")):
    try:
        tires.reading(*asked)
    except KeyError as error:
        assert words in str(error), error
    else:
        raise AssertionError("there is no such number")
assert tires.curves["force_y"].shape == tires.curves["slip_angle"].shape and "<svg" in tires.page.html
assert tires.page._repr_html_().startswith("<iframe")

for call in (lambda: latsch.simulate("ring-brush-wheal"), lambda: latsch.export("axle", "x.fmu", parameters={"nonsense": 1.0})):
    try:
        call()
    except latsch.LatschError as error:
        assert error.exit_code == 2 and "error:" not in str(error)
    else:
        raise AssertionError("nothing was refused")
print(json.dumps(names))
"""


@pytest.fixture(scope="module")
def installed(made_once):
    def make(folder):
        library = TARGET / "debug" / "liblatsch_fmu.so"
        made = subprocess.run(
            [sys.executable, ROOT / "scripts" / "wheel", "--program", PROGRAM, "--library", library, "--output", folder],
            check=True, capture_output=True, text=True,
        )
        install = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
        subprocess.run([*install, "--target", folder / "site", made.stdout.strip()], check=True)

    return made_once("package", make) / "site"


def test_functions_do_what_the_program_does(installed, tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    environment.pop("LATSCH_LIBRARY", None)
    done = subprocess.run([sys.executable, "-c", SCRIPT, installed], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = subprocess.run([installed / "bin" / "latsch", "models", "--format", "json"], env=environment, capture_output=True, text=True, check=True)
    assert [m["name"] for m in json.loads(told.stdout)] == json.loads(done.stdout)


def test_recordings_are_diagnosed_and_what_they_lack_is_said(installed, tmp_path):
    script = """
import pathlib
import sys
import types
# a notebook, as far as the package asks
sys.modules["IPython"] = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=True, config={}))
import contextlib
import latsch
import numpy as np
import scipy.io

rng, t = np.random.default_rng(1), np.linspace(0, 2, 401)
runs = {}
for k in range(4):
    pressure = np.interp(t, np.linspace(0, 2, 9), 20 + 30 * rng.random(9))
    driver = latsch.Recording(t, {"driver_pressure": pressure}, {"driver_pressure": "bar"})
    run = latsch.simulate("brake-hydraulics", driver, values={"friction": 0.36}, step=0.005, channels=["driver_pressure", "brake_torque"])
    run.channels["brake_torque"] = run["brake_torque"] + rng.normal(0, 2, len(run.time))
    # by way of a file of another program
    scipy.io.savemat(f"{k}.mat", {"t": run.time, "p": 1e-5 * run["driver_pressure"], "M": run["brake_torque"]})
    file = scipy.io.loadmat(f"{k}.mat", squeeze_me=True)
    units = {"driver_pressure": "bar", "brake_torque": "N.m"}
    runs[f"stop-{k}"] = latsch.Recording(file["t"], {"driver_pressure": file["p"], "brake_torque": file["M"]}, units)

class Bar(contextlib.AbstractContextManager):
    # what is shown of a bar depends on how long it takes, what it is told does not
    def __init__(self, total, disable, **_):
        self.total, self.disable, self.n, self.what, self.told = total, disable, 0, "", []
        bars.append(self)

    def __exit__(self, *_):
        pass

    def set_description_str(self, what, refresh):
        self.what = what

    def update(self, more):
        self.n += more
        self.told.append((self.n, self.what))

bars, latsch.tqdm = [], Bar
found = latsch.diagnose("brake-hydraulics", runs, output="found", jobs=1)
[bar] = bars
shares = [share for share, _ in bar.told]
assert not bar.disable and len(shares) > 3 and shares == sorted(shares) and 0 < shares[-1] <= bar.total, bar.told
assert len({what for _, what in bar.told if what}) > 2, bar.told
# friction, radius and piston make one factor of the torque
values = {p["name"]: p["value"] for p in found.result["parameters"]}
factor = values["friction"] * values["friction_radius"] * values["piston_area"]
start = {v["name"]: v["default"] for v in latsch.describe("brake-hydraulics")["variables"]}
expected = 0.36 * start["friction_radius"] * start["piston_area"]
assert found.verdict == "parameters" and abs(factor / expected - 1) < 0.01, (found.verdict, factor, expected)
assert pathlib.Path("found/corrected.fmu").is_file() and "<svg" in found.page.html

latsch.rig_program("ring-brush-flat-track", "programme")
try:
    latsch.identify("ring-brush-flat-track", "programme")
except latsch.LatschError as error:
    assert 'there is no channel "force_x"' in str(error), error
else:
    raise AssertionError("commands are no recording")
"""
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.quick
def test_the_package_of_a_registry_has_all_that_its_sources_take_in():
    """`cargo install` of a registry's package builds from what is listed here, and from nothing else of the checkout."""
    listed = subprocess.run(["cargo", "package", "--list", "--allow-dirty", "--offline", "--package", "latsch"], cwd=ROOT, capture_output=True, text=True)
    files = set(listed.stdout.split("\n"))
    assert {"build.rs", "Cargo.lock", "src/main.rs"} <= files, listed.stderr
    count = 0
    for source in (ROOT / name for name in files if name.startswith("src/") and name.endswith(".rs")):
        for taken in re.findall(r'include_(?:str|bytes)!\(\s*"([^"]+)"', source.read_text()):
            count += 1
            assert os.path.relpath((source.parent / taken).resolve(), ROOT) in files, f"{source}: {taken}"
    assert count > 40, count
