"""Sequential identification from the command line: the published benchmark, and checks of plans."""

import csv
import json
import tomllib

import fmpy
import numpy as np
import pytest

from conftest import ROOT, latsch

PLAN = ROOT / "examples" / "plans" / "magic-formula-flat-track.toml"


def test_the_published_benchmark():
    done = latsch("identify", "--benchmark", "kaden", "--format", "json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    rows = {row["name"]: row for row in answer["parameters"]}
    assert len(rows) == 15
    for name, row in rows.items():
        assert abs(row["relative_error"]) < 1e-6, name
        assert row["identified"] == pytest.approx(row["true"], rel=1e-6)
    assert rows["sidewall_radial_stiffness"]["published_relative_error"] == pytest.approx(4.62 / 4.67 - 1)
    # four digits of the springs' forces are as good as 10 % of the rim's spring
    assert 0.05 < rows["sidewall_radial_stiffness"]["rounding_bound"] < 0.2
    targets = {t["name"]: t for t in answer["targets"]}
    assert targets["contact force at 15 mm [N]"]["printed"] == 2736
    assert targets["contact force at 15 mm [N]"]["rounded"] == 2733


def test_a_plan_is_checked_on_a_model_and_on_its_fmu(tmp_path):
    done = latsch("plan", "check", PLAN, "--format", "json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    influence = dict(zip(report["targets"], report["influence"]))
    assert report["parameters"][0] == "VERTICAL_STIFFNESS"
    # only its own parameter and earlier ones
    assert [share > 0 for share in influence["vertical force at 20 mm [N]"]] == [True] + 6 * [False]
    assert influence["slip stiffness at 4000 N [N]"][1] > 0.5
    assert all(group["dependence"] is None for group in report["groups"])
    fmu = tmp_path / "tire.fmu"
    assert latsch("export", "magic-formula-flat-track", "--output", fmu).returncode == 0
    assert latsch("plan", "check", PLAN, "--model", fmu).stdout == latsch("plan", "check", PLAN).stdout


@pytest.mark.quick
def test_a_plan_has_a_page(tmp_path):
    page = tmp_path / "plan.html"
    done = latsch("plan", "check", PLAN, "--report", page)
    assert done.returncode == 0, done.stderr
    assert "Next group" in done.stdout and "group 2 -> PKX1: passes (evidence)" in done.stdout
    html = page.read_text()
    drawing = html.split("<svg", 1)[1].split("</svg>")[0]
    # a frame for each group, and a cell for each influence: four of one, one of two, and what comes from groups before
    assert drawing.count('stroke-width="2.2"/>') >= 5
    for cell in ("slip stiffness at 4000 N [N] over PKX1", "force turned hard at 4000 N [N] over PKY2"):
        assert f"<title>{cell}:" in drawing
    assert "slip stiffness at 4000 N [N] over PDY1" not in drawing
    for words in ("passes: evidence", "A counter-example is a proof", "Next group", "group 3", "margin"):
        assert words in html
    assert "http:" not in html.replace("http://www.w3.org/2000/svg", "")
    # a page in place of the plan would be a loss
    own = tmp_path / "own.toml"
    own.write_text(PLAN.read_text())
    done = latsch("plan", "check", own, "--report", own)
    assert done.returncode == 2 and "would overwrite" in done.stderr and own.read_text() == PLAN.read_text()


def test_a_refuted_plan_has_its_proof_on_the_page(tmp_path):
    head, *groups = PLAN.read_text().split("[[group]]\n")
    wrong, page = tmp_path / "wrong.toml", tmp_path / "wrong.html"
    wrong.write_text("[[group]]\n".join([head, groups[0], groups[2], groups[1], *groups[3:]]))
    assert latsch("plan", "check", wrong, "--report", page).returncode == 1
    html = page.read_text()
    assert "refuted: proof" in html and "differ in later parameters only. Proof:" in html and 'class="number differs"' in html


def test_a_plan_in_the_wrong_order_is_refuted(tmp_path):
    # the peak before the slip stiffness, on which the force there depends
    head, *groups = PLAN.read_text().split("[[group]]\n")
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("[[group]]\n".join([head, groups[0], groups[2], groups[1], *groups[3:]]))
    done = latsch("plan", "check", wrong)
    assert done.returncode == 1, done.stderr
    assert 'NOT independent (proof): "force' in done.stdout


def test_one_answer_is_refuted_by_two_points(tmp_path):
    # sine of a slip angle far beyond the peak: a force that two factors give
    text = PLAN.read_text().replace('name = "PCX1", bounds = [1.2, 1.95]', 'name = "PCX1", bounds = [1.2, 6.0]')
    wide = tmp_path / "wide.toml"
    wide.write_text(text)
    done = latsch("plan", "check", wide)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "NOT unique (proof): the same targets at" in done.stdout


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('read = "force_x"', 'read = "force_q"', ["group", "force_q", "did you mean"]),
        ('condition = "pressed in by 20 mm"', 'condition = "pressed"', ["vertical force at 20 mm", 'no condition "pressed"']),
        ('{ name = "PKX1", bounds = [15.0, 50.0] }', "", ["1 targets for 0 parameters"]),
        ('name = "PKX1", bounds', 'name = "PKX1", limits', ["limits", "line"]),
        ('by = "deflection"', 'by = "force_y"', ["force_y", "no parameter and no input"]),
        ("bounds = [15.0, 50.0]", "bounds = [50.0, 15.0]", ["50", "no range"]),
        ("bounds = [15.0, 50.0]", "bounds = [15.0, nan]", ["PKX1", "no range"]),
        ("falls = [[0, -1], [0, 0]]", "falls = [[0, 2], [0, 0]]", ["nesting", "above the diagonal"]),
        ("rises = [1, -1]", "rises = [1]", ["nesting", "2 signs in rises"]),
        ('name = "PKX1"', 'name = "PDX1"', ["PDX1", "twice"]),
        ("[N/rad]\"\ncondition = \"rolling straight at 2000 N\"", "[N/rad]\"\ncondition = \"rolling straight at 200 N\"", ["did you mean", "2000 N"]),
        ("cornering stiffness at 2000 N [N/rad]", "force turned hard at 4000 N [N]", ["twice", '"cornering stiffness and its load"', '"lateral peak"']),
        ("value = 2000.0", "value = 2e6", ["not reached", "force_z", "by deflection"]),
    ],
)
def test_a_plan_that_cannot_be_followed_says_where(tmp_path, old, new, words):
    text = PLAN.read_text()
    assert old in text
    plan = tmp_path / "plan.toml"
    plan.write_text(text.replace(old, new))
    done = latsch("plan", "check", plan)
    assert done.returncode in (1, 2) and done.stdout == ""
    for word in words:
        assert word in done.stderr, done.stderr


