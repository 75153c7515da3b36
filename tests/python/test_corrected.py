"""Corrected models from outside: a shipped model with effects, and a foreign FMU carried inside ours, in FMPy."""

import math
import subprocess
import sys
import zipfile

import fmpy
import fmpy.validation
import numpy as np
import pytest

from conftest import ROOT, Slave, latsch, read_results

WHEEL = """
[parameters]
hub_mass = { value = 31.5, low = 30.0, high = 33.0 }

[[effect]]
id = "sensor-delay"
target = "force_z"
parameters.delay = "7.5 ms"

[[effect]]
id = "coulomb-friction"
target = "axle_force_z"
drivers = ["velocity_z"]
parameters = { force = 40.0, velocity = 0.1 }
"""
INTEGRATOR = """
[parameters]
k = 3.0

[[effect]]
id = "sensor-delay"
target = "y"
parameters.delay = 0.025

[[effect]]
id = "coulomb-friction"
target = "u"
drivers = ["y"]
parameters = { force = 0.3, velocity = 0.1 }
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Integrator" guid="{integrator}">
  <CoSimulation modelIdentifier="integrator" canHandleVariableCommunicationStepSize="true"
      canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>
  <LogCategories><Category name="logStatus"/></LogCategories>
  <DefaultExperiment stopTime="1" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed"><Real start="2"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/></Outputs>
    <InitialUnknowns><Unknown index="2"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def correct(folder, model, text):
    """The corrected FMU of a model or FMU."""
    (folder / "corrected.toml").write_text(text)
    path = folder / "corrected.fmu"
    done = latsch("export", model, "--effects", folder / "corrected.toml", "--output", path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    return correct(tmp_path_factory.mktemp("wheel"), "ring-brush-wheel", WHEEL)


@pytest.fixture(scope="session")
def integrator(tmp_path_factory):
    """A foreign FMU, made by a C compiler."""
    folder = tmp_path_factory.mktemp("integrator")
    source = ROOT / "tests" / "data" / "integrator.c"
    binary = folder / "integrator.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-DPOLITE", "-o", binary, source, "-lm"], check=True)
    path = folder / "integrator.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(binary, "binaries/linux64/integrator.so")
    return path


@pytest.fixture(scope="session")
def carrier(tmp_path_factory, integrator):
    return correct(tmp_path_factory.mktemp("carrier"), integrator, INTEGRATOR)


@pytest.fixture(scope="session")
def own_carrier(tmp_path_factory, exported):
    """Our own FMU inside ours: the same functions twice in one process."""
    return correct(tmp_path_factory.mktemp("own"), exported("ring-brush-wheel"), WHEEL)


CASES = {
    "wheel": dict(axle_force_z=lambda t: -3500 + 500 * math.sin(37 * t), steer=lambda t: 0.02 * math.sin(9 * t)),
    "own_carrier": dict(axle_force_z=lambda t: -3500 + 500 * math.sin(37 * t), steer=lambda t: 0.02 * math.sin(9 * t)),
    "carrier": dict(u=lambda t: 0.4 + 0.5 * math.sin(37 * t)),
}
UNITS = dict(axle_force_z="N", steer="rad", u="m/s")


@pytest.mark.parametrize("case", CASES)
def test_fmpy_finds_nothing_to_complain_about(case, request):
    assert fmpy.validation.validate_fmu(str(request.getfixturevalue(case))) == []


@pytest.mark.parametrize("case", CASES)
def test_fmpy_gets_what_simulate_gets(case, request, tmp_path):
    path, inputs = request.getfixturevalue(case), CASES[case]
    times = [0.01 * k for k in range(31)]
    header = ["time [s]"] + [f"{name} [{UNITS[name]}]" for name in inputs]
    rows = [[t] + [f(t) for f in inputs.values()] for t in times]
    lines = [",".join(map(str, row)) for row in [header, *rows]]
    (tmp_path / "inputs.csv").write_text("\n".join(lines) + "\n")
    done = latsch("simulate", path, "--inputs", tmp_path / "inputs.csv", "--step", "0.01", "--output", tmp_path / "ours.csv")
    assert done.returncode == 0, done.stderr
    ours = read_results(tmp_path / "ours.csv")
    names = [n for n in ours if n != "time" and n not in inputs]

    # FMPy by hand: its own inputs are steps, not straight lines
    start = {name: f(0.0) for name, f in inputs.items()}
    if "steer" in inputs:
        # recorded inputs are motions, which pass no actuators; simulate says so
        assert "command_actuators is false" in done.stderr
        start["command_actuators"] = False
    slave = Slave(path, start)
    for k, row in enumerate(rows[:-1]):
        assert slave.get(*names) == [ours[n][k] for n in names], k
        slave.set(**dict(zip(inputs, row[1:])))
        length = times[k + 1] - times[k]
        slave.rates(**{n: (b - a) / length for n, a, b in zip(inputs, row[1:], rows[k + 1][1:])})
        slave.raw.doStep(times[k], length)
    assert slave.get(*names) == [ours[n][-1] for n in names]
    slave.close()


@pytest.mark.parametrize("case", CASES)
def test_fmpy_simulates_it_as_a_user_writes_it(case, request):
    path, inputs = request.getfixturevalue(case), CASES[case]
    start = {name: f(0.1) for name, f in inputs.items()}
    result = fmpy.simulate_fmu(str(path), stop_time=0.3, output_interval=1e-2, start_values=start)
    assert len(result) == 31 and all(np.isfinite(result[n]).all() for n in result.dtype.names)
    if case == "carrier":
        # u - 0.3 tanh(10 y) drives y at 3 times that, and y is told 25 ms late
        y, u, h = [0.0], start["u"], 0.01
        for _ in range(30):
            y.append(y[-1] + 3 * u * h)
        assert result["y"][1] == pytest.approx(0.0, abs=0.02) and 0.2 * y[-1] < result["y"][-1] < 0.95 * y[-1]


def test_two_instances_of_the_carrier_at_once(carrier):
    alone = Slave(carrier, dict(u=0.5))
    alone.steps(20, length=0.01)
    expected = alone.outputs()
    alone.close()
    a, b = Slave(carrier, dict(u=0.5)), Slave(carrier, dict(u=-2.0))
    for k in range(20):
        b.raw.doStep(k * 0.01, 0.01)
        a.raw.doStep(k * 0.01, 0.01)
    assert a.outputs() == expected != b.outputs()
    b.close()
    a.raw.doStep(0.2, 0.01)
    a.close()


PROGRAM = """
import ctypes, os, sys
sys.path.insert(0, {tests!r})
from conftest import Slave
import conftest, fmpy, pathlib
# whoever loads FMUs for all to see: the names of this one come before those of any later library
slave_folder = fmpy.extract({path!r})
binary = next(pathlib.Path(slave_folder).glob("binaries/linux64/*.so"))
everybody = ctypes.CDLL(str(binary), mode=ctypes.RTLD_GLOBAL)
fmpy.extract = lambda path: slave_folder
slave = Slave({path!r}, dict(u=0.5))
slave.steps(20, length=0.01)
state = slave.raw.getFMUState()
data = slave.raw.serializeFMUstate(state)
slave.steps(10, start=0.2, length=0.01)
there = slave.outputs()
slave.raw.setFMUState(slave.raw.deSerializeFMUstate(data))
slave.steps(10, start=0.2, length=0.01)
assert slave.outputs() == there, (slave.outputs(), there)
slave.close()
print("done", there[0])
"""


def test_the_carried_fmu_calls_its_own_functions(carrier):
    """fmi2DeSerializeFMUstate of the integrator calls its fmi2GetFMUstate; without RTLD_DEEPBIND it would get ours."""
    program = PROGRAM.format(tests=str(ROOT / "tests" / "python"), path=str(carrier))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("done"), (done.returncode, done.stderr)


def test_it_is_a_component_like_any_other(wheel, carrier, tmp_path):
    (tmp_path / "system.toml").write_text(f"""
