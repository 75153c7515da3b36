"""The tire as a C function: a host in C that evaluates, throws away, repeats and commits."""

import csv
import subprocess

import numpy as np
import pytest

from conftest import ROOT, TARGET, latsch

ROAD = """[MDI_HEADER]
FILE_TYPE = 'rdf'
FILE_VERSION = 5.00
FILE_FORMAT = 'ASCII'
[UNITS]
LENGTH = 'mm'
FORCE = 'newton'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'sec'
[MODEL]
METHOD = 'USER'
FUNCTION_NAME = 'ARC501'
ROAD_TYPE = 'poly'
[PROFILE]
{XZ}
-80000 0.0 0.0
500 0.0 0.0
550 0.0 5.0
700 0.0 5.0
750 0.0 0.0
80000 0.0 0.0
"""


@pytest.fixture(scope="module")
def library():
    subprocess.run(["cargo", "build", "--quiet", "--locked", "--workspace"], cwd=ROOT, check=True)
    return TARGET / "debug"


def test_a_host_in_c_gets_what_a_rig_gets(library, tmp_path):
    parameters, tire, road = tmp_path / "tire.toml", tmp_path / "tire.tir", tmp_path / "cleat.rdf"
    parameters.write_text("[parameters]\nelement_radial_damping = 400\n")
    done = latsch("convert", parameters, tire)
    assert done.returncode == 0, done.stderr
    road.write_text(ROAD)
    host = tmp_path / "host"
    subprocess.run(
        [
            "cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I", ROOT / "tire-function/include",
            ROOT / "tests/data/tire_function.c", "-L", library, "-llatsch_tire", "-lm", f"-Wl,-rpath,{library}", "-o", host,
        ],
        check=True,
    )
    radius, deflection, speed = 0.2265, 0.012, 2.0
    height = radius - deflection
    spin = speed / ((2 * radius + height) / 3)
    done = subprocess.run(
        [host, tire, road, repr(speed), repr(height), repr(spin), "0.6"], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    rows = list(csv.reader(done.stdout.splitlines()))
    by_host = np.array(rows[1:], float)

    course = tmp_path / "rig.csv"
    done = latsch(
        "simulate", "super-elastic-flat-track", "--tire", tire, "--road", road, "--set", f"path_speed={speed}", "--set",
        f"deflection={deflection}", "--set", "command_actuators=0", "--step", 1e-3, "--stop", 0.6, "--output", course,
    )
    assert done.returncode == 0, done.stderr
    with course.open() as file:
        rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in rows[0]]
    by_rig = np.array(rows[1:], float)[:, [names.index(n) for n in ("time", "force_x", "force_z", "moment_y")]]
    assert by_rig.shape == by_host.shape
    load = by_rig[:, 2]
    assert load.max() > 1.3 * load[0], "the cleat is met"
    # the same steps and the same places, which the rig adds up and the host multiplies
    assert np.abs(by_host - by_rig).max() < 1e-6 * load.max()