def test_from_programme_to_parameters(tmp_path):
    """The four steps of the README with the model in place of the rig, of one run less than the programme has."""
    programme, recordings = tmp_path / "programme", tmp_path / "recordings"
    assert latsch("rig-program", "ring-brush-flat-track", "--output", programme).returncode == 0
    runs = sorted(programme.glob("*.csv"))
    assert len(runs) == 9 and "small-motions-at-5000-N" in (programme / "programme.md").read_text()
    next(run for run in runs if "driven" in run.name).unlink()
    call = ["ring-brush-flat-track", "--inputs", programme, "--set", "vertical_stiffness=165 N/mm", "--step", "0.005"]
    done = latsch("simulate", *call, "--noise", "0.01", "--output", recordings)
    assert done.returncode == 0, done.stderr
    assert len(list(recordings.iterdir())) == 8 and "8 runs" in done.stdout
    again = tmp_path / "again"
    assert latsch("simulate", *call, "--noise", "0.01", "--seed", "2", "--output", again).returncode == 0
    first, second = (column(folder / "01-off-the-road-at-the-beginning.csv", "force_z [N]") for folder in (recordings, again))
    # 1 % of about 9 kN, about a tire that hangs free
    assert 60 < np.std(first) < 130 and 0 < abs(np.corrcoef(first, second)[0, 1]) < 0.2
    tire = tmp_path / "tire.toml"
    call = ["ring-brush-flat-track", "--recordings", recordings, "--output", tire]
    done = latsch("identify", *call, "--format", "json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    rows = {row["name"]: row for row in answer["parameters"]}
    stiffness = rows["vertical_stiffness"]
    assert stiffness["value"] == pytest.approx(165e3, abs=2 * stiffness["half_width"]) and stiffness["light"] == "green"
    assert rows["patch_compliance_x"]["light"] == "red" and "driven" in rows["patch_compliance_x"]["why"]
    done = latsch("export", "ring-brush-flat-track", "--parameters", tire, "--output", tmp_path / "tire.fmu")
    assert done.returncode == 0, done.stderr
    start = {v.name: v.start for v in fmpy.read_model_description(tmp_path / "tire.fmu").modelVariables}
    assert float(start["vertical_stiffness"]) == pytest.approx(answer["values"]["vertical_stiffness"], rel=1e-12)


def test_an_fmu_in_place_of_the_plans_model(tmp_path):
    """The springs alone, of the model and of its FMU; a file of parameters has units."""
    programme, recordings = tmp_path / "programme", tmp_path / "recordings"
    assert latsch("rig-program", "ring-brush-flat-track", "--output", programme).returncode == 0
    for run in [*programme.glob("0[3-9]*.csv"), *programme.glob("0[3-9]*.toml")]:
        run.unlink()
    truth = ["--set", "vertical_stiffness=165 N/mm"]
    call = ["ring-brush-flat-track", "--inputs", programme, "--output", recordings, "--step", "0.01", "--noise", "0.001", *truth]
    assert latsch("simulate", *call).returncode == 0
    fmu, known = tmp_path / "tire.fmu", tmp_path / "known.toml"
    assert latsch("export", "ring-brush-flat-track", "--output", fmu).returncode == 0
    known.write_text('[parameters]\nvertical_stiffness = "150 N/mm"\n')
    told = []
    for more in [[], ["--model", fmu]]:
        call = ["ring-brush-flat-track", "--recordings", recordings, "--output", tmp_path / "tire.toml", "--parameters", known, *more]
        done = latsch("identify", *call, "--format", "json")
        assert done.returncode == 0, done.stderr
        told.append({row["name"]: row for row in json.loads(done.stdout)["parameters"]})
    # forces along and across are 0 here but for rounding, which neither contradicts the model nor moves
    assert told[0]["vertical_stiffness"]["light"] == "green" and "come to rest" not in done.stdout
    for name, own in told[0].items():
        assert told[1][name]["value"] == pytest.approx(own["value"], rel=1e-6), name
    row = told[0]["vertical_stiffness"]
    assert row["value"] == pytest.approx(165e3, abs=2 * row["half_width"]) and row["half_width"] < 0.1 * row["value"]
    assert told[0]["bristle_stiffness"]["light"] == "red"
    # what the diagnosis may change: what is known within its interval, the rest freely
    written = tomllib.loads((tmp_path / "tire.toml").read_text())
    assert written["fit"]["vertical_stiffness"]["min"] == pytest.approx(row["value"] - 2 * row["half_width"], rel=1e-6)
    assert written["fit"]["bristle_stiffness"] is True
    known.write_text('[parameters]\nvertical_stiffness = "150 N/m2"\n')
    done = latsch("identify", *call)
    assert done.returncode == 2 and "known.toml" in done.stderr and "vertical_stiffness" in done.stderr, done.stderr


def column(file, name):
    with open(file, encoding="utf-8") as lines:
        return np.array([float(row[name]) for row in csv.DictReader(lines)])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (["--noise", "1"], ["--noise", "0.01 for 1 %"]),
        (["--report", "page.html"], ["--report", "one run"]),
        (["--set", "load_control=false"], ["load_control", "--set", "a.toml"]),
    ],
)
def test_a_folder_that_is_not_run_says_why(tmp_path, call, words):
    folder = tmp_path / "programme"
    folder.mkdir()
    (folder / "a.csv").write_text("time [s],load [N],path_speed [m/s]\n0,3000,10\n0.1,3000,10\n")
    (folder / "a.toml").write_text("[parameters]\nload_control = true\n")
    call = ["simulate", "ring-brush-flat-track", "--inputs", folder, "--output", tmp_path / "recordings", *call]
    done = latsch(*call)
    assert done.returncode == 2 and not list((tmp_path / "recordings").glob("*")), done.stdout
    for word in words:
        assert word in done.stderr, done.stderr


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({}, ["no recordings", ".csv"]),
        ({"a.csv": "time [s],deflection [m]\n0,0\n1,0\n"}, ["a.csv", "no channel", "force_"]),
        ({"a.csv": "time [s],force_x [N]\n0,0\n0,0\n"}, ["a.csv:3", "time"]),
        ({"a.csv": "time [s],force_x [N]\n0,nan\n1,0\n"}, ["a.csv:2"]),
        ({"a.csv": "time [s],force_x [m],force_y [N],force_z [N],moment_z [N.m]\n0,0,0,0,0\n1,0,0,0,0\n"}, ["a.csv", "force_x", "dimension"]),
    ],
)
def test_recordings_that_cannot_be_read_are_named(tmp_path, files, words):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    done = latsch("identify", "ring-brush-flat-track", "--recordings", tmp_path, "--output", tmp_path / "tire.toml")
    assert done.returncode == 2 and not (tmp_path / "tire.toml").exists(), done.stdout + done.stderr
    for word in words:
        assert word in done.stderr, done.stderr


