"""Machines of no one's choosing: FMUs that a C compiler makes of what `latsch-truth` draws, and their diagnoses."""

import csv
import json
import subprocess
import sys

import fmpy
import numpy as np
import pytest

from conftest import PATIENCE, ROOT, TARGET, latsch, read_results

SEED = 2
# of the study of random machines: number, verdict, names that are right. In 6 the gain of one force sensor is, with other
# masses and stiffnesses, that of all others.
CASES = {
    1: ("unknown", []),
    2: ("effect", ["actuator-lag"]),
    3: ("nothing", []),
    5: ("effect", ["maxwell-element"]),
    6: ("effect", ["sensor-gain", "sensor-delay"]),
}


@pytest.fixture(scope="module")
def study():
    folder = TARGET / "prove-machines"
    only = ",".join(f"case-{number:03}" for number in CASES)
    command = [sys.executable, ROOT / "scripts" / "prove", "--machines", "--only", only, "--seed", str(SEED)]
    command += ["--output", folder, "--limit", str(PATIENCE)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("number", CASES)
def test_a_machine_that_nobody_has_chosen_is_understood(study, number):
    verdict, names = CASES[number]
    found = json.loads((study / "results" / f"case-{number:03}" / "diagnosis.json").read_text())
    assert found["verdict"] == verdict, found["summary"]
    said = [f["effect"] for f in found["findings"] if f["effect"] != "unknown"]
    assert said == names, found["summary"]


def test_the_same_machine_told_differently_gets_the_same_answer(study):
    """In other units, faster, and with one sensor of one run reversed."""
    views = ["larger", "faster", "spoilt"]
    command = [sys.executable, ROOT / "scripts" / "prove-views", "--only", "2", "--seed", str(SEED), "--views", ",".join(views)]
    command += ["--programs", study / "bin", "--output", TARGET / "prove-views"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    assert "| larger | 1 of 1 | 0.0" in done.stdout and "| faster | 1 of 1 | 0.0" in done.stdout, done.stdout
    assert "| spoilt | 1 of 1 |" in done.stdout, done.stdout


# of another seed: friction at a body whose one sensor counts against the force that moves it, and a damper that differs by
# direction at a body of which only the position is shown, beside another's velocity
COUNTED = {(11, "turned"): ("coulomb-friction", "-rate(position_frame)"), (18, "same"): ("damper-asymmetry", "rate(piston_position)")}


@pytest.mark.parametrize("case", COUNTED, ids=str)
def test_a_force_is_driven_by_the_motion_of_its_own_body(study, case, tmp_path):
    (number, view), (name, driver) = case, COUNTED[case]
    command = [study / "bin" / "latsch-truth", "case", str(number), "--machines", "--seed", "9", "--view", view]
    subprocess.run([*command, "--output", tmp_path], check=True, timeout=PATIENCE)
    out = tmp_path / "diagnosis"
    found = latsch("diagnose", tmp_path / "machine.fmu", "--recordings", tmp_path / "recordings", "--output", out)
    assert found.returncode == 0, found.stderr
    diagnosis = json.loads((out / "diagnosis.json").read_text())
    assert [f["effect"] for f in diagnosis["findings"]] == [name], diagnosis["summary"]
    assert all(p["value"] > 0 for p in diagnosis["findings"][0]["parameters"]), diagnosis["findings"]
    assert f'drivers = ["{driver}"]' in (out / "corrected.toml").read_text()
    # the corrected unit, driven from outside with the step that it proposes, leaves what is stated, if inputs run as smoothly
    # between samples as a diagnosis takes them
    left = {check["channel"]: [] for check in diagnosis["check"]}
    for run in (r["name"] for r in diagnosis["runs"] if r["use"] == "check"):
        recorded, inputs = read_results(tmp_path / "recordings" / run), tmp_path / "inputs.csv"
        with open(tmp_path / "recordings" / run, newline="") as file:
            heads = [h for h in next(csv.reader(file)) if h.split(" [")[0] not in left]
        fine = np.arange(recorded["time"][0], recorded["time"][-1], np.median(np.diff(recorded["time"])) / 10)
        courses = [smooth(recorded["time"], recorded[h.split(" [")[0]]) for h in heads[1:]]
        with open(inputs, "w", newline="") as file:
            csv.writer(file).writerows([heads, *([repr(float(t)), *(repr(float(at(t))) for at in courses)] for t in fine)])
        done = latsch("simulate", out / "corrected.fmu", "--inputs", inputs, "--output", tmp_path / "results.csv")
        assert done.returncode == 0, done.stderr
        simulated = read_results(tmp_path / "results.csv")
        time = [t for t in recorded["time"] if t <= simulated["time"][-1]]
        for channel, errors in left.items():
            errors.extend(recorded[channel][: len(time)] - np.interp(time, simulated["time"], simulated[channel]))
    for check in diagnosis["check"]:
        after = np.sqrt(np.mean(np.square(left[check["channel"]])))
        assert after == pytest.approx(check["after"], rel=0.02), check["channel"]


def smooth(time, values):
    """The natural cubic spline."""
    steps, number = np.diff(time), len(time)
    matrix, right = np.eye(number), np.zeros(number)
    for k in range(1, number - 1):
        matrix[k, k - 1 : k + 2] = steps[k - 1], 2 * (steps[k - 1] + steps[k]), steps[k]
        right[k] = 6 * ((values[k + 1] - values[k]) / steps[k] - (values[k] - values[k - 1]) / steps[k - 1])
    bends = np.linalg.solve(matrix, right)

    def at(t):
        k = min(max(np.searchsorted(time, t) - 1, 0), number - 2)
        h, a = steps[k], (time[k + 1] - t) / steps[k]
        b = 1 - a
        return a * values[k] + b * values[k + 1] + ((a**3 - a) * bends[k] + (b**3 - b) * bends[k + 1]) * h * h / 6

    return at


def test_a_machine_answers_as_it_was_recorded(study, tmp_path):
    """Where nothing is concealed, the C code in FMPy leaves what noise alone leaves: a cylinder that
    moves four bodies, one of them a pendulum. Its resonances hardly answer to wrong stamps of the inputs, which are in no floor."""
    truth, case = study / "bin" / "latsch-truth", tmp_path / "case"
    for what in ("case", "answers"):
        subprocess.run([truth, what, "26", "--machines", "--output", tmp_path / what], check=True)
    noise = json.loads((tmp_path / "answers" / "case-026.reference.json").read_text())
    description = fmpy.read_model_description(case / "machine.fmu")
    variables = {v.name: v for v in description.modelVariables}
    inputs = [v.valueReference for v in description.modelVariables if v.causality == "input"]
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    for run in noise["runs"][:2]:
        with open(case / "recordings" / run["name"]) as file:
            header, *rows = csv.reader(file)
        table = dict(zip([cell.split(" [")[0] for cell in header], np.array(rows, float).T))
        time = table["time"]
        driven = [table[v.name] for v in description.modelVariables if v.causality == "input"]
        courses = [smooth(time, values) for values in driven]
        slave = fmpy.fmi2.FMU2Slave(
            guid=description.guid, unzipDirectory=fmpy.extract(case / "machine.fmu"), modelIdentifier="machine"
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.setReal(inputs, [values[0] for values in driven])
        slave.exitInitializationMode()
        references = [variables[name].valueReference for name in outputs]
        answers = [slave.getReal(references)]
        parts = 32
        for k in range(1, len(time)):
            fine = np.linspace(time[k - 1], time[k], parts + 1)
            for begin, end in zip(fine, fine[1:]):
                middle = 0.5 * (begin + end)
                slave.setReal(inputs, [course(middle) for course in courses])
                slave.doStep(begin, end - begin)
            slave.setReal(inputs, [values[k] for values in driven])
            answers.append(slave.getReal(references))
        slave.terminate()
        slave.freeInstance()
        answers = np.array(answers)
        for column, name in enumerate(outputs):
            left = np.sqrt(np.mean((answers[:, column] - table[name]) ** 2))
            floor = np.sqrt(dict(map(tuple, run["channels"]))[name])
            assert 0.9 * floor < left < 1.1 * floor, (run["name"], name, left / floor)


def write(path, header, *columns):
    np.savetxt(path, np.transpose(columns), delimiter=",", header=header, comments="")


@pytest.mark.parametrize("slower", [0.2, 1.0, 8.0])
def test_a_machine_that_is_slower_has_the_same_name_and_a_slower_lag(base_model, tmp_path, slower):
    """The same dimensionless machine: stiffness by 1/t^2, damping by 1/t; the lag of its position sensor by t."""
    recordings = tmp_path / "recordings"
    recordings.mkdir()
    number = 1200
    time = 0.01 * np.arange(number)
    believed, true = {"mass": 10.0, "stiffness": 4000.0, "damping": 80.0}, {"mass": 10.0, "stiffness": 4300.0, "damping": 70.0}
    scaled = lambda values: {"mass": values["mass"], "stiffness": values["stiffness"] / slower**2, "damping": values["damping"] / slower}
    for run in range(6):
        dice = np.random.default_rng(run)
        sines = zip(dice.uniform(100, 400, 8), dice.uniform(0.3, 6, 8), dice.uniform(0, 6, 8))
        force = sum(a * np.sin(2 * np.pi * f * time + phase) for a, f, phase in sines) / slower**2
        path = recordings / f"run-{run}.csv"
        write(path, "time [s],force [N]", slower * time, force)
        results = tmp_path / "results.csv"
        sets = [word for name, value in scaled(true).items() for word in ("--set", f"{name}={value!r}")]
        done = latsch("simulate", base_model("oscillator"), "--inputs", path, "--step", repr(slower * 0.0025), *sets, "--output", results)
        assert done.returncode == 0, done.stderr
        simulated = {name: np.array(values) for name, values in read_results(results).items()}
        lag, fine, at = 0.02, simulated["time"] / slower, [simulated["position"][0]]
        for k in range(1, len(fine)):
            # exact for a position that runs straight
            step, slope = fine[k] - fine[k - 1], (simulated["position"][k] - simulated["position"][k - 1]) / (fine[k] - fine[k - 1])
            behind = simulated["position"][k] - slope * lag
            at.append(behind + (at[-1] - simulated["position"][k - 1] + slope * lag) * np.exp(-step / lag))
        columns = [np.interp(time, fine, at), np.interp(time, fine, simulated["velocity"])]
        measured = [c + 0.01 * c.std() * dice.standard_normal(number) for c in columns]
        write(path, "time [s],force [N],position [m],velocity [m/s]", slower * time, force, *measured)
    parameters = tmp_path / "parameters.toml"
    parameters.write_text("[parameters]\n" + "".join(f"{k} = {v!r}\n" for k, v in scaled(believed).items()))
    output = tmp_path / "output"
    done = latsch("diagnose", base_model("oscillator"), "--recordings", recordings, "--parameters", parameters, "--output", output)
    assert done.returncode == 0, done.stderr
    found = json.loads((output / "diagnosis.json").read_text())
    assert [(f["effect"], f["place"]) for f in found["findings"]] == [("sensor-lag", "output position")], found["summary"]
    [estimate] = found["findings"][0]["parameters"]
    assert estimate["value"] == pytest.approx(0.02 * slower, rel=0.05)
    parameters = {p["name"]: p["value"] for p in found["parameters"]}
    assert parameters == pytest.approx(scaled(true), rel=0.03)
