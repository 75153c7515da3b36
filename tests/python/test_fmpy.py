"""The FMU from outside: FMPy validates it, drives it and gets what the native model gives."""

import math
import zipfile

import fmpy
import fmpy.validation
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from conftest import INPUTS, MODEL, MODELS, Slave, latsch, read_results

START = dict(steer=0.0, deflection=0.02, path_speed=15.0, camber=0.0, slip=0.0, slip_angle=0.0)


def programme(count, step):
    """Inputs at communication points: all six move."""
    rows = []
    for k in range(count + 1):
        t = k * step
        rows.append(
            dict(
                steer=0.02 * math.sin(3 * t),
                deflection=0.02 + 0.004 * math.sin(11 * t),
                path_speed=15.0 + 2.0 * t,
                camber=0.03 * math.sin(5 * t),
                slip=0.04 * math.sin(13 * t),
                slip_angle=0.05 * math.sin(7 * t),
            )
        )
    return rows


def test_fmpy_finds_nothing_to_complain_about(shipped):
    assert fmpy.validation.validate_fmu(str(shipped)) == []


def test_description_has_what_masters_ask_for(fmu):
    description = fmpy.read_model_description(str(fmu), validate=True)
    variables = {v.name: v for v in description.modelVariables}
    inputs = [v.name for v in description.modelVariables if v.causality == "input"]
    assert inputs == [*INPUTS, "friction_factor", "load"]
    assert variables["slip_angle"].unit == "rad" and variables["moment_z"].unit == "N.m"
    assert variables["belt_mass"].variability == "fixed" and float(variables["belt_mass"].start) == 8.8
    assert description.coSimulation.providesDirectionalDerivative


def test_descriptions_are_valid_and_complete(shipped):
    description = fmpy.read_model_description(str(shipped), validate=True)
    assert description.coSimulation.canInterpolateInputs
    assert description.coSimulation.canSerializeFMUstate
    outputs = [v for v in description.modelVariables if v.causality == "output"]
    assert [u.variable for u in description.outputs] == outputs
    assert [u.variable for u in description.initialUnknowns] == outputs


def test_archive_is_plain(shipped):
    with zipfile.ZipFile(shipped) as archive:
        assert archive.testzip() is None
        for entry in archive.infolist():
            # binaries are stored, which loads faster
            is_binary = entry.filename.startswith("binaries/")
            assert entry.compress_type == (zipfile.ZIP_STORED if is_binary else zipfile.ZIP_DEFLATED)
            assert entry.extract_version <= 20
            assert "\\" not in entry.filename and not entry.filename.startswith("/")


def test_documentation_and_licenses_are_in_the_archive(shipped):
    description = fmpy.read_model_description(str(shipped))
    with zipfile.ZipFile(shipped) as archive:
        page = archive.read("documentation/index.html").decode()
        licenses = {name: archive.read(f"documentation/licenses/{name}").decode()
                    for name in ["LICENSE-APACHE", "LICENSE-MIT", "THIRD-PARTY.md"]}
    for variable in description.modelVariables:
        assert f"<code>{variable.name}</code></td>" in page
    assert description.guid in page and "<math" in page
    for outside in ["http:", "https:", "url(", "src=", "<script", "<link"]:
        assert outside not in page
    assert "Apache License" in licenses["LICENSE-APACHE"] and "nalgebra" in licenses["THIRD-PARTY.md"]


