"""Diagnosis of a wired system: two masses whose coupling has friction that the model lacks. The truth is integrated
here."""

import json
import shutil

import numpy as np
import pytest

from conftest import latsch, read_results

STEP, SAMPLES, RUNS = 1e-3, 1200, 4
FRICTION, SPEED = 1.5, 0.05
CHANNELS = ["left.force [N]", "left.velocity [m/s]", "left.reaction [N]", "right.position [m]", "right.velocity [m/s]"]
# masses, springs and dampers to the walls, spring between; the description has 2, 300, 4, 80, 1, 100, 2
TRUE = {"left.mass": 2.1, "left.stiffness": 310.0, "left.damping": 4.3, "left.coupling_stiffness": 84.0,
        "right.mass": 1.0, "right.stiffness": 97.0, "right.damping": 2.1}
# of a spring, a mass and their eigenfrequency two are enough
FITTED = [name for name in TRUE if name != "right.mass"]


def oscillator(x, v, force, stiffness, damping, mass):
    """One step of Runge and Kutta's method with a force that is held."""
    def rate(x, v):
        return v, (force - stiffness * x - damping * v) / mass

    a, b = rate(x, v)
    c, d = rate(x + 0.5 * STEP * a, v + 0.5 * STEP * b)
    e, f = rate(x + 0.5 * STEP * c, v + 0.5 * STEP * d)
    g, h = rate(x + STEP * e, v + STEP * f)
    return x + STEP / 6 * (a + 2 * c + 2 * e + g), v + STEP / 6 * (b + 2 * d + 2 * f + h)


def truth(force, friction):
    """Two machines that tell each other every STEP where one is and what force the other gets. The force is made by the
    first one at the end of a step, in which it was told where the other one had been."""
    m1, k1, d1, kc, m2, k2, d2 = TRUE.values()
    x1 = v1 = x2 = v2 = told = 0.0
    rows = []
    for now in force:
        coupling = kc * (x1 - told) + friction * np.tanh(v1 / SPEED)
        rows.append([now, v1, coupling, x2, v2])
        told = x2
        first = oscillator(x1, v1, now + kc * x2, k1 + kc, d1, m1)
        x2, v2 = oscillator(x2, v2, coupling, k2, d2, m2)
        x1, v1 = first
    return np.array(rows)


def diagnose(system, folder):
    """Runs with the friction, what a system without it is told of them, and the noise of each run."""
    random = np.random.default_rng(7)
    time = STEP * 4 * np.arange(SAMPLES)
    fine = STEP * np.arange(4 * SAMPLES)
    (folder / "recordings").mkdir()
    noises = {}
    for run in range(RUNS):
        waves = [(random.uniform(5, 25), random.uniform(0.5, 4), random.uniform(0, 6.3)) for _ in range(4)]
        force = sum(a * np.sin(2 * np.pi * f * fine + phase) for a, f, phase in waves)
        rows = truth(force, FRICTION)[::4]
        noises[f"run-{run}.csv"] = 0.01 * rows.std(axis=0)
        noise = noises[f"run-{run}.csv"] * random.standard_normal(rows.shape)
        noise[:, 0] = 0
        lines = [",".join(["time [s]", *CHANNELS])]
        lines += [",".join(f"{v:.9g}" for v in [t, *row]) for t, row in zip(time, rows + noise)]
        (folder / "recordings" / f"run-{run}.csv").write_text("\n".join(lines) + "\n")
    shutil.copy(system / "coupled-oscillator.fmu", folder)
    description = (system / "system.toml").read_text().replace(", start_position = 0.1", "")
    (folder / "coupled.toml").write_text(description)
    (folder / "parameters.toml").write_text("[fit]\n" + "".join(f'"{n}" = true\n' for n in FITTED))
    done = latsch("diagnose", folder / "coupled.toml", "--recordings", folder / "recordings", "--parameters",
                  folder / "parameters.toml", "--output", folder / "out")
    assert done.returncode == 0, done.stderr
    (folder / "said.txt").write_text(done.stdout)
    (folder / "noises.json").write_text(json.dumps({name: list(noise) for name, noise in noises.items()}))


