"""Systems of FMUs: two masses of examples/two-masses, each an FMU of its own, against the closed form; these and the
ABS stop of examples/abs-stop in two other masters."""

import shutil
import zipfile

import numpy as np
import pytest

from conftest import ROOT, latsch, read_results

STEP, STOP = 1e-3, 2.0
WATCHED = ["left.position", "left.velocity", "left.reaction", "right.position", "right.velocity"]


BRAKING = ["corner.vehicle_speed", "corner.wheel_speed", "corner.slip", "corner.force_x", "corner.force_z",
           "corner.friction_energy", "brake.pressure", "brake.brake_torque", "abs.inlet_valve_1", "abs.outlet_valve_1",
           "abs.reference_speed"]


@pytest.fixture(scope="module")
def abs_stop(tmp_path_factory, exported):
    """Controller, brake and corner as `latsch export` makes them, and one description that wires them."""
    folder = tmp_path_factory.mktemp("abs")
    shutil.copy(ROOT / "examples" / "abs-stop" / "SystemStructure.ssd", folder)
    for model in ["abs-controller", "brake-hydraulics", "ring-brush-corner"]:
        shutil.copy(exported(model), folder)
    return folder


def run(system, *arguments, file="system.toml"):
    done = latsch("cosimulate", system / file, "--output", system / "out.csv", *arguments)
    assert done.returncode == 0, done.stderr
    return read_results(system / "out.csv"), done


def exact(time):
    """The states of both masses as one linear system, by its eigenvectors."""
    a = np.array([
        [0, 1, 0, 0],
        [-(300 + 80) / 2, -4 / 2, 80 / 2, 0],
        [0, 0, 0, 1],
        [80 / 1, 0, -(100 + 80) / 1, -2 / 1],
    ])
    values, vectors = np.linalg.eig(a)
    start = np.linalg.solve(vectors, np.array([0.1, 0, 0, 0], dtype=complex))
    return (vectors @ (start[:, None] * np.exp(np.outer(values, time)))).real


def error(results):
    states = exact(np.array(results["time"]))
    found = [results[n] for n in ["left.position", "left.velocity", "right.position", "right.velocity"]]
    return np.abs(np.array(found)[[0, 2]] - states[[0, 2]]).max()


def test_two_fmus_oscillate_like_one_system(system):
    def errors(*arguments):
        return [error(run(system, "--step", step, *arguments)[0]) for step in [2e-3, 1e-3, 5e-4]]

    for arguments in [], ["--order", "left,right"]:
        found = errors(*arguments)
        orders = np.log2(np.array(found[:-1]) / found[1:])
        assert np.abs(orders - 1).max() < 0.1 and found[-1] < 1e-3, (arguments, found)
    # what is left is the models' own step of 0.1 ms, at whose ends they look at their inputs
    assert max(errors("--iterate", 20)) < 1e-4


def test_the_description_says_the_same_as_the_short_form(system):
    expected, _ = run(system)
    assert len(expected["time"]) == 2001
    results, done = run(system, file="SystemStructure.ssd")
    assert results == expected
    assert done.stderr.count("warning") == 1 and "communication step" in done.stderr
    with zipfile.ZipFile(system / "two-masses.ssp", "w", zipfile.ZIP_DEFLATED) as archive:
        text = (system / "SystemStructure.ssd").read_text()
        archive.writestr("SystemStructure.ssd", text.replace('source="', 'source="resources/'))
        archive.write(system / "coupled-oscillator.fmu", "resources/coupled-oscillator.fmu")
    assert run(system, file="two-masses.ssp")[0] == expected


def test_the_example_of_the_documentation_is_that_system(system):
    page = (ROOT / "docs" / "cosimulate.md").read_text()
    (system / "page.toml").write_text(page.split("```toml\n")[1].split("```")[0])
    assert run(system, file="page.toml")[0] == run(system)[0]


def libcosim(system, names):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    # the step of the annotation
    execution = CosimExecution.from_ssp_file(str(system / "SystemStructure.ssd"))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    places = []
    for name in names:
        component, variable = name.split(".")
        index = execution.slave_index_from_instance_name(component)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        places.append((index, references[variable]))
    rows = []
    for k in range(round(STOP / STEP)):
        assert execution.step()
        rows.append([observer.last_real_values(index, [reference])[0] for index, reference in places])
    return rows