def test_same_bits_as_the_native_model(tmp_path, slaves):
    count, step = 400, 1e-3
    rows = programme(count, step)
    times = [0.0 + k * step for k in range(count)] + [count * step]
    with open(tmp_path / "inputs.csv", "w") as file:
        units = dict(path_speed="m/s", deflection="m", slip="1")
        file.write(",".join(["time [s]"] + [f"{n} [{units.get(n, 'rad')}]" for n in INPUTS]) + "\n")
        for time, row in zip(times, rows):
            file.write(",".join(repr(x) for x in [time, *row.values()]) + "\n")
    done = latsch("simulate", MODEL, "--inputs", tmp_path / "inputs.csv", "--all",
                  "--output", tmp_path / "native.csv")
    assert done.returncode == 0, done.stderr
    native = read_results(tmp_path / "native.csv")

    # simulate takes recorded inputs for motions
    slave = slaves(dict(rows[0], command_actuators=False))
    names = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "sliding_distance",
             "friction_power", "belt_yaw", "pressure_max"]
    for k in range(count):
        assert slave.get(*names) == [native[n][k] for n in names], f"at {times[k]} s"
        slave.set(**rows[k])
        length = times[k + 1] - times[k]
        slave.rates(**{n: (rows[k + 1][n] - rows[k][n]) / length for n in INPUTS})
        slave.raw.doStep(times[k], length)
    assert slave.get(*names) == [native[n][count] for n in names]
    assert max(abs(x) for x in native["force_y"]) > 1000


def test_our_importer_sees_what_fmpy_sees(tmp_path, shipped):
    start, _ = MODELS[shipped.stem]
    options = [word for name, value in start.items() for word in ("--set", f"{name}={value}")]
    for source, path in [(shipped, "fmu.csv"), (shipped.stem, "native.csv")]:
        done = latsch("simulate", source, *options, "--stop", "0.2", "--output", tmp_path / path)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "fmu.csv").read_text() == (tmp_path / "native.csv").read_text()
    ours = read_results(tmp_path / "native.csv")
    names = [name for name in ours if name != "time"]
    theirs = fmpy.simulate_fmu(str(shipped), stop_time=0.2, output_interval=1e-3, start_values=start, output=names)
    for name in names:
        assert len(ours[name]) == 201 and np.array_equal(ours[name], theirs[name]), name
    assert sum(ours[name][-1] != 0.0 for name in names) > 2


def test_simulate_fmu_with_inputs_as_a_user_writes_it(fmu):
    inputs = np.zeros(201, dtype=[("time", float), ("slip_angle", float)])
    inputs["time"] = np.linspace(0, 2, 201)
    inputs["slip_angle"] = np.radians(5) * np.sin(np.pi * inputs["time"])
    result = fmpy.simulate_fmu(str(fmu), stop_time=2, output_interval=1e-3, input=inputs,
                               start_values={"deflection": 0.025, "belt_mass": 9.5},
                               output=["force_y", "force_z", "belt_deflection"])
    assert np.isfinite(result["force_y"]).all()
    # positive slip angle, negative lateral force (ISO 8855)
    assert result["force_y"][500] < -3000 and result["force_y"][1500] > 3000
    # springs in series: the belt's weight hangs on the side wall
    f = result["belt_deflection"][0]
    assert result["force_z"][0] == pytest.approx(1.54e5 * f + 2.47e6 * f * f - 9.5 * 9.81, rel=1e-6)


def test_partition_of_time_does_not_matter_on_the_grid(slaves, shipped):
    start, change = MODELS[shipped.stem]
    coarse, fine, odd = (slaves(start, path=shipped) for _ in range(3))
    for slave in (coarse, fine, odd):
        slave.set(**change)
    coarse.raw.doStep(0.0, 0.1)
    fine.steps(100)
    # points between the grid points, and the drifting clock of a master that adds up
    time = 0.0
    while time < 0.1 - 1e-9:
        length = min(0.00137, 0.1 - time)
        odd.raw.doStep(time, length)
        time += length
    assert coarse.outputs() == fine.outputs() == odd.outputs() != slaves(start, path=shipped).outputs()


def test_between_grid_points_the_result_is_near_its_neighbours(slaves):
    start = dict(START, slip=0.02)
    before, between, after = slaves(start), slaves(start), slaves(start)
    for slave, length in [(before, 0.05), (between, 0.05005), (after, 0.0501)]:
        slave.set(slip=0.06)
        slave.raw.doStep(0.0, length)
    low, middle, high = (s.get("force_x")[0] for s in (before, between, after))
    assert low < middle < high