step = 0.001
stop = 0.05

[component.wheel]
fmu = "{wheel}"

[component.sum]
fmu = "{carrier}"

[connect]
"wheel.velocity_x" = "sum.u"
""")
    done = latsch("cosimulate", tmp_path / "system.toml", "--output", tmp_path / "out.csv")
    assert done.returncode == 0, done.stderr
    columns = read_results(tmp_path / "out.csv")
    assert columns["sum.y"][-1] != 0.0


def test_the_command_says_what_is_wrong(integrator, tmp_path):
    (tmp_path / "effects.toml").write_text(INTEGRATOR)
    (tmp_path / "tire.toml").write_text("[parameters]\nhub_mass = 30.0")
    effects = tmp_path / "effects.toml"
    for arguments, words in [
        ([integrator], ["--effects"]),
        ([integrator, "--effects", effects, "--parameters", tmp_path / "tire.toml"], ["[parameters]"]),
        (["ring-brush-wheel", "--effects", effects], ["effects.toml:3", '"k"']),
        (["ring-brush-wheel", "--parameters", effects], ["--effects"]),
        ([integrator, "--effects", tmp_path / "none.toml"], ["none.toml"]),
        ([integrator, "--effects", effects, "--output", integrator], ["overwrite"]),
        ([tmp_path / "none.fmu", "--effects", effects], ["none.fmu"]),
    ]:
        done = latsch("export", *arguments, cwd=tmp_path)
        assert done.returncode == 2 and all(word in done.stderr for word in words), done.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["effects.toml", "tire.toml"]
