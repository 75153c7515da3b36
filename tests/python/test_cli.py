"""The command line as a user meets it: results, exit codes, messages that say where."""

import json
import os
import pty
import re
import shutil
import subprocess
import tomllib
import zipfile

import numpy as np
import pytest

from conftest import INPUTS, MODEL, MODELS, PROGRAM, ROOT, latsch, read_results, rewrite


@pytest.mark.quick
def test_models_and_describe():
    done = latsch("models")
    assert done.returncode == 0 and MODEL in done.stdout
    assert [m["name"] for m in json.loads(latsch("models", "--format", "json").stdout)] == list(MODELS)

    done = latsch("describe", MODEL)
    assert done.returncode == 0
    for words in ("slip_angle", "[rad]", "default 0.02, range -0.2 to 0.1", "c_GF quer", "Parameters"):
        assert words in done.stdout
    model = json.loads(latsch("describe", MODEL, "--format", "json").stdout)
    variables = {v["name"]: v for v in model["variables"]}
    assert [n for n, v in variables.items() if v["causality"] == "input"] == [*INPUTS, "friction_factor", "load"]
    assert variables["stripes"]["default"] == 6 and variables["stripes"]["max"] == 64


@pytest.mark.quick
def test_the_beginning_of_a_model_gets_a_list():
    done = latsch("describe", "ring-brush")
    assert done.returncode == 2 and MODEL in done.stderr and "magic" not in done.stderr


@pytest.mark.quick
def test_describe_shows_an_fmu_as_it_shows_its_model(shipped, tmp_path):
    model = shipped.stem

    def variables(text):
        return text[text.index("\nInputs\n"):]

    done = latsch("describe", shipped)
    assert done.returncode == 0, done.stderr
    assert variables(done.stdout) == variables(latsch("describe", model).stdout)
    head = done.stdout[: done.stdout.index("\nInputs\n")]
    for words in (f"{model}: ", "2.0 for co-simulation", "made by       latsch ", "linux64", "steps of changing length"):
        assert words in head
    # the same from the folder that it was unpacked to, and from the file in it
    with zipfile.ZipFile(shipped) as archive:
        archive.extractall(tmp_path)
    for place in (tmp_path, tmp_path / "modelDescription.xml"):
        assert latsch("describe", place).stdout == done.stdout
    known = json.loads(latsch("describe", shipped, "--format", "json").stdout)
    fmu = known.pop("fmu")
    assert known == json.loads(latsch("describe", model, "--format", "json").stdout)
    assert fmu["platforms"] == ["linux64"] and fmu["capabilities"]["canGetAndSetFMUstate"] is True


@pytest.mark.quick
def test_describe_refuses_what_is_no_fmu(tmp_path):
    empty = tmp_path / "empty.fmu"
    with zipfile.ZipFile(empty, "w") as archive:
        archive.writestr("readme.txt", "")
    (tmp_path / "text.fmu").write_text("no archive")
    for name, words in [
        (empty, "no modelDescription.xml"),
        (tmp_path / "text.fmu", "zip"),
        (tmp_path / "nothing.fmu", "No such file"),
        (tmp_path, "modelDescription.xml"),
    ]:
        done = latsch("describe", name)
        assert done.returncode == 2 and words in done.stderr and str(name) in done.stderr, done.stderr


@pytest.mark.quick
def test_export_finds_its_library_or_says_where_it_looked(fmu, tmp_path):
    """A program alone, as `cargo install` leaves it where it does not carry the library."""
    root = tmp_path / "root"
    (root / "bin").mkdir(parents=True)
    program = shutil.copy(PROGRAM, root / "bin")
    library = PROGRAM.parent / "liblatsch_fmu.so"
    output = tmp_path / "tire.fmu"

    def export(**environment):
        output.unlink(missing_ok=True)
        return subprocess.run([program, "export", MODEL, "--output", output], capture_output=True, text=True,
                              env=dict(os.environ, **environment))

    done = export()
    assert done.returncode == 2 and not output.exists()
    assert f'cargo install --locked --path . --root {root}" makes a program that carries it' in done.stderr
    for place in (root / "bin", root):
        assert f"{place}/liblatsch_fmu.so: not there" in done.stderr
    # what is wrong with the call comes first
    done = subprocess.run([program, "export", "ring-brush"], capture_output=True, text=True)
    assert done.returncode == 2 and MODEL in done.stderr and "liblatsch" not in done.stderr
    assert export(LATSCH_LIBRARY=str(library)).returncode == 0
    assert output.read_bytes() == fmu.read_bytes()
    done = export(LATSCH_LIBRARY=str(tmp_path / "no.so"))
    assert done.returncode == 2 and "LATSCH_LIBRARY" in done.stderr and "no.so" in done.stderr
    # what does not fit does not stand in its way
    (root / "bin" / "liblatsch_fmu.so").write_text("no library")
    shutil.copy(library, root)
    done = export()
    assert done.returncode == 0, done.stderr
    assert output.read_bytes() == fmu.read_bytes()


