"""Tire property files: what the models make of them, and that nothing of a file is lost."""

import fmpy
import pytest

from conftest import Slave, latsch

# lengths in mm and forces in kN; comments, a key that nobody knows, and a line end of another system
TIRE = """[MDI_HEADER]
FILE_TYPE = 'tir'
$------------------------------------------------------------------units
[UNITS]
LENGTH = 'mm'
FORCE = 'kN'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'second'
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'
FITTYP = 6   $ of 5.2
TYRESIDE = 'LEFT'
[DIMENSION]
UNLOADED_RADIUS = 310.0
[VERTICAL]
VERTICAL_STIFFNESS = 0.2  ! kN/mm
FNOMIN = 4.0
OF_OUR_OWN = 17
[LONG_SLIP_RANGE]
KPUMIN = -1.0
KPUMAX = 1.0
[SLIP_ANGLE_RANGE]
ALPMIN = -60.0
ALPMAX = 60.0
[SCALING_COEFFICIENTS]
LMUY = 0.9
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1.6
PDX1 = 1.2
PKX1 = 20.0
[LATERAL_COEFFICIENTS]
PCY1 = 1.3
PDY1 = 1.0
PKY1 = -15.0
PKY2 = 2.0
""".replace("PDX1 = 1.2\n", "PDX1 = 1.2\t\r\n")


@pytest.fixture
def tire(tmp_path):
    path = tmp_path / "some tire.tir"
    path.write_bytes(TIRE.encode())
    return path


@pytest.mark.quick
def test_a_tire_property_file_is_no_parameters(tire, tmp_path):
    done = latsch("simulate", "magic-formula-flat-track", "--parameters", tire, "--output", tmp_path / "x.csv")
    assert done.returncode == 2 and not (tmp_path / "x.csv").exists()
    assert f"latsch tire {tire} --output F.toml" in done.stderr and "--tire" in done.stderr, done.stderr


@pytest.mark.quick
def test_a_tire_property_file_becomes_an_fmu(tire, tmp_path):
    fmu = tmp_path / "tire.fmu"
    done = latsch("export", "magic-formula-flat-track", "--tire", tire, "-o", fmu)
    assert done.returncode == 0, done.stderr
    assert "OF_OUR_OWN" in done.stderr and "left side" in done.stderr and "RBX1" in done.stderr
    start = {v.name: v.start for v in fmpy.read_model_description(str(fmu)).modelVariables}
    for name, value in dict(UNLOADED_RADIUS=0.31, FNOMIN=4000, VERTICAL_STIFFNESS=2e5, LMUY=0.9, PKY1=-15, QDZ1=0).items():
        assert float(start[name]) == pytest.approx(value, rel=1e-14), name
    assert float(start["ALPMAX"]) == pytest.approx(1.0471975511965976, rel=1e-14)
    assert start["tire_name"] == "some tire.tir"
    with_fmu(fmu)


def with_fmu(fmu):
    slave = Slave(fmu)
    # 20 mm at 200 N/mm carry the nominal load; a small slip angle makes 15 Fz0 sin(2 atan(1/2)) of force
    slave.begin(dict(deflection=0.02, slip_angle=1e-5, path_speed=20.0))
    load, side = slave.get("force_z", "force_y")
    assert load == pytest.approx(4000.0, rel=1e-12)
    assert side == pytest.approx(-15 * 4000 * 0.8 * 1e-5, rel=1e-4)
    slave.close()


@pytest.mark.quick
def test_other_values_change_nothing_else_of_the_file(tire, tmp_path):
    values, out = tmp_path / "fitted.toml", tmp_path / "fitted.tir"
    values.write_text("[parameters]\nLMUY = 0.75\nVERTICAL_STIFFNESS = \"210 N/mm\"\nactuator_frequency = 100\n")
    done = latsch("tire", tire, "--parameters", values, "-o", out)
    assert done.returncode == 0 and "2 values differ" in done.stdout, done.stderr
    before, after = tire.read_bytes().splitlines(), out.read_bytes().splitlines()
    assert [(a, b) for a, b in zip(before, after, strict=True) if a != b] == [
        (b"VERTICAL_STIFFNESS = 0.2  ! kN/mm", b"VERTICAL_STIFFNESS = 0.21  ! kN/mm"),
        (b"LMUY = 0.9", b"LMUY = 0.75"),
    ]
    # without values it is the file itself
    again = tmp_path / "again.tir"
    assert latsch("tire", tire, "-o", again).returncode == 0
    assert again.read_bytes() == tire.read_bytes()
    # and as parameters of a model it is what the export takes
    toml = tmp_path / "tire.toml"
    assert latsch("tire", tire, "-o", toml).returncode == 0
    one, other = tmp_path / "one.fmu", tmp_path / "other.fmu"
    assert latsch("export", "magic-formula-wheel", "--tire", tire, "-o", one).returncode == 0
    assert latsch("export", "magic-formula-wheel", "--parameters", toml, "-o", other).returncode == 0
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.quick
@pytest.mark.parametrize(
    "old, new, words",
    [
        ("FITTYP = 6 ", "FITTYP = 62 ", [":12", "62"]),
        ("LENGTH = 'mm'", "LENGTH = 'parsec'", [":5", "parsec"]),
        ("PDX1 = 1.2", "PDX1 = much", ["PDX1", "much"]),
        ("PKY1 = -15.0", "PKY1 = 15.0", ["PKY1", "less than 0"]),
        ("PCX1 = 1.6\n", "", ["PCX1", "missing"]),
        ("LMUY = 0.9", "LMUY = 0.9\nLMUY = 0.8", ["LMUY"]),
    ],
)
def test_what_is_wrong_in_a_file_is_named_with_its_place(tire, tmp_path, old, new, words):
    assert old in TIRE
    tire.write_text(TIRE.replace(old, new))
    done = latsch("export", "magic-formula-wheel", "--tire", tire, "-o", tmp_path / "x.fmu")
    assert done.returncode == 2 and not (tmp_path / "x.fmu").exists()
    assert all(word in done.stderr for word in ["some tire.tir", *words]), done.stderr


@pytest.mark.quick
def test_a_tire_property_file_is_for_models_with_that_tire(tire, tmp_path):
    done = latsch("export", "ring-brush-wheel", "--tire", tire, "-o", tmp_path / "x.fmu")
    assert done.returncode == 2 and "some tire.tir" in done.stderr and "ring-brush-wheel" in done.stderr
