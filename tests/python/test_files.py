"""Files of roads and of the super-elastic tire: what models make of them, and what other programs make of ours."""

import fmpy
import numpy as np
import pyopencrg
import pytest

from conftest import latsch, read_results

TIRE = """[MDI_HEADER]
FILE_TYPE = 'tir'
[UNITS]
LENGTH = 'mm'
FORCE = 'newton'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'sec'
[MODEL]
PROPERTY_FILE_FORMAT = 'USER'
FUNCTION_NAME = 'TYR501'
[DIMENSION]
UNLOADED_RADIUS = 226.5
WEIGHT = 26.1
[RIM]
WEIGHT_RIM = 6.3
[CONTACTELEMENT]
NUM_CE = 45
LEN_CE = 5
ANG_INSIDE_CE = 1
[PARAMETER]
RADIAL_NONLINEAR = 'yes'
RADIAL_STIFFNESS = 130
RADIAL_DAMPING = 0.28
ROLLING_RESISTANCE = 0.010
COR_FACTOR_RSTIFF = 2.1
CSLIP = 5
UMIN = 0.85
UMAX = 0.94
REL_LEN_LON = 10
OF_OUR_OWN = 17
[CONTACT_COEFFICIENTS]
STIFFNESS = 35000.0
DAMPING = 0.7
MU = 0.9
PENETRATION = 0.1
EXPONENT = 1.9
"""

ROAD = """[UNITS]
LENGTH='mm'
FORCE='newton'
ANGLE='degree'
MASS='kg'
TIME='sec'
[MODEL]
METHOD='USER'
ROAD_TYPE='poly'
[PROFILE]
{XZ}
-80000 0.0 0.0
500 0.0 0.0
550 0.0 5.0
700 5.0
750 0.0 0.0
80000 0.0 0.0
"""

PARAMETERS = """[parameters]
element_radial_stiffness = "130 N/mm"
rolling_resistance = 0.01
tire_width = 0.152
road_kind = "profile"
road_start = 0.0
road_profile = "0.5 0; 0.55 0.005; 0.7 0.005; 0.75 0"
"""


def simulate(tmp_path, *arguments):
    out = tmp_path / "out.csv"
    done = latsch("simulate", "super-elastic-wheel", "--stop", "0.2", "-o", out, *arguments)
    assert done.returncode == 0, done.stderr
    return read_results(out), done.stderr


@pytest.mark.quick
def test_a_tire_and_a_road_from_files_are_those_parameters(tmp_path):
    tire, road, parameters = tmp_path / "se.tir", tmp_path / "cleat.rdf", tmp_path / "p.toml"
    tire.write_text(TIRE)
    road.write_text(ROAD)
    parameters.write_text(PARAMETERS)
    files, said = simulate(tmp_path, "--tire", tire, "--road", road, "--set", "initial_speed=4")
    for word in ("OF_OUR_OWN", "COR_FACTOR_RSTIFF = 2.1", "CSLIP = 5 is taken as kN"):
        assert word in said
    values, _ = simulate(tmp_path, "--parameters", parameters, "--set", "initial_speed=4")
    assert set(files) == set(values)
    for name, expected in values.items():
        np.testing.assert_allclose(files[name], expected, rtol=0, atol=1e-7 * max(1.0, np.ptp(expected)), err_msg=name)
    # the cleat is met
    assert np.ptp(files["tire_deflection"]) > 3e-3
    # what is said explicitly goes over the files
    level, _ = simulate(tmp_path, "--tire", tire, "--road", road, "--set", "road_kind=flat", "--set", "initial_speed=4")
    assert np.ptp(level["tire_deflection"]) < 1e-3
    other, said = simulate(tmp_path, "--parameters", parameters, "--road", tmp_path / "cleat.rdf", "--set", "initial_speed=4")
    assert "road_kind of its own" in said and other == values