def ecos(system, names):
    from ecospy.EcosSimulation import EcosSimulation

    with EcosSimulation(STEP, ssp_path=str(system)) as simulation:
        assert simulation.init(0, "start")
        rows = []
        for _ in range(round(STOP / STEP)):
            simulation.step()
            rows.append([simulation.get_real(name.replace(".", "::")) for name in names])
        return rows


@pytest.mark.parametrize("master", [libcosim, ecos])
@pytest.mark.parametrize("folder, watched", [("system", WATCHED), ("abs_stop", BRAKING)])
def test_other_masters_agree_bit_for_bit(request, folder, watched, master):
    """Both are what latsch does by default: side by side, held inputs, exchanged during initialization."""
    folder = request.getfixturevalue(folder)
    results, _ = run(folder, file="SystemStructure.ssd")
    rows = np.array(master(folder, watched))
    expected = np.array([results[name][1:] for name in watched]).T
    assert rows.shape == expected.shape == (round(STOP / STEP), len(watched))
    assert np.array_equal(rows, expected), np.abs(rows - expected).max(axis=0)
    # and nothing that is watched stands still
    assert np.ptp(expected, axis=0).min() > 0.05


def test_the_abs_of_the_description_works(abs_stop):
    """Between locking, which is what happens when it may not intervene, and not braking."""
    stop, done = run(abs_stop, file="SystemStructure.ssd")
    assert done.stderr == ""
    locked, _ = run(abs_stop, "--set", "abs.activation_pressure=200 bar", file="SystemStructure.ssd")
    stop, locked = [{name: np.array(values) for name, values in r.items()} for r in (stop, locked)]
    fast = stop["corner.vehicle_speed"] > 5
    assert stop["corner.slip"][fast].min() > -0.6 and stop["corner.slip"][fast][300:].mean() > -0.25
    assert (locked["corner.slip"] < -0.99).mean() > 0.8
    # it keeps deciding: the valves move all the time, pressure is dumped and built again
    inlet, dumps = stop["abs.inlet_valve_1"], stop["abs.outlet_valve_1"] > 0
    assert np.count_nonzero(np.diff(inlet)) > 15 and len(np.unique(inlet)) > 2
    cycles = stop["time"][1:][np.diff(dumps.astype(int)) == 1]
    assert len(cycles) >= 5 and np.diff(cycles).max() < 0.6, cycles
    # the driver's 90 bar, more than the road takes, stay in the line only without it
    assert np.ptp(stop["brake.pressure"][fast]) > 30e5
    assert np.ptp(locked["brake.pressure"]) == 0 and not locked["abs.outlet_valve_1"].any()
    # it brakes nearly as hard as the tire can (force over load is 1.4 at most), and better than the locked wheel
    lost = [25 - r["corner.vehicle_speed"][-1] for r in (stop, locked)]
    assert 2 * 9.81 * 0.8 < lost[0] < 2 * 9.81 * 1.4 and lost[0] > 1.03 * lost[1], lost


def test_a_car_stops_with_four_channels(tmp_path):
    """Shipped models, wired: friction under 1.1 g, wheels that lock nowhere above the controller's last speed, one pressure behind, left as
    right, and the energy of the motion and of the wheels' spin in brakes, tires, dampers and air."""
    for file in ("system.toml", "driver.csv"):
        shutil.copy(ROOT / "examples" / "car-abs-stop" / file, tmp_path)
    results, _ = run(tmp_path)
    channel = {name: np.array(values) for name, values in results.items()}
    time, speed = channel["time"], channel["car.vehicle_speed"]
    braking = (time > 0.5) & (speed > 3.0)
    deceleration = -np.polyfit(time[braking], speed[braking], 1)[0]
    assert 0.8 * 9.81 < deceleration < 1.1 * 9.81
    assert np.max(channel["car.rear_left.slip"][braking]) <= 0.01
    locked = sum(np.mean(channel[f"car.front_{side}.slip"][braking] < -0.9) for side in ("left", "right"))
    assert locked < 0.02 and np.ptp(channel["brake_fl.pressure"][braking]) > 20e5
    for left, right in [("brake_rl.pressure", "brake_rr.pressure"), ("car.front_left.tie_rod_force", "car.front_right.tie_rod_force")]:
        np.testing.assert_allclose(channel[left], channel[right], atol=1e-6 * np.abs(channel[left]).max())
    lost = sum(channel[f"car.{part}_energy"][-1] for part in ("brake", "tire", "damper", "air"))
    spin = channel["car.front_left.wheel_speed"][0]
    assert lost == pytest.approx(0.5 * 1650 * speed[0] ** 2 + 4 * 0.5 * 0.9 * spin**2, rel=2e-3)