def test_derivatives_of_outputs_are_those_of_the_last_internal_step(slaves):
    slave = slaves(dict(START, step_size=1e-4))
    names = ["force_x", "force_z", "wheel_angle"]
    slave.set(slip=0.05, deflection=0.025)
    slave.steps(5)
    for time, length in [(0.005, 1e-4), (0.0051, 1e-4), (0.0052, 0.5e-4)]:
        before = slave.get(*names)
        slave.raw.doStep(time, length)
        now, rates = slave.get(*names), slave.derivatives(*names)
        if length == 1e-4:
            for y0, y1, rate in zip(before, now, rates):
                assert rate == pytest.approx((y1 - y0) / length, rel=1e-9)
    # the wheel's angle has a rate that everybody knows: (slip + 1) v / R
    spin = (1 + slave.get("actual_slip")[0]) * 15.0 / 0.328
    assert slave.derivatives("wheel_angle")[0] == pytest.approx(spin, rel=1e-3)
    # before the first step a stationary state
    fresh = slaves(START)
    assert fresh.derivatives("force_z")[0] == pytest.approx(0.0, abs=1e4)
    assert fresh.derivatives("wheel_angle")[0] == pytest.approx(15.0 / 0.328, rel=1e-12)


def test_save_restore_and_serialise(slaves, shipped):
    start, change = MODELS[shipped.stem]
    slave = slaves(start, path=shipped)
    slave.steps(50)
    state = slave.raw.getFMUState()
    here = slave.outputs()
    slave.set(**change)
    slave.steps(30, 0.05)
    there = slave.outputs()
    assert there != here

    slave.raw.setFMUState(state)
    assert slave.outputs() == here
    slave.set(**change)
    slave.steps(30, 0.05)
    assert slave.outputs() == there

    # bytes continue in another instance, which has seen nothing
    data = slave.raw.serializeFMUState(state)
    other = slaves(path=shipped)
    copy = other.raw.deserializeFMUState(data)
    other.raw.setFMUState(copy)
    assert other.outputs() == here
    other.set(**change)
    other.steps(30, 0.05)
    assert other.outputs() == there
    slave.raw.freeFMUState(state)
    other.raw.freeFMUState(copy)