@pytest.fixture(scope="module")
def diagnosed(system, made_once):
    """A folder with that, the answer, and the noise of the samples that it was checked with."""
    folder = made_once("coupled", lambda folder: diagnose(system, folder))
    found = json.loads((folder / "out" / "diagnosis.json").read_text())
    noises = {name: np.array(noise) for name, noise in json.loads((folder / "noises.json").read_text()).items()}
    time = STEP * 4 * np.arange(SAMPLES)
    # of a run that was cut its end is for checking
    ends = {r["name"]: 0.0 if r["use"] == "check" else r["check_from"] for r in found["runs"]}
    samples = {name: np.sum(time >= end) for name, end in ends.items() if end is not None}
    squares = sum(n * noises[name] ** 2 for name, n in samples.items()) / sum(samples.values())
    noise = dict(zip([name.split(" [")[0] for name in CHANNELS], np.sqrt(squares)))
    return folder, found, noise


def test_what_is_missing_inside_the_loop_is_named(diagnosed):
    _, found, noise = diagnosed
    assert found["verdict"] == "effect", found["summary"]
    finding = found["findings"][0]
    assert (finding["effect"], finding["place"]) == ("guide-friction", "output left.reaction"), finding
    values = {p["name"]: p["value"] for p in finding["parameters"]}
    assert values["force"] == pytest.approx(FRICTION, rel=0.01)
    parameters = {p["name"]: p["value"] for p in found["parameters"]}
    assert parameters == pytest.approx({name: TRUE[name] for name in FITTED}, rel=0.003)
    # the right mass feels it, and moves right again
    check = {c["channel"]: c for c in found["check"]}
    for channel in ["left.reaction", "right.position", "right.velocity"]:
        assert check[channel]["before"] > 10 * noise[channel], check[channel]
        assert check[channel]["after"] < 1.1 * noise[channel], (check[channel], noise)


def test_the_opened_loop_tells_the_part(diagnosed):
    folder, found, _ = diagnosed
    said = (folder / "said.txt").read_text()
    made = {c["channel"]: c["made_here"] for part in found["parts"] for c in part["channels"]}
    assert {part["part"] for part in found["parts"]} == {"left", "right"}
    assert all(part["closed"] is None for part in found["parts"])
    assert made["left.reaction"] is True, found["parts"]
    assert made["right.position"] is False and made["right.velocity"] is False, found["parts"]
    assert "left differs by itself" in said
    assert "right does not differ by itself" in said
    assert "In which part" in (folder / "out" / "report.html").read_text()


def test_the_corrected_system_runs_as_said(diagnosed):
    folder, found, *_ = diagnosed
    corrected = folder / "out" / "corrected-system"
    assert {f.name for f in corrected.iterdir()} == {"system.toml", "left.fmu", "right.fmu"}
    run = next(r["name"] for r in found["runs"] if r["use"] == "check")
    measured = read_results(folder / "recordings" / run)
    text = (corrected / "system.toml").read_text()
    text += f'\n[[inputs]]\nfile = "{folder}/recordings/{run}"\nconnect = {{ "left.force" = ["left.force"] }}\n'
    (corrected / "driven.toml").write_text(text)
    done = latsch("cosimulate", corrected / "driven.toml", "--stop", "4.7", "--output", folder / "again.csv")
    assert done.returncode == 0, done.stderr
    again = read_results(folder / "again.csv")
    check = {c["channel"]: c for c in found["check"]}
    for channel in ["left.reaction", "right.position"]:
        at = np.interp(measured["time"], again["time"], again[channel])
        inside = np.array(measured["time"]) < 4.7
        error = np.sqrt(np.mean((at - np.array(measured[channel]))[inside] ** 2))
        assert error < 1.3 * check[channel]["after"], (channel, error, check[channel])


def test_a_part_whose_inputs_were_not_recorded_is_said(diagnosed, tmp_path):
    folder, *_ = diagnosed
    (tmp_path / "recordings").mkdir()
    # which parts can be told by themselves is a matter of the channels that there are: little of two runs is enough
    for file in sorted((folder / "recordings").glob("*.csv"))[:2]:
        rows = [line.split(",") for line in file.read_text().splitlines()[:300]]
        keep = [i for i, name in enumerate(rows[0]) if not name.startswith("right.position")]
        text = "\n".join(",".join(row[i] for i in keep) for row in rows) + "\n"
        (tmp_path / "recordings" / file.name).write_text(text)
    done = latsch("diagnose", folder / "coupled.toml", "--recordings", tmp_path / "recordings", "--parameters",
                  folder / "parameters.toml", "--output", tmp_path / "out", "--format", "json")
    assert done.returncode == 0, done.stderr
    parts = {p["part"]: p for p in json.loads(done.stdout)["parts"]}
    assert parts["left"]["channels"] == [] and "no channel tells left.other_position" in parts["left"]["closed"]
    assert parts["right"]["closed"] is None