def test_the_loop_opened_along_its_own_recording(system):
    closed, _ = run(system)
    shutil.copy(system / "out.csv", system / "closed.csv")
    open_loop, _ = run(system, "--open", "right", "--replay", system / "closed.csv", "--report", system / "o.html")
    assert open_loop == {name: closed[name] for name in open_loop}
    assert [n for n in closed if n not in open_loop] == ["generated energy left.reaction right.position"]
    page = (system / "o.html").read_text()
    assert "right.force" in page and "Opened" in page and "Simulation and measurement" in page


def test_what_is_wrong_is_said(system, tmp_path):
    text = (system / "SystemStructure.ssd").read_text()
    for old, new, words in [
        ('version="1.0"\n', 'version="2.0"\n', [":3:", "2.0"]),
        ('endConnector="force"', 'endConnector="farce"', ["right", "farce", "connector"]),
        ('kind="input"><ssc:Real unit="N"', 'kind="output"><ssc:Real unit="N"', ["right.force", "Input", "Output"]),
        ('<ssc:Real unit="N"/>', '<ssc:Integer/>', ["left.reaction", "Integer", "Real"]),
        ('unit="N"', 'unit="kN"', ["left.reaction", "kN"]),
        ('name="mass"', 'name="weight"', ["weight"]),
        ('value="300"', 'value="stiff"', ["stiff", "number"]),
        ('value="300"', 'value="-300"', ["stiffness", "-300"]),
        ('<ssd:Elements>', '<ssd:Elements><ssd:System name="inner"/>', ["nested"]),
        ('<ssd:Elements>', '<ssd:SignalDictionaries/><ssd:Elements>', ["SignalDictionaries", "not supported"]),
        ('endConnector="force"/>', 'endConnector="force"><ssc:BooleanMappingTransformation/></ssd:Connection>',
         ["BooleanMappingTransformation"]),
        ('</ssd:System>', '</ssd:Sytem>', ["SystemStructure.ssd:"]),
        ('source="coupled-oscillator.fmu"', 'source="http://x.org/o.fmu"', ["http"]),
        ('source="coupled-oscillator.fmu"', 'source="none.fmu"', ["none.fmu"]),
        ('baseStepSize="1e-3"', 'baseStepSize="fast"', ["baseStepSize", "fast"]),
    ]:
        assert old in text, old
        (tmp_path / "SystemStructure.ssd").write_text(text.replace(old, new))
        shutil.copy(system / "coupled-oscillator.fmu", tmp_path)
        done = latsch("cosimulate", tmp_path / "SystemStructure.ssd", "--output", tmp_path / "out.csv")
        assert done.returncode == 2, (new, done.stderr)
        for word in words:
            assert word in done.stderr, (new, done.stderr)
        assert not (tmp_path / "out.csv").exists()


def test_nothing_that_is_read_is_overwritten(system):
    before = (system / "system.toml").read_bytes()
    for output in ["system.toml", "coupled-oscillator.fmu"]:
        done = latsch("cosimulate", system / "system.toml", "--output", system / output)
        assert done.returncode == 2 and "overwrite" in done.stderr
    assert (system / "system.toml").read_bytes() == before


def test_an_fmu_that_cannot_do_everything(system, tmp_path):
    """One that neither saves its state nor varies its step: said once, and done without."""
    shutil.copy(system / "system.toml", tmp_path)
    with zipfile.ZipFile(system / "coupled-oscillator.fmu") as good, \
            zipfile.ZipFile(tmp_path / "coupled-oscillator.fmu", "w", zipfile.ZIP_DEFLATED) as poor:
        for name in good.namelist():
            content = good.read(name)
            if name == "modelDescription.xml":
                for flag in [b"canGetAndSetFMUstate", b"canSerializeFMUstate",
                             b"canHandleVariableCommunicationStepSize"]:
                    assert flag + b'="true"' in content
                    content = content.replace(flag + b'="true"', flag + b'="false"')
            poor.writestr(name, content)
    results, done = run(tmp_path, "--iterate", 5, "--halvings", 2)
    assert results == run(system)[0]
    warnings = [line for line in done.stderr.splitlines() if "energy" not in line and "made" not in line]
    assert len(warnings) == 2 and "left, right cannot save and restore" in done.stderr
    assert "left cannot vary its step" in done.stderr
    done = latsch("cosimulate", tmp_path / "system.toml", "--output", tmp_path / "o.csv", "--step", "1.5e-3")
    assert done.returncode == 2 and "no whole number of steps" in done.stderr
    done = latsch("cosimulate", tmp_path / "system.toml", "--output", tmp_path / "o.csv", "--step", "2.5e-3")
    assert "whole multiple of the step 0.001 s" in done.stderr


