"""Three masters, one schedule, the same bits: FMPy, libcosim (OSP) and Ecos (NTNU)."""

import math

import fmpy
import pytest

from test_fmpy import START

STEP, COUNT = 1e-3, 500
ROLLING = dict(START, slip=0.03, slip_angle=0.02)
WATCHED = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "belt_yaw", "friction_power"]


def still(_k):
    return {}


def moving(k):
    """Inputs to set before step k: some every step, one with a jump, one once in a while."""
    t = k * STEP
    values = dict(slip=0.03 + 0.04 * math.sin(40 * t), slip_angle=0.02 if k < 200 else -0.04)
    if k % 50 == 0:
        values["deflection"] = 0.02 + 1e-5 * k
    return values


SCHEDULES = dict(still=still, moving=moving)


def run_fmpy(fmu, slaves, schedule):
    slave = slaves(ROLLING, path=fmu)
    rows = []
    for k in range(COUNT):
        if values := schedule(k):
            slave.set(**values)
        slave.raw.doStep(k * STEP, STEP)
        rows.append(slave.get(*WATCHED))
    return rows


def run_libcosim(fmu, slaves, schedule):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    # its warning that it ignores enumerations is no news
    log_output_level(CosimLogLevel.ERROR)
    references = {v.name: v.valueReference for v in fmpy.read_model_description(str(fmu)).modelVariables}
    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(str(fmu), "tire"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
    for name, value in ROLLING.items():
        assert execution.real_initial_value(index, references[name], value)
    rows = []
    for k in range(COUNT):
        if values := schedule(k):
            assert manipulator.slave_real_values(index, [references[n] for n in values], list(values.values()))
        assert execution.step()
        rows.append(observer.last_real_values(index, [references[n] for n in WATCHED]))
    assert execution.status().current_time == round(COUNT * STEP * 1e9)
    return rows


def run_ecos(fmu, slaves, schedule):
    try:
        from ecospy.EcosSimulation import EcosSimulation
    except OSError as error:
        pytest.fail(f"Ecos cannot be loaded ({error}); it needs TBB, Debian's package libtbb12: apt-get install libtbb12")
    from ecospy.EcosSimulationStructure import EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("tire", str(fmu))
        structure.add_parameter_set("start", {f"tire::{n}": v for n, v in ROLLING.items()})
        with EcosSimulation(STEP, structure=structure) as simulation:
            assert simulation.init(0, "start")
            rows = []
            for k in range(COUNT):
                for name, value in schedule(k).items():
                    simulation.set_real(f"tire::{name}", value)
                simulation.step()
                rows.append([simulation.get_real(f"tire::{n}") for n in WATCHED])
            # its clock adds up: not exactly the others' time, and the FMU does not mind
            assert simulation.get_time() == pytest.approx(COUNT * STEP)
            return rows


@pytest.mark.parametrize("schedule", SCHEDULES)
@pytest.mark.parametrize("master", [run_libcosim, run_ecos])
def test_masters_agree_bit_for_bit(fmu, slaves, master, schedule):
    schedule = SCHEDULES[schedule]
    expected = run_fmpy(fmu, slaves, schedule)
    rows = master(fmu, slaves, schedule)
    assert len(rows) == len(expected) == COUNT
    different = [k for k in range(COUNT) if list(rows[k]) != expected[k]]
    assert not different, f"first after step {different[0]}: {rows[different[0]]} and {expected[different[0]]}"
    assert max(abs(row[1]) for row in rows) > 1000


def test_fmpy_itself_agrees_too(fmu, slaves):
    """`simulate_fmu`, FMPy's own master, not our loop around its functions."""
    result = fmpy.simulate_fmu(str(fmu), stop_time=COUNT * STEP, output_interval=STEP, start_values=ROLLING, output=WATCHED)
    rows = [[row[n] for n in WATCHED] for row in result][1:]
    assert rows == run_fmpy(fmu, slaves, still)