@pytest.mark.quick
def test_a_tire_goes_on_models_of_its_kind_only(tmp_path):
    tire = tmp_path / "se.tir"
    tire.write_text(TIRE)
    for command in ("simulate", "export"):
        done = latsch(command, "magic-formula-wheel", "--tire", tire, "-o", tmp_path / "x.fmu")
        assert done.returncode == 2
        assert all(word in done.stderr for word in ("se.tir", "super-elastic tire", "magic-formula-wheel", "super-elastic-")), done.stderr
    fmu = tmp_path / "se.fmu"
    assert latsch("export", "super-elastic-wheel", "--tire", tire, "-o", fmu).returncode == 0
    assert start_of(fmu, "element_radial_stiffness") == "130000.0" and start_of(fmu, "road_profile") == ""
    # an FMU has its tire, and takes a road
    assert latsch("simulate", fmu, "--tire", tire, "-o", tmp_path / "x.csv").returncode == 2
    road = tmp_path / "cleat.rdf"
    road.write_text(ROAD)
    done = latsch("simulate", fmu, "--road", road, "--set", "initial_speed=4", "--stop", "0.2", "-o", tmp_path / "x.csv")
    assert done.returncode == 0, done.stderr
    assert np.ptp(read_results(tmp_path / "x.csv")["tire_deflection"]) > 3e-3
    # or has the road inside
    assert latsch("export", "super-elastic-wheel", "--tire", tire, "--road", road, "-o", fmu).returncode == 0
    assert start_of(fmu, "road_profile") == "-80 0; 0.5 0; 0.55 0.005; 0.7 0.005; 0.75 0; 80 0"


def start_of(fmu, name):
    return {v.name: v.start for v in fmpy.read_model_description(str(fmu)).modelVariables}[name]


@pytest.mark.quick
def test_a_tire_goes_to_parameters_and_back(tmp_path):
    tire, one, back, two = (tmp_path / name for name in ("se.tir", "one.toml", "back.tir", "two.toml"))
    tire.write_text(TIRE)
    for source, target in ((tire, one), (one, back), (back, two)):
        done = latsch("convert", source, target)
        assert done.returncode == 0 and "what does not survive" in done.stdout, done.stderr
    assert "WEIGHT_RIM" in latsch("convert", one, back).stdout
    lines = [[line for line in file.read_text().splitlines() if "tire_name" not in line] for file in (one, two)]
    # the default width is written, too
    assert set(lines[0]) <= set(lines[1]) and len(lines[1]) == len(lines[0]) + 2


@pytest.mark.quick
def test_other_values_change_nothing_else_of_the_tire(tmp_path):
    tire, values, out = tmp_path / "se.tir", tmp_path / "p.toml", tmp_path / "new.tir"
    tire.write_text(TIRE)
    values.write_text('[parameters]\nelement_radial_stiffness = "151.105 N/mm"\nfriction_force = 5.0\n')
    done = latsch("tire", tire, "--parameters", values, "-o", out)
    assert done.returncode == 0 and "friction_force = 5" in done.stderr, done.stderr
    assert out.read_text() == TIRE.replace("RADIAL_STIFFNESS = 130", "RADIAL_STIFFNESS = 151.105")


def grid():
    u = np.arange(41) * 0.25
    v = np.array([-1.5, -0.5, 0.25, 1.5])
    z = 0.02 * np.sin(u)[:, None] * np.cos(2 * v)[None, :] + 0.01 * v[None, :]
    return u, v, z