# what the system below reads
STEER = "time [s],angle [deg]\n0,0\n0.1,3\n0.3,3\n"
TIRE = """
step = 1e-3
stop = 0.2
[component.rig]
model = "ring-brush-flat-track"
set = { path_speed = "60 km/h", deflection = 0.02 }
[component.left]
fmu = "coupled-oscillator.fmu"
[connect]
"rig.force_y" = { to = "left.force", factor = 0.001 }
[[inputs]]
file = "steer.csv"
connect = { angle = "rig.slip_angle" }
"""


def test_a_shipped_model_beside_an_fmu(system):
    (system / "steer.csv").write_text(STEER)
    (system / "tire.toml").write_text(TIRE)
    results, done = run(system, file="tire.toml")
    assert done.stderr == ""
    assert results["left.force"][-1] == 0.001 * results["rig.force_y"][-2]
    assert results["rig.slip_angle"][-1] == pytest.approx(np.radians(3))
    assert results["rig.force_y"][-1] < -500 and results["left.position"][-1] < -1e-3
    assert "rig.belt_yaw" not in results and "rig.belt_yaw" in run(system, "--all", file="tire.toml")[0]
    assert run(system, "--set", "left.mass=2 kg", file="tire.toml")[0]["left.position"] != results["left.position"]
    # the same course as another program writes it
    (system / "foreign.csv").write_text("Zeit;Winkel\n" + STEER.split("\n", 1)[1].replace(",", ";"))
    (system / "map.toml").write_text('[channels]\nZeit = { variable = "time", unit = "s" }\nWinkel = { variable = "angle", unit = "deg" }\n')
    foreign = ["--inputs", system / "foreign.csv", "--map", system / "map.toml"]
    assert run(system, *foreign, file="tire.toml")[0] == results
    for arguments, words in [
        (["--map", system / "map.toml"], ["--map", "--inputs, --replay or --repeat"]),
        (["--inputs", system / "foreign.csv"], ["foreign.csv", "Zeit"]),
        (["--step", "1.5e-4"], ["rig.step_size", "multiple"]),
        (["--set", "left.force=1"], ["two sources"]),
        (["--set", "left.mass"], ["COMPONENT.VARIABLE=VALUE"]),
        (["--stop", "1"], ["0 s to 0.3 s"]),
        (["--order", "rig"], ["order", "left"]),
        (["--open", "left"], ["--replay"]),
        (["--open", "left", "--replay", system / "steer.csv"], ["left.force", "angle"]),
        (["--record-every", "0.5"], ["record-every"]),
    ]:
        done = latsch("cosimulate", system / "tire.toml", "--output", system / "out.csv", *arguments)
        assert done.returncode == 2, (arguments, done.stderr)
        for word in words:
            assert word in done.stderr, (arguments, done.stderr)


def test_a_component_that_stops_is_the_answer_no(system):
    (system / "steer.csv").write_text(STEER)
    text = TIRE.replace('"left.force"', '"rig.deflection"').replace('"rig.force_y"', '"left.position"')
    text = text.replace("deflection = 0.02", "").replace("60 km/h\",", '60 km/h"')
    text = text.replace("factor = 0.001", "factor = 1, offset = 0.02")
    (system / "stops.toml").write_text(text + '[component.left.set]\nforce = 10\n')
    done = latsch("cosimulate", system / "stops.toml", "--output", system / "stops.csv")
    assert done.returncode == 1 and "rig" in done.stderr and "deflection" in done.stderr, done.stderr
    assert len((system / "stops.csv").read_text().splitlines()) > 2
