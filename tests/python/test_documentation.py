"""Every command of the documentation is run, block by block as a shell runs it, beside files that stand for the reader's."""

import os
import re
import shutil
import subprocess

import numpy as np
import pytest
import test_files
import test_tire
from conftest import MODEL, PATIENCE, PROGRAM, ROOT, TWO_MASSES, latsch

PAGES = {f"{path.parent.name}/README" if path.name == "README.md" and path.parent != ROOT else path.stem: path for path in [
    ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *(ROOT / place / "README.md" for place in ("examples", "python", "fmu-template"))
]}
# What is run elsewhere, and where: what takes minutes, and what only a release or a network has.
ELSEWHERE = {
    "cargo run --release -- demo": "test_cli.py::test_demo_makes_pages_that_need_nothing_else",
    "LATSCH_LIBRARY_INSIDE=1 cargo install": "by hand, docs/release.md",
    "scripts/test": "this is part of it",
    "latsch rig-program ring-brush-flat-track --output demo": "test_identify.py::test_from_programme_to_parameters",
    "latsch rig-program ring-brush-flat-track --output programme": "test_identify.py::test_from_programme_to_parameters",
    "latsch rig-program examples/plans/ring": "test_identify.py::test_the_passenger_cars_tire_is_what_the_published_curves_give",
    "latsch plan check": "test_identify.py::test_a_plan_is_checked_on_a_model_and_on_its_fmu",
    "latsch cosimulate stop.toml --open car": "tests/car_stop",
    "latsch solid-tire": "tests/characteristics.rs, which makes the recordings",
    "latsch export MODEL --binary": "test_template.py::test_an_fmu_with_several_binaries",
    "cargo build --release --locked -p latsch -p latsch-fmu": "test_package.py::test_functions_do_what_the_program_does",
    "cargo build --package latsch-real-models": "test_real_recordings.py::test_the_nominal_models_run_on_the_recordings",
    "cargo build --release --package latsch-tire-function": "test_tire_function.py::test_a_host_in_c_gets_what_a_rig_gets",
    "HOSTILE_CASES": "tests/hostile",
    "scripts/release": "by hand, docs/release.md",
    "scripts/test-windows": "by hand, docs/release.md",
    "scripts/bench": "by hand, docs/speed.md",
    "python3 -m venv studies": "test_sweep.py::test_the_table_is_what_single_runs_give_on_any_cluster",
    "studies/bin/python": "test_sweep.py::test_the_table_is_what_single_runs_give_on_any_cluster",
    "dask": "test_sweep.py::test_the_table_is_what_single_runs_give_on_any_cluster",
}


def blocks(page):
    """Blocks of shell commands, each a list of lines; usage with choices in it is no block."""
    for text in re.findall(r"^```sh\n(.*?)^```", PAGES[page].read_text(), re.M | re.S):
        yield re.sub(r"\\\n +", " ", text).strip().splitlines()


def test_what_is_said_to_be_run_elsewhere_is_there():
    first = [lines[0] for page in PAGES for lines in blocks(page)]
    for command, place in ELSEWHERE.items():
        assert any(line.startswith(command) for line in first), f"{command}: no longer in the documentation"
        file, _, test = place.partition("::")
        if test:
            assert f"def {test}(" in (ROOT / "tests" / "python" / file).read_text(), place


def lines_of(block):
    """What these two find is no failure."""
    return [f"{line.split('#')[0].strip()} || [ $? -eq 1 ]" if line.startswith(("latsch lint", "latsch freeze")) else line for line in block]


# ---- files that stand for the reader's


def done(*arguments):
    ran = latsch(*arguments)
    assert ran.returncode == 0, ran.stderr
    return ran


def changed(source, target, *pairs):
    text = source.read_text()
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    target.write_text(text)


def columns(path, head, *values):
    path.parent.mkdir(exist_ok=True)
    np.savetxt(path, np.transpose(values), delimiter=",", header=head, comments="")


def road_of_two_tracks(path):
    x = 0.25 * np.arange(1, 401)
    columns(path.with_suffix(".csv"), "x [m],z [m],z_right [m]", x, 2e-3 * np.sin(x), 2e-3 * np.cos(x))
    done("convert", path.with_suffix(".csv"), path)


def car(folder):
    """The example of a car that stops, in a folder of its own."""
    shutil.copytree(ROOT / "examples" / "car-abs-stop", folder, dirs_exist_ok=True)


def stops(folder, *pairs):
    """A simulated stop, and three recordings of it in which something has another name."""
    car(folder)
    done("cosimulate", folder / "system.toml", "--output", folder / "results.csv")
    for k in (1, 2, 3):
        changed(folder / "results.csv", folder / f"stop-{k}.csv", *pairs)


def flat_track_of_the_demo(folder):
    (folder / "demo" / "flat-track").mkdir(parents=True)
    shutil.copy(ROOT / "examples" / "rig-programme.csv", folder / "demo" / "flat-track")
    done("export", MODEL, "--output", folder / "demo" / "flat-track" / f"{MODEL}.fmu")


def tires_and_a_road(folder):
    (folder / "F.tir").write_text(test_tire.TIRE)
    (folder / "solid.tir").write_text(test_files.TIRE)
    (folder / "cleat.rdf").write_text(test_files.ROAD)
    (folder / "fitted.toml").write_text("[parameters]\nLMUY = 0.8\n")
    road_of_two_tracks(folder / "road.crg")


