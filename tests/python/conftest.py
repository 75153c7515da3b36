"""What the tests from outside share: the program, exported FMUs, a slave driven by hand."""

import csv
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import zipfile

import fmpy
import fmpy.fmi2
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = TARGET / "debug" / "latsch"
# Seconds after which something hangs. What takes one on an idle machine takes ten on a slow one that is busy, which is no failure.
PATIENCE = 1800
MODEL = "ring-brush-flat-track"
TWO_MASSES = ROOT / "examples" / "two-masses"
INPUTS = ["steer", "deflection", "path_speed", "camber", "slip", "slip_angle"]
# Every shipped model: start values that let something happen, and inputs that change later.
MODELS = {
    MODEL: (dict(deflection=0.02, path_speed=15.0, slip_angle=0.02), dict(slip=0.1)),
    "ring-brush-tire": (dict(rim_velocity_y=0.3, road_slope_x=0.02), dict(rim_spin_rate=35.0, friction_factor=0.7)),
    "ring-brush-wheel": (dict(steer=0.02, brake_torque=300.0), dict(axle_force_y=-500.0, brake_torque=2500.0)),
    "ring-brush-corner": (dict(brake_torque=800.0), dict(brake_torque=3000.0, friction_factor=0.5)),
    "ring-brush-hydropulse": (dict(force=4000.0), dict(force=5000.0)),
    "ring-brush-drum": (dict(drum_speed=5.0), dict(drum_speed=4.0, brake_torque=40.0)),
    "magic-formula-flat-track": (dict(deflection=0.02, path_speed=15.0, slip_angle=0.02), dict(slip=0.1)),
    "magic-formula-tire": (dict(rim_velocity_y=0.3, road_slope_x=0.02), dict(rim_spin_rate=35.0, friction_factor=0.7)),
    "magic-formula-wheel": (dict(steer=0.02, brake_torque=300.0), dict(axle_force_y=-500.0, brake_torque=2500.0)),
    "magic-formula-corner": (dict(brake_torque=800.0), dict(brake_torque=3000.0, friction_factor=0.5)),
    "magic-formula-hydropulse": (dict(force=4000.0), dict(force=5000.0)),
    "magic-formula-drum": (dict(drum_speed=5.0), dict(drum_speed=4.0, brake_torque=40.0)),
    "super-elastic-flat-track": (dict(deflection=0.012, path_speed=3.0), dict(slip=0.1)),
    "super-elastic-tire": (dict(rim_z=0.215, rim_velocity_x=3.0, rim_spin_rate=13.5), dict(rim_spin_rate=15.0, friction_factor=0.7)),
    "super-elastic-wheel": (dict(initial_speed=3.0, brake_torque=50.0), dict(brake_torque=400.0)),
    "super-elastic-corner": (dict(initial_speed=3.0, brake_torque=100.0), dict(brake_torque=400.0, friction_factor=0.5)),
    "super-elastic-hydropulse": (dict(force=6000.0), dict(force=9000.0)),
    "super-elastic-drum": (dict(drum_speed=3.0), dict(drum_speed=4.0, brake_torque=40.0)),
    "fiala-flat-track": (dict(deflection=0.012, path_speed=5.0, slip_angle=0.02), dict(slip=0.1)),
    "fiala-tire": (dict(rim_z=0.215, rim_velocity_x=3.0, rim_spin_rate=13.5), dict(rim_spin_rate=15.0, friction_factor=0.7)),
    "fiala-wheel": (dict(initial_speed=10.0, steer=0.02, brake_torque=50.0), dict(axle_force_y=-500.0, brake_torque=800.0)),
    "fiala-corner": (dict(initial_speed=10.0, brake_torque=100.0), dict(brake_torque=900.0, friction_factor=0.5)),
    "ua-flat-track": (dict(deflection=0.012, path_speed=5.0, slip_angle=0.02), dict(slip=0.1)),
    "ua-tire": (dict(rim_z=0.215, rim_velocity_x=3.0, rim_spin_rate=13.5), dict(rim_spin_rate=15.0, friction_factor=0.7)),
    "ua-wheel": (dict(initial_speed=10.0, steer=0.02, brake_torque=50.0), dict(axle_force_y=-500.0, brake_torque=800.0)),
    "ua-corner": (dict(initial_speed=10.0, brake_torque=100.0), dict(brake_torque=900.0, friction_factor=0.5)),
    "tmeasy-flat-track": (dict(deflection=0.012, path_speed=5.0, slip_angle=0.02), dict(slip=0.1)),
    "tmeasy-tire": (dict(rim_z=0.215, rim_velocity_x=3.0, rim_spin_rate=13.5), dict(rim_spin_rate=15.0, friction_factor=0.7)),
    "tmeasy-wheel": (dict(initial_speed=10.0, steer=0.02, brake_torque=50.0), dict(axle_force_y=-500.0, brake_torque=800.0)),
    "tmeasy-corner": (dict(initial_speed=10.0, brake_torque=100.0), dict(brake_torque=900.0, friction_factor=0.5)),
    "swift-flat-track": (dict(deflection=0.012, path_speed=5.0, slip_angle=0.02), dict(slip=0.1)),
    "swift-tire": (dict(rim_velocity_y=0.3, road_slope_x=0.02), dict(rim_spin_rate=35.0, friction_factor=0.7)),
    "swift-wheel": (dict(initial_speed=10.0, steer=0.02, brake_torque=50.0), dict(axle_force_y=-500.0, brake_torque=800.0)),
    "swift-corner": (dict(initial_speed=10.0, brake_torque=100.0), dict(brake_torque=900.0, friction_factor=0.5)),
    "linear-wheel": (dict(initial_speed=10.0, steer=0.02, brake_torque=50.0), dict(axle_force_y=-500.0, brake_torque=800.0)),
    "linear-corner": (dict(initial_speed=10.0, brake_torque=100.0), dict(brake_torque=900.0, friction_factor=0.5)),
    "linear-hydropulse": (dict(force=4000.0), dict(force=5000.0)),
    "linear-drum": (dict(drum_speed=3.0), dict(drum_speed=4.0, brake_torque=40.0)),
    "linear-counterbalance-truck": (dict(speed=2.0), dict(speed=2.5)),
    "super-elastic-counterbalance-truck": (dict(speed=2.0), dict(speed=2.5)),
    "ring-brush-vehicle": ({"steering_wheel_angle": 0.1}, {"front_left.brake_torque": 800.0, "rear_right.friction_factor": 0.5}),
    "magic-formula-vehicle": ({"steering_wheel_angle": 0.1}, {"front_left.brake_torque": 800.0, "rear_right.friction_factor": 0.5}),
    "axle": ({"left.carrier_force_x": -100.0}, {"left.carrier_force_x": -2000.0, "right.carrier_moment_y": 500.0}),
    "brake-hydraulics": (dict(driver_pressure=5e6), dict(inlet_valve=0.0, outlet_valve=0.4)),
    "abs-controller": (dict(wheel_speed_1=60.0, driver_pressure=1e7), dict(wheel_speed_1=45.0)),
}