TYDEX = """\
**HEADER
RELEASE   Release of TYDEX-Format                 1.3
**CONSTANTS
INCLANGL  inclination angle             deg       2
**MEASURCHANNELS
RUNTIME   running time                  s         1         0         0
TRAJVELW  trajectory velocity           km/h      1         0         0
TYREDEFW  tyre deflection               mm        10        0         0
SLIPANGL  slip angle                    deg       1         0         0
**MEASURDATA
0         60        2         0
0.1       60        2         0
0.2       60        2         2
**END
"""


@pytest.mark.quick
def test_tydex_files_are_recordings(tmp_path):
    recordings = tmp_path / "recordings"
    recordings.mkdir()
    (tmp_path / "in.TDX").write_text(TYDEX)
    head = "time [s],path_speed [km/h],deflection [mm],slip_angle [deg],camber [deg]\n"
    (tmp_path / "in.csv").write_text(head + "0,60,20,0,2\n0.1,60,20,0,2\n0.2,60,20,2,2\n")
    written = {}
    for inputs, output in [("in.csv", "a.csv"), ("in.TDX", "b.csv"), ("in.csv", "recordings/c.tdx"), ("recordings/c.tdx", "d.csv")]:
        call = ["ring-brush-flat-track", "--inputs", tmp_path / inputs, "--step", "0.01", "--output", tmp_path / output]
        done = latsch("simulate", *call)
        assert done.returncode == 0, done.stderr
        written[output] = (tmp_path / output).read_text()
    assert written["a.csv"] == written["b.csv"] == written["d.csv"]
    assert written["recordings/c.tdx"].startswith("**HEADER\n")
    # a force of other axes is none that a rig measures
    (recordings / "c.tdx").write_text(written["recordings/c.tdx"].replace("\nFZH", "\nFZW"))
    done = latsch("identify", "ring-brush-flat-track", "--recordings", recordings, "--output", tmp_path / "tire.toml")
    assert done.returncode == 2, done.stdout
    assert 'c.tdx: there is no channel "force_z"' in done.stderr and "fzw" in done.stderr, done.stderr


