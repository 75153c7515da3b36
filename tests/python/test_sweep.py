"""Studies of many runs: scripts/sweep.py on clusters of one and two workers, with workers that die."""

import importlib.util
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pyarrow.parquet
import pytest

from conftest import PATIENCE, PROGRAM, ROOT, latsch, read_results

SWEEP = ROOT / "scripts" / "sweep.py"
SYSTEM = """
step = 1e-3
stop = 0.4
[component.brake]
model = "brake-hydraulics"
[[inputs]]
file = "driver.csv"
connect = { pressure = "brake.driver_pressure" }
"""
# the last rate is beyond the model's range, and the first one too slow for what the runs wait for
STUDY = """
system = "system.toml"
until = { channel = "brake.pressure", above = 12e5 }
set = { "brake.inlet_valve" = 0.2 }
[vary]
"brake.build_rate" = { values = [100, 400, 800, 2e6], unit = "bar/s" }
gain = { set = "brake.friction", from = 0.3, to = 0.5 }
[sample]
count = 3
seed = 4
[results]
end = { last = "brake.pressure" }
most = { max = "brake.brake_torque", from = 0.01 }
least = { min = "brake.pressure", from = 0.02, to = 0.05 }
average = { mean = "brake.pressure" }
rise = { when = "brake.pressure", above = 5e5 }
torque_then = { value = "brake.brake_torque", when = "brake.pressure", above = 5e5 }
never = { when = "brake.pressure", below = -1e5 }
late = { max = "brake.pressure", from = 0.3 }
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "driver.csv").write_text("time [s],pressure [bar]\n0,0\n0.001,100\n0.5,100\n")
    (tmp_path / "system.toml").write_text(SYSTEM)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path / "study.toml"


def sweep(study, *arguments, program=PROGRAM):
    command = [sys.executable, SWEEP, study, "--latsch", program, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)


def table(path):
    return pyarrow.parquet.read_table(path).to_pydict()


def test_the_table_is_what_single_runs_give_on_any_cluster(study, tmp_path):
    done = sweep(study, "--workers", 2)
    assert done.returncode == 1, done.stderr
    found = table(tmp_path / "study.parquet")
    assert found["status"] == ["failed"] * 3 + ["ok"] * 6 + ["failed"] * 3
    assert found["run"] == list(range(1, 13)) and len(set(found["key"])) == 12
    # what fails says why and has no numbers
    assert all("brake.pressure > 1200000.0 is not reached" in e for e in found["error"][:3])
    assert all("build_rate" in e and "range" in e for e in found["error"][9:])
    assert "error of 3: " in done.stdout and found["error"][3:9] == [None] * 6
    # every third of the range is drawn from once, and each rate has the same
    gains = found["gain"]
    assert gains == gains[:3] * 4 and sorted(int((g - 0.3) / 0.2 * 3) for g in gains[:3]) == [0, 1, 2]
    numbers = [name for name in found if name.split(" [")[0] in ("end", "most", "least", "average", "rise", "torque_then", "never", "late")]
    assert len(numbers) == 8 and "rise [s]" in numbers and "most [N.m]" in numbers
    for run in range(12):
        if found["status"][run] == "failed":
            assert all(found[name][run] is None for name in numbers)
            continue
        out = tmp_path / "run.csv"
        values = ["brake.inlet_valve=0.2", f"brake.build_rate={found['brake.build_rate [bar/s]'][run]} bar/s"]
        values += [f"brake.friction={gains[run]!r}"]
        settings = [word for value in values for word in ("--set", value)]
        done = latsch("cosimulate", tmp_path / "system.toml", "-o", out, "--until", "brake.pressure > 12 bar", *settings)
        assert done.returncode == 0, done.stderr
        rows = {name: np.array(column) for name, column in read_results(out).items()}
        t, p, torque = rows["time"], rows["brake.pressure"], rows["brake.brake_torque"]
        assert t[-1] < 0.4 and p[-1] > 12e5 and (p[:-1] <= 12e5).all()
        window = (t >= 0.02) & (t <= 0.05)
        assert found["end [Pa]"][run] == p[-1] and found["most [N.m]"][run] == torque[t >= 0.01].max()
        assert found["least [Pa]"][run] == (p[window].min())
        assert found["average [Pa]"][run] == pytest.approx(np.trapezoid(p, t) / t[-1], rel=1e-12)
        # pressure only rises: the inverse is a function
        assert found["rise [s]"][run] == pytest.approx(np.interp(5e5, p, t), rel=1e-9)
        assert found["torque_then [N.m]"][run] == pytest.approx(np.interp(5e5, p, torque), rel=1e-9)
        assert found["never [s]"][run] is None and found["late [Pa]"][run] is None
    # a cluster of somebody else's, with one worker and nothing of latsch
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0", local_directory=tmp_path) as cluster:
        done = sweep(study, "--scheduler", cluster.scheduler_address, "--output", tmp_path / "other.parquet")
        # nothing of the study stays there
        assert not list(tmp_path.rglob("latsch-*")), list(tmp_path.rglob("latsch-*"))
        assert not any(name.startswith("latsch") for name in cluster.scheduler.worker_plugins)
    assert done.returncode == 1, done.stderr
    nobody = sweep(study, "--scheduler", "tcp://localhost", "--output", tmp_path / "nobody.parquet")
    assert nobody.returncode == 2 and "there is no cluster" in nobody.stderr, nobody.stderr
    assert not (tmp_path / "nobody.parquet.journal").exists()
    assert (tmp_path / "other.parquet").read_bytes() == (tmp_path / "study.parquet").read_bytes()
    # all is there: the same command does nothing more
    done = sweep(study)
    assert "12 runs, 0 to do" in done.stdout and done.returncode == 1
    assert (tmp_path / "other.parquet").read_bytes() == (tmp_path / "study.parquet").read_bytes()


def write_program(path, lines):
    """A program that does something before it is latsch; not when the study is tried out."""
    path.write_text(f'#!/bin/sh\ncase "$*" in *try.csv*) ;; *)\n{lines}\n;; esac\nexec "{PROGRAM}" "$@"\n')
    path.chmod(0o755)
    return path


SMALL = """
system = "system.toml"
[vary]
"brake.build_rate" = { values = [10, 20, 30, 40, 50], unit = "bar/s" }
[results]
end = { last = "brake.pressure" }
"""


def test_a_worker_that_dies_costs_no_run_and_one_that_always_dies_is_a_row(study, tmp_path):
    study.write_text(SMALL)
    (tmp_path / "poison").touch()
    program = write_program(tmp_path / "deadly", f"""
        if mkdir "{tmp_path}/once" 2>/dev/null; then kill -9 $PPID; exit 1; fi
        case "$*" in *"=40.0 bar/s"*) if [ -e "{tmp_path}/poison" ]; then kill -9 $PPID; exit 1; fi ;; esac""")
    done = sweep(study, "--workers", 2, "--retries", 1, program=program)
    assert done.returncode == 1, done.stderr
    found = table(tmp_path / "study.parquet")
    assert found["status"] == ["ok", "ok", "ok", "lost", "ok"], found
    assert "no answer" in found["error"][3] and found["end [Pa]"][3] is None
    assert (tmp_path / "once").exists()
    # what befell a machine is done again
    (tmp_path / "poison").unlink()
    done = sweep(study, program=program)
    assert done.returncode == 0 and "5 runs, 1 to do" in done.stdout, done.stderr
    again = table(tmp_path / "study.parquet")
    assert again["status"] == ["ok"] * 5
    assert again["end [Pa]"][:3] == found["end [Pa]"][:3] and again["end [Pa]"][3] > again["end [Pa]"][2]
    # another program or study does not mix with it silently
    done = sweep(study)
    assert done.returncode == 2 and "--replace" in done.stderr


def test_an_interrupted_study_goes_on_with_what_is_missing(study, tmp_path):
    study.write_text(SMALL)
    log, go = tmp_path / "log", tmp_path / "go"
    program = write_program(tmp_path / "slow", f"""
        echo "$*" >> "{log}"
        case "$*" in *"=30.0 bar/s"*) while [ ! -e "{go}" ]; do sleep 0.05; done ;; esac""")
    command = [sys.executable, SWEEP, study, "--latsch", program, "--workers", "2"]
    # a shell that starts tests in the background lets them ignore interrupts
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    journal = tmp_path / "study.parquet.journal"
    end = time.monotonic() + PATIENCE
    try:
        while not journal.exists() or journal.read_text().count("\n") < 4:
            if running.poll() is not None or time.monotonic() > end:
                # it waits for the run that waits
                go.touch()
                running.kill()
                pytest.fail(f"it has not come to the fourth run: {running.communicate(timeout=PATIENCE)}")
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        _, errors = running.communicate(timeout=PATIENCE)
    finally:
        go.touch()
        running.kill()
        running.wait()
    assert running.returncode == 130 and "4 of 5 runs are done" in errors, errors
    assert not (tmp_path / "study.parquet").exists()
    # as if the machine had failed while a row was written
    with open(journal, "a") as file:
        file.write('{"key": "12')
    done = sweep(study, program=program)
    assert done.returncode == 0 and "5 runs, 1 to do" in done.stdout, done.stderr
    assert [log.read_text().count(f"={p}.0 bar/s") for p in (10, 20, 30, 40, 50)] == [1, 1, 2, 1, 1]
    assert not journal.exists()
    found = table(tmp_path / "study.parquet")
    assert found["brake.build_rate [bar/s]"] == [10, 20, 30, 40, 50] and found["status"] == ["ok"] * 5
    assert np.diff(found["end [Pa]"]).min() > 1e5


@pytest.fixture(scope="module")
def module():
    """The script in this process, for what needs no cluster."""
    sys.path.insert(0, str(SWEEP.parent))
    spec = importlib.util.spec_from_file_location("sweep_script", SWEEP)
    module = importlib.util.module_from_spec(spec)
    sys.modules["sweep_script"] = module
    spec.loader.exec_module(module)
    return module


WRONG = [
    ("system = \"system.toml\"", "", ["system", "missing"]),
    ("system = \"system.toml\"", "system = \"other.toml\"", ["other.toml", "no such file"]),
    ("system = \"system.toml\"", "system = 3", ["system", "3"]),
    ("system = \"system.toml\"", "system = \"driver.csv\"", [".toml, .ssd or .ssp", "driver.csv"]),
    ("system = \"system.toml\"", "system = \"system.toml\"\nexport = [\"abs-controller\"]", ["abs-controller.fmu", "names no"]),
    ("system = \"system.toml\"", "system = \"system.toml\"\nexport = [\"abs\"]", ["export: abs"]),
    ("until = {", "untill = {", ["untill", "did you mean until?"]),
    (", above = 12e5 }", " }", ["until", "above or below"]),
    ("channel = \"brake.pressure\"", "channel = \"brake.presure\"", ["until", "brake.presure", "did you mean brake.pressure"]),
    ("\"brake.inlet_valve\" = 0.2", "\"brake.inlet\" = 0.2", ["brake.inlet", "no run starts"]),
    ("\"brake.inlet_valve\" = 0.2", "\"brake.driver_pressure\" = 0.2", ["driver_pressure", "source"]),
    ("\"brake.inlet_valve\" = 0.2", "\"brake.friction\" = 0.2", ["brake.friction", "two values"]),
    ("[100, 400, 800, 2e6]", "[10, \"a\"]", ["vary.brake.build_rate.values", "one kind"]),
    ("[100, 400, 800, 2e6]", "[10, 10.0]", ["twice"]),
    ("[100, 400, 800, 2e6]", "[]", ["vary.brake.build_rate.values"]),
    ("[100, 400, 800, 2e6]", "[nan]", ["finite"]),
    ("unit = \"bar/s\"", "unit = \"kg\"", ["no run starts", "kg"]),
    ("from = 0.3, to = 0.5", "from = 0.5, to = 0.3", ["vary.gain", "less than"]),
    ("from = 0.3, to = 0.5", "from = 0.3", ["vary.gain", "from and to"]),
    ("from = 0.3, to = 0.5", "from = 0, to = 0.3, scale = \"log\"", ["vary.gain.from", "positive"]),
    ("from = 0.3, to = 0.5", "from = 0.3, to = 0.5, count = 2", ["sample", "no parameter is sampled"]),
    ("set = \"brake.friction\", ", "", ["vary.gain", "set ="]),
    ("[sample]\ncount = 3\nseed = 4", "", ["vary.gain", "count", "[sample]"]),
    ("seed = 4", "", ["sample.seed", "missing"]),
    ("count = 3", "count = 3000000", ["3000000", "1000000"]),
    ("seed = 4", "seed = 4\nmethod = \"sobol\"", ["sample.method", "latin-hypercube"]),
    ("last = \"brake.pressure\"", "last = \"brake.force\"", ["results.end", "brake.force", "channel"]),
    ("last = \"brake.pressure\"", "end = \"brake.pressure\"", ["results.end.end", "no such key"]),
    ("last = \"brake.pressure\"", "last = \"brake.pressure\", max = \"brake.pressure\"", ["results.end", "one of"]),
    ("from = 0.02, to = 0.05", "from = 0.05, to = 0.02", ["results.least", "before"]),
    ("above = 5e5 }\ntorque", "above = \"5 bar\" }\ntorque", ["results.rise.above", "a number"]),
    ("[results]\nend", "[results]\ngain", ["gain", "column"]),
    ("[results]", "[results", ["TOML"]),
    ("set = \"brake.friction\", ", "set = [], ", ["vary.gain.set", "at least one"]),
    ("from = 0.3, to = 0.5", f"from = 0.3, to = 1{'0' * 400}", ["vary.gain.to", "finite"]),
    ("[100, 400, 800, 2e6]", f"[1{'0' * 400}]", ["vary.brake.build_rate.values", "finite"]),
    ("\"brake.inlet_valve\" = 0.2", "\"brake.inlet_valve\" = [0.2]", ["set.brake.inlet_valve", "a finite number", "0.2"]),
    ("\"brake.inlet_valve\" = 0.2", "\"brake.inlet_valve\" = \"@/elsewhere/road.csv\"", ["brake.inlet_valve", "absolute", "the study's"]),
    ("when = \"brake.pressure\", above = 5e5 }\ntorque", "when = \"\", above = 5e5 }\ntorque", ["results.rise.when", "empty"]),
    ("gain = {", "\"gain [1]\" = {", ["gain [1]", "brackets"]),
]


@pytest.mark.parametrize("old, new, expected", WRONG, ids=[str(i) for i in range(len(WRONG))])
def test_a_wrong_study_is_told_before_a_cluster_is_started(study, module, capsys, monkeypatch, old, new, expected):
    assert STUDY.count(old) >= 1
    study.write_text(STUDY.replace(old, new, 1))
    monkeypatch.setattr(module, "connected", lambda *_: pytest.fail("a cluster was started"))
    monkeypatch.setattr(sys, "argv", ["sweep.py", str(study), "--latsch", str(PROGRAM)])
    assert module.main() == 2
    told = capsys.readouterr().err
    assert told.startswith(f"error: {study}: ") and len(told.splitlines()) == 1, told
    for words in expected:
        assert words in told, told
    assert not any(name.startswith("study.parquet") for name in os.listdir(study.parent))


def test_shipped_models_are_exported_for_a_description(module, capsys, monkeypatch, tmp_path):
    """The description of examples/abs-stop names FMUs that are not there."""
    (tmp_path / "SystemStructure.ssd").write_text((ROOT / "examples" / "abs-stop" / "SystemStructure.ssd").read_text())
    study = tmp_path / "study.toml"
    text = """system = "SystemStructure.ssd"
        export = ["abs-controller", "brake-hydraulics", "ring-brush-corner"]
        [vary]
        "corner.friction_factor" = [0.5, 1]
        [results]
        distance = { last = "corner.vehicle_distance" }
        """
    monkeypatch.setattr(sys, "argv", ["sweep.py", str(study), "--latsch", str(PROGRAM), "--check"])
    study.write_text(text)
    assert module.main() == 0, capsys.readouterr().err
    assert "2 runs, 2 to do" in capsys.readouterr().out
    study.write_text(text.replace('"abs-controller", ', ""))
    assert module.main() == 2
    assert 'export = ["abs-controller"] makes it' in capsys.readouterr().err


def test_the_studies_of_the_documentation_are_studies(module, tmp_path):
    study = module.Study(ROOT / "examples" / "abs-study" / "stopping-distance.toml")
    assert len(study.points) == 1000
    page = (ROOT / "docs" / "studies.md").read_text()
    (tmp_path / "page.toml").write_text(page.split("```toml\n")[1].split("```")[0])
    assert len(module.Study(tmp_path / "page.toml").points) == 4000 and "4000 runs" in page


def test_sampled_values_are_where_they_should_be(module):
    """One value in each part of the range, on both scales; the same again from the same seed, others from another."""
    for method in ("latin-hypercube", "random"):
        draws = [module.sweep_study.draw(method, 2, 50, seed) for seed in (1, 1, 2)]
        assert draws[0] == draws[1] != draws[2]
        assert all(0 <= share < 1 for row in draws[0] for share in row)
    shares = np.array(module.sweep_study.draw("latin-hypercube", 2, 50, 1))
    for column in shares.T:
        assert sorted((column * 50).astype(int)) == list(range(50))
    vary = module.sweep_study.read_vary("a.b", {"from": 1e-3, "to": 10.0, "scale": "log", "count": 5})
    assert vary.values == pytest.approx([1e-3, 1e-2, 1e-1, 1.0, 10.0], rel=1e-12) and vary.values[-1] == 10.0