@pytest.mark.quick
@pytest.mark.parametrize("form", ["KRBI", "KDBI", "LRFI", "LDFI"])
def test_opencrg_is_read_as_another_reader_reads_it(tmp_path, form):
    u, v, z = grid()
    z[7, 3] = z[20, 0] = np.nan
    slope, bank = 0.01 * np.sin(np.arange(40)), 0.02 * np.cos(u)
    road = pyopencrg.CrgRoad(z, u_inc=0.25, v=v, u_start=3.0, slope=slope, banking=bank, z_start=0.125)
    file, out = tmp_path / "r.crg", tmp_path / "r.csv"
    road.save(file, fmt=form)
    lanes = (1.25, -1.375)
    done = latsch("convert", file, out, "--left", lanes[0], "--right", lanes[1])
    assert done.returncode == 0, done.stderr
    assert "NaN" in done.stderr and "banking" in done.stdout
    x, left, right = np.loadtxt(out, delimiter=",", skiprows=1).T
    np.testing.assert_allclose(x, u, atol=1e-12)
    other = pyopencrg.read(file, check=False)
    filled = other.fill_nan()
    other = other if filled is None else filled
    for lane, heights in zip(lanes, (left, right)):
        np.testing.assert_allclose(heights, other.uv_to_z(u + 3.0, np.full_like(u, lane)), rtol=0, atol=1e-12)


@pytest.mark.quick
def test_opencrg_that_is_written_is_read_by_another_reader(tmp_path):
    road, out = tmp_path / "cleat.rdf", tmp_path / "cleat.crg"
    road.write_text(ROAD.replace("80000", "8000"))
    done = latsch("convert", road, out, "--increment", "0.05")
    assert done.returncode == 0, done.stderr
    assert "does not survive" not in done.stdout or "points between" not in done.stdout
    other = pyopencrg.read(out, check="strict")
    places = np.arange(-160, 161) * 0.05
    expected = np.interp(places, [0.5, 0.55, 0.7, 0.75], [0, 0.005, 0.005, 0])
    np.testing.assert_allclose(other.uv_to_z(places, np.zeros_like(places)), expected, rtol=0, atol=1e-12)
    # a coarser step is off, and that is said
    done = latsch("convert", road, tmp_path / "coarse.crg", "--increment", "0.2")
    assert "off by up to" in done.stdout, done.stdout


@pytest.mark.quick
def test_options_that_a_format_does_not_know_are_refused(tmp_path):
    tire, road, values = tmp_path / "se.tir", tmp_path / "cleat.rdf", tmp_path / "p.toml"
    tire.write_text(TIRE)
    road.write_text(ROAD)
    values.write_text("[parameters]\nelement_radial_stiffness = 1.5e5\nhub_mass = 200\n")
    for source, target, option, words in (
        (road, "x.csv", ("--adams",), ("--adams", ".rdf")),
        (road, "x.rdf", ("--increment", "0.1"), ("--increment", ".crg")),
        (road, "x.crg", ("--like", road), ("--like", ".rdf")),
        (road, "x.rdf", ("--like", tire), ("--like", "se.tir", ".rdf")),
        (tire, "x.toml", ("--adams",), ("--adams", "roads")),
        (tire, "x.toml", ("--like", tire), ("--like", "x.toml")),
        (values, "x.tir", ("--like", road), ("--like", "cleat.rdf", ".tir")),
    ):
        done = latsch("convert", source, tmp_path / target, *option)
        assert done.returncode == 2 and not (tmp_path / target).exists(), done.stdout
        assert all(word in done.stderr for word in words), done.stderr
    # names that are no parameter of the tire are listed, those of another tire refused
    done = latsch("convert", values, tmp_path / "x.tir", "--like", tire)
    assert done.returncode == 0 and "hub_mass" in done.stdout, done.stderr
    values.write_text("[parameters]\nPDX1 = 1.1\n")
    done = latsch("convert", values, tmp_path / "y.tir", "--like", tire)
    assert done.returncode == 2 and all(word in done.stderr for word in ("p.toml:2", "PDX1", "se.tir")), done.stderr
    # a file that is its own model survives as it is
    done = latsch("convert", road, tmp_path / "x.rdf", "--like", road)
    assert "everything survives" in done.stdout and (tmp_path / "x.rdf").read_bytes() == road.read_bytes(), done.stdout