def solid_tire_and_roads(folder):
    (folder / "F.tir").write_text(test_files.TIRE)
    (folder / "cleat.rdf").write_text(test_files.ROAD)
    road_of_two_tracks(folder / "belgian.crg")


def tire_that_stands(folder):
    done("export", "fiala-flat-track", "--output", folder / "model.fmu")
    time = np.arange(0, 3, 0.01)
    for k in range(4):
        columns(folder / "inputs" / f"run-{k}.csv", "time [s],deflection [m]", time, 0.02 + 0.004 * np.sin((6 + 5 * k) * time))
    done("simulate", folder / "model.fmu", "--inputs", folder / "inputs", "--output", folder / "runs", "--step", "0.01")


def stop_of_a_plant(folder):
    """Another name of the car, whose own results are taken for measured."""
    car(folder)
    changed(folder / "system.toml", folder / "stop.toml", ("[component.car", "[component.plant"), ('"car.', '"plant.'), ('"car"', '"plant"'))
    done("cosimulate", folder / "stop.toml", "--output", folder / "measured.csv")


def scales(folder):
    car(folder)
    (folder / "car.toml").write_text('[measured]\n"car.front_left.force_z" = "4000 N"\n')


def loads_of_a_rig(folder):
    car(folder)
    done("cosimulate", folder / "system.toml", "--output", folder / "rig.rsp")


def rolling_on_a_drum(folder):
    time = np.arange(0, 3, 0.005)
    columns(folder / "drive.csv", "time [s],drum_speed [m/s]", time, np.interp(time, [0.3, 1.5], [2.0, 4.0]))
    (folder / "found.toml").write_text("[parameters]\nrolling_resistance = 0.01\n")
    for k in (1, 2, 3):
        channels = ["--channels", "drum_speed,arm_displacement", "--interval", "0.005", "--noise", "0.01", "--seed", k]
        done("simulate", "super-elastic-drum", "--inputs", folder / "drive.csv", *channels, "--output", folder / f"run-{k}.csv")


def rims(folder):
    time = np.arange(0, 1, 0.01)
    columns(folder / "rims.csv", "time [s],left.carrier_force_x [N],right.carrier_force_x [N]", time, -500 * time, -800 * time)


def models(folder):
    shutil.copytree(ROOT / "examples", folder / "examples")


# What has to be there before a block of a page, by the beginning of its first line.
BEFORE = {
    ("README", "latsch characterize"): models,
    ("README", "latsch simulate demo"): flat_track_of_the_demo,
    ("README", "latsch export ring-brush"): lambda folder: (folder / "tire.toml").write_text("[parameters]\nvertical_stiffness = 190e3\n"),
    ("README", "latsch export magic"): tires_and_a_road,
    ("README", "latsch diagnose"): tire_that_stands,
    ("characteristics", "latsch characterize"): models,
    ("cosimulate", "latsch cosimulate system"): car,
    ("cosimulate", "latsch cosimulate stop.toml --output"): stop_of_a_plant,
    ("cosimulate", "latsch lint"): scales,
    ("cosimulate", "latsch freeze"): car,
    ("files", "latsch simulate"): solid_tire_and_roads,
    ("files", "latsch cosimulate"): loads_of_a_rig,
    ("loads", "latsch loads"): lambda folder: stops(folder, ("car.front_left.tie_rod_force", "F_SS")),
    ("measured", "latsch simulate"): rolling_on_a_drum,
    ("vehicle", "cd examples"): models,
    ("vehicle", "latsch simulate axle"): rims,
    ("vehicle", "latsch pad-friction"): lambda folder: stops(folder),
    ("examples/README", "latsch export coupled"): lambda folder: shutil.copy(TWO_MASSES / "system.toml", folder),
    ("examples/README", "for model in"): lambda folder: shutil.copy(ROOT / "examples" / "abs-stop" / "SystemStructure.ssd", folder),
    ("examples/README", "latsch simulate super"): lambda folder: shutil.copytree(ROOT / "examples" / "solid-tire", folder, dirs_exist_ok=True),
}
# Libraries that are made of a copy of the template, by page.
LIBRARIES = {"examples/README": "two_masses_library", "fmu-template/README": "template_library"}


def all_blocks():
    for page in PAGES:
        for number, block in enumerate(blocks(page)):
            if not block[0].startswith(tuple(ELSEWHERE)):
                yield pytest.param(page, block, id=f"{page}-{number}")


@pytest.mark.parametrize("page, block", list(all_blocks()))
def test_a_block_of_commands_runs(page, block, tmp_path, request):
    for (where, first), prepare in BEFORE.items():
        if where == page and block[0].startswith(first):
            prepare(tmp_path)
    if "target/release/liblatsch_fmu.so" in block[0]:
        (tmp_path / "target" / "release").mkdir(parents=True)
        shutil.copy(request.getfixturevalue(LIBRARIES[page]), tmp_path / "target" / "release" / "liblatsch_fmu.so")
    tools = tmp_path / "tools"
    tools.mkdir()
    (tools / "latsch").symlink_to(PROGRAM)
    script = "set -e\n" + "\n".join(lines_of(block))
    environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}")
    ran = subprocess.run(["bash", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=PATIENCE)
    assert ran.returncode == 0, f"{script}\n{ran.stdout}\n{ran.stderr}"
    # what is written is where the command says
    for name in re.findall(r"(?:--output|--report|--table|-o) (\S+)", "\n".join(block)):
        inside = "examples/car-abs-stop" if block[0].startswith("cd ") else "."
        assert "$" in name or (tmp_path / inside / name).exists(), name