def pytest_configure(config):
    config.addinivalue_line("markers", "quick: part of scripts/test --quick; takes no more than a few seconds")


@pytest.fixture(scope="session")
def made_once(tmp_path_factory):
    """Folders of what takes long to make: where tests run in several processes, one of them makes it, and the others wait and share it.
    To be called with a name and with what fills the folder."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent

    def folder(name, make):
        path, stamp = shared / name, shared / f"{name}.made"
        with open(shared / f"{name}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not stamp.exists():
                # what a process that failed has left
                shutil.rmtree(path, ignore_errors=True)
                path.mkdir()
                make(path)
                stamp.touch()
        return path

    return folder


@pytest.fixture(scope="session")
def demo(made_once):
    """What `latsch demo` writes."""
    def make(folder):
        done = latsch("demo", "--output", folder / "demo")
        assert done.returncode == 0, done.stderr

    return made_once("demo", make) / "demo"


def latsch(*arguments, cwd=None):
    """Runs the program; returns the finished process with its texts."""
    return subprocess.run(
        [PROGRAM, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=PATIENCE
    )


def read_results(path):
    """Columns of a CSV file by name without unit."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    names = [cell.split(" [")[0] for cell in header]
    return {name: [float(row[i]) for row in rows] for i, name in enumerate(names)}


class Slave:
    """An instance in FMPy, by variable names, with the messages that it logged."""

    def __init__(self, fmu, start=None, name="tire"):
        self.description = fmpy.read_model_description(str(fmu))
        self.folder = fmpy.extract(str(fmu))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.messages = []
        self.raw = fmpy.fmi2.FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        # kept: the FMU copies the struct but not the Python function behind it
        self.callbacks = self._callbacks()
        self.raw.instantiate(callbacks=self.callbacks)
        if start is not None:
            self.begin(start)

    def _callbacks(self):
        functions = fmpy.fmi2.fmi2CallbackFunctions()

        def log(_environment, instance, status, category, message):
            self.messages.append((status, category.decode(), message.decode()))

        functions.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(log)
        functions.allocateMemory = fmpy.fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        functions.freeMemory = fmpy.fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        return functions

    def begin(self, start, time=0.0, stop=None):
        self.raw.setupExperiment(startTime=time, stopTime=stop)
        self.raw.enterInitializationMode()
        self.set(**start)
        self.raw.exitInitializationMode()

    def set(self, **values):
        switches = {n: v for n, v in values.items() if isinstance(v, bool)}
        numbers = {n: v for n, v in values.items() if n not in switches}
        self.raw.setReal([self.references[n] for n in numbers], list(numbers.values()))
        if switches:
            self.raw.setBoolean([self.references[n] for n in switches], list(switches.values()))

    def rates(self, **values):
        references = [self.references[n] for n in values]
        count = len(references)
        self.raw.fmi2SetRealInputDerivatives(
            self.raw.component,
            (fmpy.fmi2.fmi2ValueReference * count)(*references),
            count,
            (fmpy.fmi2.fmi2Integer * count)(*[1] * count),
            (fmpy.fmi2.fmi2Real * count)(*values.values()),
        )

    def get(self, *names):
        return self.raw.getReal([self.references[n] for n in names])

    def derivatives(self, *names, order=1):
        references = [self.references[n] for n in names]
        count = len(references)
        values = (fmpy.fmi2.fmi2Real * count)()
        self.raw.fmi2GetRealOutputDerivatives(
            self.raw.component,
            (fmpy.fmi2.fmi2ValueReference * count)(*references),
            count,
            (fmpy.fmi2.fmi2Integer * count)(*[order] * count),
            values,
        )
        return list(values)

    def directional(self, unknowns, seed):
        return self.raw.getDirectionalDerivative(
            [self.references[n] for n in unknowns],
            [self.references[n] for n in seed],
            list(seed.values()),
        )

    def outputs(self):
        references = [
            v.valueReference
            for v in self.description.modelVariables
            if v.causality in ("output", "local") and v.type == "Real"
        ]
        return self.raw.getReal(references)

    def steps(self, count, start=0.0, length=1e-3):
        for k in range(count):
            self.raw.doStep(start + k * length, length)

    def close(self):
        self.raw.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def rewrite(source, target, change):
    """Copies an FMU, entry by entry, through `change(name, data)`; None leaves it out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            data = change(name, old.read(name))
            if data is not None:
                new.writestr(name, data)
    return target


@pytest.fixture(scope="session")
def exported(tmp_path_factory):
    """Exports models as they are, each once."""
    folder = tmp_path_factory.mktemp("fmu")

    def export(model):
        path = folder / f"{model}.fmu"
        if not path.exists():
            done = latsch("export", model, "--output", path)
            assert done.returncode == 0, done.stderr
        return path

    return export


@pytest.fixture(scope="session")
def base_model(tmp_path_factory):
    """Exports base models of the blind study, each once."""
    folder = tmp_path_factory.mktemp("base")
    subprocess.run(["cargo", "build", "--quiet", "--locked", "--workspace"], cwd=ROOT, check=True)

    def export(model):
        path = folder / f"{model}.fmu"
        if not path.exists():
            done = latsch("export", model, "--library", TARGET / "debug" / "libbase_models.so", "--output", path)
            assert done.returncode == 0, done.stderr
        return path

    return export


@pytest.fixture(scope="session")
def fmu(exported):
    """The flat track's FMU with the example tire."""
    return exported(MODEL)


@pytest.fixture(scope="session", params=MODELS)
def shipped(request, exported):
    """The FMU of each shipped model in turn."""
    return exported(request.param)


@pytest.fixture
def slaves(fmu):
    """Makes slaves and frees them after the test."""
    made = []

    def make(start=None, path=fmu, **options):
        made.append(Slave(path, start, **options))
        return made[-1]

    yield make
    for slave in made:
        slave.close()


def own_library(crate, name, code):
    """A user's library: the template copied out of the repository, with other code. Optimised as the rest is: what is simulated with it
    takes longer than that."""
    shutil.copytree(ROOT / "fmu-template", crate)
    manifest = (crate / "Cargo.toml").read_text()
    for old, new in [('path = ".."', f'path = "{ROOT}"'), ('name = "latsch-fmu"', f'name = "{name}"')]:
        assert old in manifest
        manifest = manifest.replace(old, new)
    (crate / "Cargo.toml").write_text(manifest)
    (crate / "src" / "lib.rs").write_text(code)
    shutil.copy(ROOT / "Cargo.lock", crate)
    # a folder of its own in cargo's target, so that a second run is fast
    target = TARGET / "template"
    profile = dict(CARGO_PROFILE_DEV_OPT_LEVEL="1", CARGO_PROFILE_DEV_DEBUG="false")
    done = subprocess.run(
        ["cargo", "build", "--manifest-path", crate / "Cargo.toml"],
        env=dict(os.environ, CARGO_TARGET_DIR=str(target), **profile),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return target / "debug" / f"lib{name.replace('-', '_')}.so"


@pytest.fixture(scope="session")
def template_library(tmp_path_factory):
    """The oscillator of the template's README and a model that panics."""
    code = re.search(r"```rust\n(.*?)```", (ROOT / "fmu-template" / "README.md").read_text(), re.S).group(1)
    assert "export_fmus!(Oscillator)" in code
    code = code.replace("export_fmus!(Oscillator)", "export_fmus!(Oscillator, Bomb)")
    code += (ROOT / "tests" / "data" / "bomb.rs").read_text()
    return own_library(tmp_path_factory.mktemp("own") / "my-models", "my-models", code)


@pytest.fixture(scope="session")
def two_masses_library(tmp_path_factory):
    """The example of two masses, built as a user does."""
    return own_library(tmp_path_factory.mktemp("two") / "two-masses", "two-masses", (TWO_MASSES / "lib.rs").read_text())


@pytest.fixture(scope="session")
def system(tmp_path_factory, two_masses_library):
    """The same with its FMU."""
    folder = tmp_path_factory.mktemp("system")
    for name in ["system.toml", "SystemStructure.ssd"]:
        shutil.copy(TWO_MASSES / name, folder)
    done = latsch("export", "coupled-oscillator", "--library", two_masses_library, "--output", folder / "coupled-oscillator.fmu")
    assert done.returncode == 0, done.stderr
    return folder