def test_damaged_state_is_refused(slaves):
    slave = slaves(START)
    state = slave.raw.getFMUState()
    data = bytearray(slave.raw.serializeFMUState(state))
    data[len(data) // 2] ^= 1
    with pytest.raises(FMICallException):
        slave.raw.deserializeFMUState(bytes(data))
    assert "damaged" in slave.messages[-1][2]


def test_reset_is_as_good_as_new(slaves):
    used, fresh = slaves(dict(START, slip=0.08)), slaves(dict(START, camber=0.05))
    used.steps(100)
    used.raw.reset()
    used.begin(dict(START, camber=0.05))
    assert used.outputs() == fresh.outputs()
    used.steps(20)
    fresh.steps(20)
    assert used.outputs() == fresh.outputs()


def test_two_instances_do_not_feel_each_other(slaves):
    alone, one, two = slaves(dict(START, slip=0.03)), slaves(dict(START, slip=0.03)), slaves(dict(START, slip=-0.2))
    alone.steps(40)
    for k in range(40):
        one.raw.doStep(k * 1e-3, 1e-3)
        two.raw.doStep(k * 1e-3, 1e-3)
    assert one.outputs() == alone.outputs() != two.outputs()


def test_parameters_reach_the_model(tmp_path, slaves):
    tire = tmp_path / "tire.toml"
    tire.write_text(
        'model = "ring-brush-flat-track"\n[parameters]\ntire_name = "soft"\nvertical_stiffness = 1e5\n'
        "stripes = 4\neven_stripes = true\n[inputs]\ndeflection = 0.03\n"
    )
    path = tmp_path / "soft.fmu"
    done = latsch("export", MODEL, "--parameters", tire, "--output", path)
    assert done.returncode == 0, done.stderr
    description = fmpy.read_model_description(str(path))
    starts = {v.name: v.start for v in description.modelVariables}
    assert float(starts["vertical_stiffness"]) == 1e5 and starts["stripes"] == "4"
    assert starts["even_stripes"] == "true" and starts["tire_name"] == "soft"
    assert description.guid != slaves().description.guid

    slave = Slave(path)
    slave.begin({})
    f = slave.get("belt_deflection")[0]
    assert slave.get("force_z")[0] == pytest.approx(1e5 * f + 2.47e6 * f * f - 8.8 * 9.81, rel=1e-6)
    assert slave.raw.getString([slave.references["tire_name"]]) == [b"soft"]
    assert slave.raw.getInteger([slave.references["stripes"]]) == [4]
    assert slave.raw.getBoolean([slave.references["even_stripes"]]) == [True]
    slave.close()


def test_initialization_mode_answers_at_once(slaves):
    slave = slaves()
    slave.raw.setupExperiment()
    slave.raw.enterInitializationMode()
    for deflection in (0.01, 0.02, -0.01):
        slave.set(deflection=deflection)
        force = slave.get("force_z")[0]
        assert (force > 0) == (deflection > 0)
    # hanging in the air: the belt's weight pulls at the rim
    assert slave.get("force_z")[0] == pytest.approx(-8.8 * 9.81, rel=1e-12)
    slave.raw.exitInitializationMode()


@pytest.mark.parametrize("start", [0.0, -5.0, 1.7e9])
def test_clocks_of_masters(slaves, start):
    # each point computed anew, and added up; also where a second is many units in the last place
    one, two = slaves(), slaves()
    one.begin(dict(START, slip=0.02), time=start, stop=start + 0.5)
    two.begin(dict(START, slip=0.02), time=start, stop=start + 0.5)
    time = start
    for k in range(500):
        one.raw.doStep(start + k * 1e-3, 1e-3)
        two.raw.doStep(time, 1e-3)
        time += 1e-3
    assert one.get("force_x")[0] == pytest.approx(two.get("force_x")[0], rel=1e-3)


def test_friction_can_be_tuned_between_steps(slaves):
    # a wheel that slides sideways answers with sliding friction: halve it, and so is force over load
    slave = slaves(dict(START, slip_angle=math.pi / 2))
    slave.steps(100)

    def used():
        force, load = slave.get("patch_force_y", "patch_force_z")
        return force / load

    before = used()
    slave.set(friction_sliding_zero=0.55, friction_sliding_reference=0.5)
    assert slave.get("friction_sliding_zero") == [0.55]
    slave.steps(400, 0.1)
    assert used() == pytest.approx(0.5 * before, rel=0.01)
    # what does not fit together is refused at the next step
    slave.set(friction_static_zero=0.1)
    with pytest.raises(FMICallException):
        slave.raw.doStep(0.5, 1e-3)
    assert "friction_static_zero" in slave.messages[-1][2]


OUTPUTS = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"]
INSIDE = ["belt_deflection", "contact_length_left", "contact_length_center", "contact_length_right",
          "patch_force_x", "patch_force_y", "patch_force_z"]


@pytest.mark.parametrize(
    "point",
    [
        dict(slip=0.01, slip_angle=0.01, camber=0.01),
        dict(slip=-0.004, slip_angle=-0.008, path_speed=30.0, deflection=0.015),
        dict(steer=0.7, slip=0.005, slip_angle=0.004, camber=-0.02),
    ],
)
def test_directional_derivatives_of_the_stationary_state(slaves, point):
    slave = slaves()
    slave.raw.setupExperiment()
    slave.raw.enterInitializationMode()
    point = dict(START, friction_factor=1.0, **point)
    slave.set(**point)
    names = OUTPUTS + INSIDE + ["contact_power_loss"]
    steps = dict(deflection=3e-6, path_speed=0.03, camber=1e-5, slip=5e-6, slip_angle=5e-6, friction_factor=2e-4)
    for name, h in steps.items():
        exact = slave.directional(names, {name: 1.0})

        def at(offset):
            slave.set(**{name: point[name] + offset})
            values = np.array(slave.get(*names))
            slave.set(**{name: point[name]})
            return values

        difference = (at(h) - at(-h)) / (2 * h)
        for output, e, d in zip(names, exact, difference):
            # what hardly changes is lost in the rounding of the differences
            floor = 1e-2 * abs(difference).max() if output in OUTPUTS else 1e-9
            assert abs(e - d) <= 1e-6 * max(abs(d), floor), f"d {output} / d {name}: {e} against {d}"
    # the heading of a stationary state does not matter
    assert slave.directional(OUTPUTS, dict(steer=1.0)) == pytest.approx([0.0] * 6, abs=1e-6)
    # a direction is the sum of its parts
    parts = [slave.directional(names, {n: 2.0}) for n in ("slip", "camber")]
    both = slave.directional(names, dict(slip=2.0, camber=2.0))
    assert both == pytest.approx(np.sum(parts, axis=0), rel=1e-9, abs=1e-9)


def test_directional_derivatives_between_steps(slaves):
    point = dict(START, slip=0.02, slip_angle=0.03, camber=0.02, steer=0.1)
    # without actuators, which would stand between the commands and the rim
    slave = slaves(dict(point, command_actuators=False))
    rates = dict(steer=0.2, deflection=0.01, path_speed=0.5, camber=-0.1, slip=0.05, slip_angle=0.1)
    slave.rates(**rates)
    slave.steps(20)
    state = slave.raw.getFMUState()
    now = {n: point[n] + rates[n] * 0.02 for n in INPUTS}
    steps = dict(steer=1e-5, deflection=1e-6, path_speed=1e-3, camber=1e-5, slip=1e-5, slip_angle=1e-5)
    for name in INPUTS:
        exact = slave.directional(OUTPUTS + INSIDE, {name: 1.0})

        def at(offset, instant):
            slave.raw.setFMUState(state)
            slave.set(**dict(now, **{name: now[name] + offset}))
            slave.rates(**rates)
            slave.raw.doStep(0.02, instant)
            return np.array(slave.get(*OUTPUTS))

        h = steps[name]
        # differences after a step of no length: extrapolated from two very short ones
        short, shorter = ((at(h, t) - at(-h, t)) / (2 * h) for t in (4e-9, 2e-9))
        difference = 2 * shorter - short
        slave.raw.setFMUState(state)
        for output, e, d in zip(OUTPUTS, exact, difference):
            floor = 1e-2 * abs(difference).max()
            assert abs(e - d) <= 1e-6 * max(abs(d), floor), f"d {output} / d {name}: {e} against {d}"
        # the belt does not move in no time
        assert exact[len(OUTPUTS):] == [0.0] * len(INSIDE)
    slave.raw.freeFMUState(state)


def test_directional_derivatives_between_steps_behind_actuators(slaves):
    point = dict(START, slip=0.02, slip_angle=0.03)
    slave = slaves(point)
    slave.steps(20)
    # a command moves the actuator first, with a derivative or without
    for rates in ({}, dict(deflection=0.01, slip_angle=0.1)):
        slave.rates(**rates)
        for name in INPUTS:
            assert slave.directional(OUTPUTS + INSIDE, {name: 1.0}) == [0.0] * len(OUTPUTS + INSIDE)
    # the friction moves bristles first, and at once: that is not known before the next step
    assert slave.directional(OUTPUTS, dict(friction_factor=1.0)) == [0.0] * 6
    for name in ("patch_force_x", "patch_force_y", "sliding_share", "friction_power"):
        with pytest.raises(Exception):
            slave.directional([name], dict(friction_factor=1.0))


def test_directional_derivatives_anywhere(slaves):
    random = np.random.default_rng(3)
    slave = slaves()
    slave.raw.setupExperiment()
    slave.raw.enterInitializationMode()
    for _ in range(25):
        point = dict(START, slip=random.uniform(-0.05, 0.05), slip_angle=random.uniform(-0.06, 0.06),
                     camber=random.uniform(-0.05, 0.05), deflection=random.uniform(0.012, 0.03))
        slave.set(**point)
        for name, h in dict(slip=2e-6, slip_angle=2e-6, camber=5e-6, deflection=2e-6).items():
            exact = np.array(slave.directional(OUTPUTS, {name: 1.0}))

            def at(offset):
                slave.set(**{name: point[name] + offset})
                values = np.array(slave.get(*OUTPUTS))
                slave.set(**{name: point[name]})
                return values

            difference = (at(h) - at(-h)) / (2 * h)
            assert abs(exact - difference).max() <= 1e-6 * abs(exact).max()