def write(path, *lines):
    path.write_text("\n".join(lines) + "\n")
    return path


def simulate(tmp_path, inputs, *arguments):
    done = latsch("simulate", MODEL, "--inputs", inputs, "--output", tmp_path / "out.csv", *arguments)
    return done


def test_units_are_converted(tmp_path):
    inputs = write(
        tmp_path / "rig.csv",
        "time [ms],path_speed [km/h],slip_angle [deg],deflection [mm]",
        "0,54,0,20",
        "100,54,3,20",
    )
    done = simulate(tmp_path, inputs)
    assert done.returncode == 0, done.stderr
    results = read_results(tmp_path / "out.csv")
    assert results["time"][-1] == 0.1 and len(results["time"]) == 101
    assert results["path_speed"][50] == pytest.approx(15, rel=1e-12)
    assert results["slip_angle"][-1] == pytest.approx(0.0523598775598, rel=1e-9)
    assert results["force_y"][-1] < -500


CORNER = "ring-brush-corner"
ON_PROFILE = ["--set", "road_kind=profile", "--set", "road_start=5", "--set", "initial_speed=36 km/h"]


def drive(folder, *arguments):
    """The corner along a road for a second, with the wheel force by distance."""
    done = latsch("simulate", CORNER, *ON_PROFILE, *arguments, "--stop", "1", "--output", folder / "out.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    return {name: np.array(column) for name, column in read_results(folder / "out.csv").items()}


def test_a_road_from_a_file(tmp_path):
    """A ramp of 10 mm over half a metre, 5 m ahead, as a German spreadsheet writes it."""
    write(tmp_path / "ramp.csv", "x [cm];z [mm]", "0;0", "50;10", "300;10")
    results = drive(tmp_path, "--set", "road_profile=@ramp.csv")
    place, force, height = (results[name] for name in ("vehicle_distance", "force_z", "road_elevation"))
    # half the length of the filter before the ramp, the wheel knows nothing of it
    before, after = place < 4.85, place > 5.65
    assert before.sum() > 400 and np.abs(force[before] - force[0]).max() < 1e-3 * force[0]
    assert not height[before].any() and np.abs(height[after] - 0.01).max() < 1e-12
    # then it climbs: 20 mm per metre at 10 m/s are 0.2 m/s, which damper and tire answer, and is over
    first = place[np.argmax(np.abs(force - force[0]) > 50)]
    assert 4.9 < first < 5.1
    on = (place > 5) & (place < 5.6)
    assert force[on].max() > 1.1 * force[0]
    assert height[np.argmin(np.abs(place - 5.25))] == pytest.approx(0.005, abs=2e-4)
    # the same as its points on the command line, and where it is looked for does not matter
    text = "road_profile=0 0; 0.5 0.01; 3 0.01"
    for other in (text, f"road_profile=@{tmp_path / 'ramp.csv'}"):
        again = drive(tmp_path, "--set", other)
        assert all(np.array_equal(results[name], again[name]) for name in results)
    # in systems and tire files it is looked for beside them
    folder = tmp_path / "system"
    folder.mkdir()
    (tmp_path / "ramp.csv").rename(folder / "ramp.csv")
    values = 'road_kind = "profile", road_start = 5, initial_speed = 10, road_profile = "@ramp.csv"'
    write(folder / "s.toml", "stop = 1", "step = 1e-3", "[component.corner]", f'model = "{CORNER}"', f"set = {{ {values} }}")
    done = latsch("cosimulate", folder / "s.toml", "--output", tmp_path / "s.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert np.array_equal(read_results(tmp_path / "s.csv")["corner.force_z"], force)
    write(folder / "p.toml", "[parameters]", *values.split(", "))
    done = latsch("export", CORNER, "--parameters", folder / "p.toml", "--output", tmp_path / "corner.fmu", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = latsch("simulate", tmp_path / "corner.fmu", "--stop", "1", "--output", tmp_path / "f.csv")
    assert done.returncode == 0, done.stderr
    assert np.array_equal(read_results(tmp_path / "f.csv")["force_z"], force)


@pytest.mark.parametrize(
    "lines, words",
    [
        (["x [m],z [m]", "0,0", "1,high"], ["road.csv:3", "z", "high"]),
        (["x [m],z [m]", "0,0", "1,0", "0.5,0"], ["road.csv:4", "x", "must not decrease"]),
        (["x [m],z [m]", "0,0", "1"], ["road.csv:3"]),
        (["x [m],z [kg]", "0,0", "1,0"], ["road.csv", "kg"]),
        (["time [s],z [m]", "0,0", "1,0"], ["road.csv:1", "x [m]"]),
        (None, ["road.csv", "No such file"]),
    ],
)
def test_wrong_roads_from_files(tmp_path, lines, words):
    if lines:
        write(tmp_path / "road.csv", *lines)
    write(tmp_path / "s.toml", "stop = 1", "step = 1e-3", "[component.corner]", f'model = "{CORNER}"',
          'set = { road_kind = "profile", road_profile = "@road.csv" }')
    output = tmp_path / "out.csv"
    for arguments, place in (
        (["simulate", CORNER, *ON_PROFILE, "--set", "road_profile=@road.csv"], "--set road_profile"),
        (["cosimulate", "s.toml"], "s.toml:5"),
    ):
        done = latsch(*arguments, "--stop", "1", "--output", output, cwd=tmp_path)
        assert done.returncode == 2 and not output.exists()
        for word in (place, *words):
            assert word in done.stderr, done.stderr


@pytest.mark.parametrize(
    "lines, words",
    [
        (["time [s],slipp [1]", "0,0", "1,0"], ["rig.csv", "slipp", "did you mean", "slip"]),
        (["time [s],slip [m]", "0,0", "1,0"], ["rig.csv", "slip", '"m"', '"1"']),
        (["time [s],slip [furlong]", "0,0", "1,0"], ["rig.csv:1", "furlong"]),
        (["time [s],slip", "0,0", "1,0"], ["rig.csv:1", "slip", "[1]"]),
        (["time [s],slip [1]", "0,0", "1,x"], ["rig.csv:3", "slip", "x"]),
        (["time [s],slip [1]", "0,0", "0,0"], ["rig.csv:3", "time"]),
        (["time [s],slip [1]", "0,0", "1,nan"], ["rig.csv:3", "slip"]),
        (["time [s],slip [1],slip [1]", "0,0,0", "1,0,0"], ["rig.csv:1", "slip"]),
        (["time [s],deflection [mm]", "0,20", "1,500"], ["rig.csv", "deflection", "at 1 s", "range"]),
        (["time [s],belt_mass [kg]", "0,8", "1,8"], ["rig.csv", "belt_mass", "parameter"]),
    ],
)
def test_wrong_recordings(tmp_path, lines, words):
    done = simulate(tmp_path, write(tmp_path / "rig.csv", *lines))
    assert done.returncode == 2
    for word in words:
        assert word in done.stderr, done.stderr
    assert not (tmp_path / "out.csv").exists()


def test_files_as_german_spreadsheets_write_them(tmp_path):
    inputs = write(tmp_path / "rig.csv", "time [s];slip [%];temperature [degC]", "0;0,5;21,5", "0,1;1,5;21,6")
    done = simulate(tmp_path, inputs)
    assert done.returncode == 2 and "--ignore temperature" in done.stderr
    done = simulate(tmp_path, inputs, "--ignore", "temperature")
    assert done.returncode == 0, done.stderr
    assert read_results(tmp_path / "out.csv")["slip"][50] == pytest.approx(0.01, rel=1e-12)


def test_nothing_is_extrapolated(tmp_path):
    inputs = write(tmp_path / "rig.csv", "time [s],slip [1]", "0.1,0", "0.2,0.01")
    assert simulate(tmp_path, inputs).returncode == 0
    done = simulate(tmp_path, inputs, "--stop", "0.3")
    assert done.returncode == 2 and "0.3" in done.stderr and "0.2" in done.stderr


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--set", "slip"], ["NAME=VALUE"]),
        (["--set", "slip=fast"], ["slip", "fast", "number"]),
        (["--set", "slop=1"], ["did you mean", "slip"]),
        (["--set", "force_x=1"], ["force_x", "computed"]),
        (["--set", "deflection=3 kg"], ["deflection", "m"]),
        (["--set", "deflection=200 mm"], ["0.2 m", "range"]),
        (["--set", "stripes=2.5"], ["stripes", "whole number"]),
        (["--set", "even_stripes=maybe"], ["true or false"]),
        (["--step", "-1"], ["step"]),
        (["--start", "1", "--stop", "0"], ["stop time"]),
    ],
)
def test_wrong_arguments(tmp_path, arguments, words):
    done = latsch("simulate", MODEL, "--output", tmp_path / "out.csv", *arguments)
    assert done.returncode == 2
    for word in words:
        assert word in done.stderr, done.stderr


def test_a_model_that_gives_up_is_no_and_keeps_what_it_has(tmp_path):
    inputs = write(
        tmp_path / "rig.csv", "time [s],deflection [mm],camber [deg]", "0,20,0", "0.2,95,34"
    )
    done = simulate(tmp_path, inputs)
    assert done.returncode == 1
    assert "ring of bristles" in done.stderr and "out.csv" in done.stderr
    results = read_results(tmp_path / "out.csv")
    assert 0.05 < results["time"][-1] < 0.2


@pytest.mark.parametrize(
    "text, words",
    [
        ("[parameters]\nbelt_mas = 9.0\n", ["tire.toml:2", "belt_mas", "belt_mass"]),
        ("[parameters]\nbelt_mass = -1.0\n", ["tire.toml:2", "belt_mass", "range"]),
        ("[parameters]\nbelt_mass = true\n", ["tire.toml:2", "number"]),
        ('[parameters]\nbelt_mass = "9 N"\n', ["tire.toml:2", "belt_mass", '"kg"']),
        ("[parameters]\nrolling_radius = 0.5\n", ["tire.toml", "rolling_radius", "tire_radius"]),
        ("[parameters]\nslip = 0.1\n", ["tire.toml:2", "[inputs]"]),
        ("[parameter]\nbelt_mass = 9.0\n", ["tire.toml:1", "parameter"]),
        ("[parameters]\nbelt_mass = = 9\n", ["tire.toml:2"]),
        ('model = "bicycle"\n', ["bicycle", MODEL]),
    ],
)
def test_wrong_tire_files(tmp_path, text, words):
    path = tmp_path / "tire.toml"
    path.write_text(text)
    done = latsch("export", MODEL, "--parameters", path, "--output", tmp_path / "x.fmu")
    assert done.returncode == 2
    for word in words:
        assert word in done.stderr, done.stderr
    assert not (tmp_path / "x.fmu").exists()


def test_fmus_from_outside_are_not_trusted(fmu, tmp_path):
    def refused(path, *words):
        done = latsch("simulate", path, "--output", tmp_path / "out.csv")
        assert done.returncode == 2, done.stderr
        for word in words:
            assert word in done.stderr, done.stderr

    refused(write(tmp_path / "text.fmu", "no archive"), "text.fmu")
    refused(tmp_path / "absent.fmu", "absent.fmu")
    escaping = rewrite(fmu, tmp_path / "escape.fmu", lambda n, d: d)
    with zipfile.ZipFile(escaping, "a") as archive:
        archive.writestr("../escaped.txt", "out")
    refused(escaping, "../escaped.txt")
    assert not (tmp_path / "escaped.txt").exists()
    refused(rewrite(fmu, tmp_path / "bare.fmu", lambda n, d: None if n.startswith("bin") else d), "linux64")
    refused(rewrite(fmu, tmp_path / "mute.fmu", lambda n, d: None if n.endswith(".xml") else d),
            "modelDescription.xml")
    refused(rewrite(fmu, tmp_path / "cut.fmu", lambda n, d: d[: len(d) // 2] if n.endswith(".xml") else d),
            "modelDescription.xml")
    # resources that do not belong to the description: the binary itself refuses
    refused(rewrite(fmu, tmp_path / "mixed.fmu", lambda n, d: d.replace(b"8.8", b"9.9") if n.endswith(".toml") else d),
            "GUID")


def test_progress_shows_on_a_terminal_and_nowhere_else(tmp_path):
    arguments = ["simulate", MODEL, "--stop", "3", "--output", str(tmp_path / "out.csv")]
    done = latsch(*arguments)
    assert done.returncode == 0 and done.stderr == ""
    assert done.stdout.count("\n") == 1

    master, slave = pty.openpty()
    process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=slave)
    os.close(slave)
    shown = b""
    while True:
        try:
            piece = os.read(master, 4096)
        except OSError:
            break
        if not piece:
            break
        shown += piece
    assert process.wait() == 0
    os.close(master)
    assert b"%" in shown and b"left" in shown

    told = latsch(*arguments, "--progress", "json")
    assert told.returncode == 0 and told.stdout == done.stdout
    progress = [json.loads(line)["progress"] for line in told.stderr.splitlines()]
    assert len(progress) == 100 and progress == sorted(progress) and progress[-1] == 1
    assert latsch(*arguments, "--progress", "json", "--quiet").stderr == ""


def test_demo_makes_pages_that_need_nothing_else(demo):
    for page in ("index.html", "car/index.html", "flat-track/index.html"):
        text = (demo / page).read_text().replace('xmlns="http://www.w3.org/2000/svg"', "")
        for outside in ("src=", "@import", "url(", "http://", "https://", 'href="h'):
            assert outside not in text, f"{page}: {outside}"
    assert (demo / "index.html").stat().st_size < 4e6
    results = read_results(demo / "flat-track" / "results.csv")
    # a triangle of the slip angle at each of three loads, then slip: the tire answers with its limits
    assert 4500 < max(results["force_y"]) < 6000
    assert 3000 < max(results["force_x"]) < 4500
    assert min(results["force_z"]) > 1000


def stop_numbers(path):
    """Distance, time, longest lock, heat of patch and of brake, speed at the start, from the results of a stop."""
    r = {name.split(".", 1)[-1]: column for name, column in read_results(path).items() if not name.startswith("abs.")}
    start = max(k for k, p in enumerate(r["driver_pressure"]) if p == 0)
    end = next(k for k, v in enumerate(r["vehicle_speed"]) if k > start and v < 0.1)
    longest = since = 0.0
    for k in range(start + 1, end):
        locked = r["slip"][k] < -0.8 and r["vehicle_speed"][k] > 2
        since = since + r["time"][k] - r["time"][k - 1] if locked else 0.0
        longest = max(longest, since)
    gain = lambda name: r[name][end] - r[name][start]
    changes = [gain(name) for name in ("vehicle_distance", "time", "friction_energy", "brake_energy")]
    return changes[0], changes[1], longest, changes[2], changes[3], r["vehicle_speed"][start]


ROADS = {"dry": "Dry", "wet": "Wet", "split": "Split in time", "slabs": "Over ramps"}


@pytest.mark.parametrize("road", ROADS)
def test_demo_shows_the_numbers_of_its_results(demo, road):
    page = (demo / "index.html").read_text()
    numbers = {}
    for variant, name in (("abs", "with ABS"), ("no-abs", "without ABS")):
        numbers[variant] = stop_numbers(demo / "runs" / f"{road}-{variant}.csv")
        distance, time, lock, patch, brake, speed = numbers[variant]
        row = page.split(f"<td>{ROADS[road]}, {name}</td>")[1].split("</tr>")[0]
        cells = [float(cell.split("<")[0]) for cell in row.split('<td class="number">')[1:]]
        assert cells[0] == pytest.approx(distance, abs=0.0051)
        assert cells[1] == pytest.approx(time, abs=0.0051)
        assert cells[2] == pytest.approx(speed**2 / 2 / distance, abs=0.0051)
        assert cells[3] == pytest.approx(lock, abs=0.0051)
        assert cells[5] == pytest.approx(patch / 1e3, abs=0.051)
        assert cells[6] == pytest.approx(brake / 1e3, abs=0.051)
        # what moved and spun at the start is made heat; a little of that by rolling and damping
        energy = 0.5 * (420 + 7.4) * speed**2 + 0.5 * (0.7 + 0.67) * (speed / 0.304) ** 2
        assert 0.93 * energy < patch + brake < energy
    with_abs, without = numbers["abs"], numbers["no-abs"]
    # the wheel keeps turning, and the brake makes the heat: of a slip s the contact has s/(1 - s) of it, and s is a third at most
    assert with_abs[2] < 0.3 < 2 < without[2]
    assert with_abs[3] < 0.5 * with_abs[4] and without[3] > 5 * without[4]
    # sliding friction falls with the sliding speed here, so that a locked wheel loses; at most what one loses that keeps to the peak of 0.96
    assert 0.6 < with_abs[0] / without[0] < 0.9


def test_demo_shows_a_locked_wheel_that_slides_as_its_tire_says(demo):
    tire = tomllib.loads((ROOT / "examples" / "tires" / "ring-brush-205-60-r15.toml").read_text())["parameters"]
    r = read_results(demo / "runs" / "dry-no-abs.csv")
    locked = [k for k, slip in enumerate(r["corner.slip"]) if slip == -1 and 3 < r["corner.vehicle_speed"][k] < 25]
    time, speed = (np.array([r[name][k] for k in locked]) for name in ("time", "corner.vehicle_speed"))
    assert speed[0] > 24.9 and speed[-1] < 3.1
    # m dv/dt = -F_0 / (1 + a v), solved for the time from one speed to another
    fallen = speed[0] - speed + tire["friction_speed_falloff"] / 2 * (speed[0] ** 2 - speed**2)
    braked = fallen[1:] / (time[1:] - time[0])
    assert braked == pytest.approx(np.full(len(braked), braked[-1]), rel=2e-3)
    # the curves from which it is have 0.626 of the load at 60 km/h
    assert braked[-1] / 9.81 == pytest.approx(0.626 * (1 + tire["friction_speed_falloff"] * 60 / 3.6), rel=0.03)


def test_demo_shows_the_forces_of_the_car_of_its_results(demo, tmp_path):
    page = (demo / "car" / "index.html").read_text()
    assert (demo / "car" / "index.html").stat().st_size < 5e6
    distances = {}
    for road, title in (("slabs", "On slabs"), ("level", "On level road")):
        for variant, name in (("abs", "with ABS"), ("no-abs", "without ABS")):
            r = read_results(demo / "car" / f"{road}-{variant}.csv")
            row = page.split(f"<td>{title}, {name}</td>")[1].split("</tr>")[0]
            start = max(k for k, p in enumerate(r["brake_fl.driver_pressure"]) if p == 0)
            end = next(k for k, v in enumerate(r["car.vehicle_speed"]) if k > start and v < 0.1)
            slow = next(k for k, v in enumerate(r["car.vehicle_speed"]) if v < 1)
            distances[road, variant] = r["car.vehicle_distance"][end] - r["car.vehicle_distance"][start]
            assert f"{distances[road, variant]:.2f}" in row
            for force in ("longitudinal_link", "tie_rod", "transverse_link", "strut"):
                values = [1e-3 * f for f in r[f"car.front_left.{force}_force"][start:slow]]
                assert f"{min(values):.2f} to {max(values):.2f}".replace("-", "−") in row, force
    # sliding friction falls with the sliding speed here; a wheel leaves the road behind a slab, and then falls on it
    assert all(0.7 < distances[road, "abs"] / distances[road, "no-abs"] < 0.9 for road in ("slabs", "level"))
    # what is written runs again with the same numbers
    done = latsch("cosimulate", demo / "car" / "level-abs.toml", "--output", tmp_path / "again.csv")
    assert done.returncode == 0, done.stderr
    again = read_results(tmp_path / "again.csv")
    shown = read_results(demo / "car" / "level-abs.csv")
    assert again["car.vehicle_distance"][::5] == shown["car.vehicle_distance"]


def test_demo_system_runs_again_with_the_same_numbers(demo, tmp_path):
    done = latsch("cosimulate", demo / "abs-stop.toml", "--output", tmp_path / "again.csv")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "again.csv").read_bytes() == (demo / "runs" / "dry-abs.csv").read_bytes()


def test_results_never_overwrite_what_is_read(tmp_path):
    inputs = write(tmp_path / "rig.csv", "time [s],slip [1]", "0,0", "0.1,0.01")
    before = inputs.read_text()
    done = latsch("simulate", MODEL, "--inputs", inputs, "--output", inputs)
    assert done.returncode == 2 and "overwrite" in done.stderr and inputs.read_text() == before
    done = latsch("simulate", MODEL, "--output", tmp_path / "x", "--report", tmp_path / "x")
    assert done.returncode == 2 and "overwrite" in done.stderr
    done = latsch("simulate", MODEL, "--output", tmp_path / "out.csv", "--report", tmp_path / "none" / "r.html")
    assert done.returncode == 2 and "no folder" in done.stderr and not (tmp_path / "out.csv").exists()


def test_output_that_cannot_be_printed_is_no_success():
    with open("/dev/full", "w") as full:
        done = subprocess.run([PROGRAM, "models"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2 and "standard output" in done.stderr


def test_an_fmu_that_would_not_start_is_not_written(tmp_path):
    tire = tmp_path / "tire.toml"
    tire.write_text("[parameters]\nfriction_static_zero = 0.1\n")
    done = latsch("export", MODEL, "--parameters", tire, "--output", tmp_path / "x.fmu")
    assert done.returncode == 2
    assert "tire.toml" in done.stderr and "friction_static_zero" in done.stderr
    assert not (tmp_path / "x.fmu").exists()


def test_an_fmu_with_other_variables_gets_no_picture_of_ours(fmu, tmp_path):
    # the same GUID, but two variables have changed places in the description
    def swap(name, data):
        if not name.endswith(".xml"):
            return data
        data = data.replace(b'"gravity"', b'"#"').replace(b'"vertical_stiffness"', b'"gravity"')
        return data.replace(b'"#"', b'"vertical_stiffness"')

    other = rewrite(fmu, tmp_path / "other.fmu", swap)
    done = latsch("simulate", other, "--stop", "0.01", "--output", tmp_path / "o.csv", "--report", tmp_path / "o.html")
    assert done.returncode == 0, done.stderr
    assert "Contact patch" not in (tmp_path / "o.html").read_text()
    done = latsch("simulate", fmu, "--stop", "0.01", "--output", tmp_path / "o.csv", "--report", tmp_path / "o.html")
    assert "Contact patch" in (tmp_path / "o.html").read_text()


def test_values_with_units_in_both_spellings(tmp_path):
    for value in ("54 km/h", "54km/h", "15"):
        done = latsch("simulate", MODEL, "--set", f"path_speed={value}", "--stop", "0.01", "--output", tmp_path / "o.csv")
        assert done.returncode == 0, done.stderr
        assert read_results(tmp_path / "o.csv")["path_speed"][0] == pytest.approx(15, rel=1e-12)
    done = latsch("simulate", MODEL, "--set", "slip=0", "--set", "slip=0.1", "--output", tmp_path / "o.csv")
    assert done.returncode == 2 and "twice" in done.stderr


def test_a_page_compares_peaks_oscillations_and_repeats_behind_one_low_pass(tmp_path):
    """A wheel that is pushed swings with 2 pi / sqrt(k/m - (c/2m)^2), and a period on it has exp(-c T/2m) of its amplitude."""
    push = tmp_path / "push.csv"
    push.write_text("time [s],force [N]\n0,1000\n0.5,1000\n0.501,2000\n2.5,2000\n")
    model, mass = "linear-hydropulse", 600.0

    def swing(stiffness, damping):
        rate = damping / (2 * mass)
        period = 2 * np.pi / np.sqrt(stiffness / mass - rate**2)
        return period, rate * period

    def settings(stiffness, damping):
        values = {"wheel_mass": mass, "command_actuators": 0, "vertical_stiffness": stiffness, "vertical_damping": damping}
        return [x for name, value in values.items() for x in ("--set", f"{name}={value}")]

    runs = []
    for seed in (1, 2, 3):
        runs.append(tmp_path / f"run{seed}.csv")
        done = latsch(
            "simulate", model, "--inputs", push, *settings(5e5, 1400), "--step", 2e-3, "--noise", 0.01,
            "--seed", seed, "--output", runs[-1],
        )
        assert done.returncode == 0, done.stderr
    page = tmp_path / "page.html"

    def compare(*arguments, stiffness=5.5e5, damping=1700):
        return latsch(
            "simulate", model, "--inputs", runs[0], *settings(stiffness, damping), "--step",
            2e-3, "--output", tmp_path / "out.csv", "--report", page, *arguments,
        )

    def rows(name):
        """Cells of the page's tables in rows that begin with a channel, behind the name."""
        text = page.read_text().replace("\N{MINUS SIGN}", "-")
        cells = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", text, re.S)]
        return [row[1:] for row in cells if row and row[0] == name]

    done = compare("--low-pass", 40, "--swing", "0.6:2.4", "--repeat", runs[1], "--repeat", runs[2])
    assert done.returncode == 0, done.stderr
    assert "half of the power at 40 Hz" in page.read_text()
    found = next(row for row in rows("piston_position") if "±" in row[1])
    (period, decrement), (own, own_decrement) = swing(5e5, 1400), swing(5.5e5, 1700)
    assert float(found[0]) == pytest.approx(own, rel=3e-3)
    assert float(found[2]) == pytest.approx(100 * (own / period - 1), abs=0.3)
    assert float(found[3]) == pytest.approx(own_decrement, rel=0.02)
    assert float(found[5]) == pytest.approx(100 * (own_decrement / decrement - 1), abs=2.5)
    assert any("farther off than a run" == row[-1] for row in rows("piston_position"))
    # the run's own parameters are as near as its repeats
    assert compare("--repeat", runs[1], "--repeat", runs[2], stiffness=5e5, damping=1400).returncode == 0
    assert any("no farther off than a run" == row[-1] for row in rows("piston_position"))

    # what cannot be compared is said
    for arguments, words in [
        (("--swing", "2:1"), "FROM before TO"),
        (("--low-pass", 900), "a fifth of the sampling rate"),
        (("--repeat", tmp_path / "none.csv"), "none.csv"),
    ]:
        done = compare(*arguments)
        assert done.returncode == 2 and words in done.stderr, done.stderr
    done = latsch(
        "simulate", model, "--inputs", push, "--output", tmp_path / "out.csv", "--report", page, "--low-pass", 40,
    )
    assert done.returncode == 2 and "named like an output" in done.stderr


@pytest.mark.quick
def test_shells_complete_and_manual_pages_are_written(tmp_path):
    for shell in ("bash", "zsh", "fish", "powershell"):
        assert "characterize" in latsch("completions", shell).stdout
    script = tmp_path / "latsch.bash"
    script.write_text(latsch("completions", "bash").stdout)
    subprocess.run(["bash", "-n", script], check=True)
    assert latsch("man", tmp_path / "man1").returncode == 0
    pages = {path.name: path.read_text() for path in (tmp_path / "man1").iterdir()}
    assert {"latsch.1", "latsch-simulate.1", "latsch-tire.1"} <= pages.keys()
    assert all(text.lstrip().startswith((".ie", ".TH")) for text in pages.values())
    assert "\\-\\-inputs" in pages["latsch-simulate.1"]


@pytest.mark.quick
def test_notes_can_be_silenced_and_words_colored(tmp_path):
    inputs = tmp_path / "inputs.csv"
    inputs.write_text("time [s],slip_angle [deg]\n0,0\n0.1,2\n")
    run = ["simulate", "magic-formula-flat-track", "--inputs", inputs, "--output", tmp_path / "results.csv"]
    told = latsch(*run)
    assert told.stderr.startswith("note: command_actuators") and "\x1b" not in told.stderr
    assert latsch("--quiet", *run).stderr == ""
    assert latsch(*run, "-q").stdout == told.stdout
    # errors stay
    assert latsch("-q", "simulate", "magic-formul", "--output", "x.csv").stderr.startswith("error: ")
    colored = latsch("--color", "always", *run).stderr
    assert "\x1b[" in colored and colored.replace("\x1b[1m\x1b[36m", "").replace("\x1b[0m", "") == told.stderr
    assert latsch("--color", "never", *run).stderr == told.stderr


@pytest.mark.quick
def test_a_model_that_is_not_there_is_named_with_one_that_is():
    said = latsch("simulate", "ring-brush-wheal", "--output", "x.csv").stderr
    assert 'did you mean "ring-brush-wheel"?' in said and len(said) < 200


@pytest.mark.quick
def test_recordings_of_other_programs_drive_a_model(tmp_path):
    """Units in a second line, a decimal comma, another name and unit; samples and channels are chosen."""
    plain, foreign, names = tmp_path / "plain.csv", tmp_path / "foreign.csv", tmp_path / "map.toml"
    plain.write_text("time [s],slip_angle [rad],deflection [mm]\n0,0,20\n0.1,0.02,20.5\n")
    foreign.write_text("sep=;\n# rig 4\nZeit;alpha;Einfederung;Bemerkung\ns;rad;mm;-\n0,0;0,00;20,0;1\n0,1;0,02;20,5;2\n")
    names.write_text(
        '[channels]\nZeit = { variable = "time" }\nalpha = { variable = "slip_angle" }\nEinfederung = { variable = "deflection" }\nBemerkung = {}\n'
    )
    results = []
    for number, arguments in enumerate(([plain], [foreign, "--map", names])):
        output = tmp_path / f"{number}.csv"
        done = latsch("simulate", "magic-formula-flat-track", "--inputs", *arguments, "--output", output)
        assert done.returncode == 0, done.stderr
        results.append(output.read_text())
    assert results[0] == results[1]

    chosen = tmp_path / "chosen.csv"
    run = ["simulate", "magic-formula-flat-track", "--inputs", plain, "--output", chosen, "--channels", "force_y,wheel_speed", "--interval"]
    assert latsch(*run, "0.03").returncode == 0
    whole = {row.split(",")[0]: row for row in results[0].splitlines()}
    rows = chosen.read_text().splitlines()
    assert rows[0] == "time [s],force_y [N],wheel_speed [rad/s]"
    assert [row.split(",")[0] for row in rows[1:]] == ["0", "0.03", "0.06", "0.09", "0.1"]
    column = results[0].splitlines()[0].split(",").index("force_y [N]")
    assert all(row.split(",")[1] == whole[row.split(",")[0]].split(",")[column] for row in rows[1:])
    assert "no whole number" in latsch(*run, "0.0305").stderr
    assert "force_y" in latsch("simulate", "magic-formula-flat-track", "--output", chosen, "--channels", "forcey").stderr