def test_a_shipped_plan_is_shown_as_it_is_read(tmp_path):
    shown = latsch("plan", "show", "ring-brush-flat-track")
    assert shown.returncode == 0 and tomllib.loads(shown.stdout)["model"] == "ring-brush-flat-track"
    (tmp_path / "own.toml").write_text(shown.stdout)
    for plan, folder in (("ring-brush-flat-track", "shipped"), (tmp_path / "own.toml", "own")):
        assert latsch("rig-program", plan, "--output", tmp_path / folder).returncode == 0
    runs = sorted(file.name for file in (tmp_path / "shipped").glob("*.csv"))
    assert len(runs) == 9 and all((tmp_path / "own" / run).read_bytes() == (tmp_path / "shipped" / run).read_bytes() for run in runs)
    unknown = latsch("plan", "show", "ring-brush-flat-trak")
    assert unknown.returncode == 2 and "there is ring-brush-flat-track" in unknown.stderr


def test_the_passenger_cars_tire_is_what_the_published_curves_give(tmp_path):
    """As docs/identify.md tells: the curves on the rig, the nearest ring-and-brush tire, its own curves against them."""
    tires, plan = ROOT / "examples" / "tires", ROOT / "examples" / "plans" / "ring-brush-passenger-car.toml"
    programme, recordings, known, found = (tmp_path / name for name in ("programme", "recordings", "known.toml", "tire.toml"))
    shipped = tomllib.loads((tires / "ring-brush-205-60-r15.toml").read_text())["parameters"]
    before = [
        "tire_radius", "tire_width", "rolling_radius", "belt_mass", "belt_inertia_polar", "belt_inertia_diametral",
        "rolling_resistance_lever", "sidewall_tilt_stiffness",
    ]
    known.write_text("[parameters]\n" + "".join(f"{name} = {shipped[name]}\n" for name in before))
    assert latsch("rig-program", plan, "--output", programme).returncode == 0
    even = "LMUX=0.82 LHX=0 LHY=0 LVX=0 LVY=0 LRES=0 PEY3=0 QHZ1=0 QHZ2=0 QEZ4=0".split()
    curves = ["--parameters", tires / "205-60-r15.toml", *(part for value in even for part in ("--set", value))]
    call = ["magic-formula-flat-track", "--inputs", programme, "--output", recordings, "--noise", "0.003", *curves]
    assert latsch("simulate", *call).returncode == 0
    call = [plan, "--recordings", recordings, "--parameters", known, "--output", found, "--format", "json"]
    done = latsch("identify", *call, "--nearest")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    for row in answer["parameters"]:
        if row["half_width"] is not None and row["name"] != "vertical_stiffness_quadratic":
            assert row["value"] == pytest.approx(shipped[row["name"]], rel=1e-3), row
    # no physical parameter is said to be below what it can be
    for name, value in tomllib.loads(found.read_text())["parameters"].items():
        assert not isinstance(value, dict) or 0 <= value["low"] <= value["value"] <= value["high"], name
    published = tomllib.loads((tires / "205-60-r15.toml").read_text())["parameters"]
    published |= {name: float(number) for name, number in (value.split("=") for value in even)}
    curves = tmp_path / "curves.toml"
    curves.write_text("[parameters]\n" + "".join(f"{name} = {json.dumps(value)}\n" for name, value in published.items()))
    call = [f"ring-brush@{found}", f"magic-formula@{curves}", "--loads", "4000", "--speeds", "60 km/h", "--output", tmp_path / "curves"]
    done = latsch("characterize", *call)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "curves" / "readings.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    read = {(row["tire"], row["reading"]): float(row["value"]) for row in rows if row["value"]}
    for reading, apart in (
        ("cornering_stiffness", 0.09), ("lateral_peak", 0.04), ("pneumatic_trail", 0.1), ("aligning_peak", 0.02), ("slip_stiffness", 0.07),
        ("braking_peak", 0.04), ("relaxation_length", 0.2),
    ):
        assert read["tire", reading] == pytest.approx(read["curves", reading], rel=apart), reading
    # the contact carries the belt's weight beside the load at the rim
    carried = 1 + shipped["belt_mass"] * 9.81 / 4000
    assert read["tire", "locked"] == pytest.approx(carried * read["curves", "locked"], rel=2e-3)
