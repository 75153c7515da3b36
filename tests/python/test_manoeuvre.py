"""`latsch manoeuvre`: each is driven, what is written is a system that runs alike, and readings are what mechanics says."""

import csv
import json

import pytest
from conftest import latsch, read_results, rewrite

CAR = "magic-formula-vehicle"


def driven(name, folder, *arguments, vehicle=CAR):
    done = latsch("manoeuvre", name, "--vehicle", vehicle, "--output", folder, "--format", "json", *arguments)
    assert done.returncode == 0, done.stderr
    found = {r["name"]: r for r in json.loads(done.stdout)["readings"]}
    with open(folder / "readings.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["reading"] for row in rows] == list(found)
    assert all(float(row["value"]) == found[row["reading"]]["value"] for row in rows)
    return found



@pytest.mark.quick
def test_they_are_listed():
    said = latsch("manoeuvre").stdout
    for name in ("partial-braking", "abs-stop-80", "abs-stop-100", "ramp-steer", "steady-circles", "washboard"):
        assert f"{name} " in said
    done = latsch("manoeuvre", "slalom", "--vehicle", CAR, "--output", "x")
    assert done.returncode == 2 and "washboard" in done.stderr


@pytest.mark.quick
def test_half_of_the_greatest_deceleration_moves_load_forward(tmp_path):
    found = driven("partial-braking", tmp_path / "braking")
    assert 9 < found["greatest deceleration of the search"]["value"] < 11.5
    for name, within in [("mean deceleration", 0.02), ("way from settled to slow", 0.01), ("load transfer front_left", 0.05),
                         ("load transfer front_right", 0.05)]:
        assert found[name]["value"] == pytest.approx(found[name]["expected"], rel=within), name
    # m a h / 2 L, of the table of the model
    a = found["mean deceleration"]["value"]
    assert found["load transfer front_left"]["expected"] == pytest.approx(0.5 * 1650 * a * 0.48 / 2.35, rel=1e-9)
    assert 0.005 < found["settled pitch"]["value"] < 0.05
    # what is written is the system that was run
    written = latsch("cosimulate", "system.toml", "--output", "again.csv", "--until", "car.vehicle_speed<1", cwd=tmp_path / "braking")
    assert written.returncode == 0, written.stderr
    assert (tmp_path / "braking" / "again.csv").read_bytes() == (tmp_path / "braking" / "results.csv").read_bytes()


@pytest.mark.quick
def test_stops_with_abs_grow_with_the_square_of_the_speed(tmp_path):
    short, long = (driven(f"abs-stop-{v}", tmp_path / f"{v}") for v in (80, 100))
    for found, v in [(short, 80 / 3.6), (long, 100 / 3.6)]:
        distance = found["stopping distance"]["value"]
        # from the begin of braking, air and rolling have taken little until then
        assert found["mean deceleration over the way"]["value"] == pytest.approx(v**2 / (2 * distance), rel=0.01)
        # no more than the tire has: 1.1 at its nominal load of 4.5 kN, a tenth more for each nominal load less
        for wheel in ("front_left", "front_right", "rear_left", "rear_right"):
            assert 0.9 < found[f"greatest force over load {wheel}"]["value"] < 1.1 * 1.1
            assert found[f"openings of the outlet valve {wheel}"]["value"] >= 3
    # the square of the speeds is 1.56, and what is lost below 20 km/h, where brake torques fall to a tenth, is lost in both
    assert 1.3 < long["stopping distance"]["value"] / short["stopping distance"]["value"] < 1.57


@pytest.mark.quick
def test_a_slow_ramp_steer_finds_the_limit(tmp_path):
    found = driven("ramp-steer", tmp_path / "ramp")
    assert 8.0 < found["greatest lateral acceleration"]["value"] < 10.0
    assert found["speed at that"]["value"] > 0.8 * 100 / 3.6
    circle = found["mean lateral acceleration of the linear range"]
    assert circle["value"] == pytest.approx(circle["expected"], rel=0.02)
    assert 0 < found["yaw rate over steering wheel"]["value"] < 1
    assert abs(found["understeer gradient at the wheels"]["value"]) < 0.005


def test_circles_are_stationary_and_bear_what_moments_ask_for(tmp_path):
    # on tires with so little grip that the third circle is too fast
    (tmp_path / "tires.toml").write_text('[parameters]\n"front_tire.LMUY" = 0.52\n"rear_tire.LMUY" = 0.52\n')
    fmu = tmp_path / "car.fmu"
    assert latsch("export", CAR, "--parameters", tmp_path / "tires.toml", "--output", fmu).returncode == 0
    found = driven("steady-circles", tmp_path / "circles", vehicle=fmu)
    circles = [name.removeprefix("lateral acceleration at ") for name in found if name.startswith("lateral acceleration at ")]
    assert circles == ["4 m/s2", "4.5 m/s2"]
    for circle in circles:
        aside = found[f"lateral acceleration at {circle}"]
        assert aside["value"] == pytest.approx(float(circle.split()[0]), rel=0.01)
        assert aside["value"] == pytest.approx(aside["expected"], rel=2e-3)
        moment = found[f"moment of the wheel loads about the way at {circle}"]
        assert moment["value"] == pytest.approx(moment["expected"], rel=0.02)
        # it leans out, and needs a drive that makes up for what the front wheels brake
        assert found[f"roll at {circle}"]["value"] > 0 and found[f"drive at {circle}"]["value"] > 0
    # the axle in front gives way first
    assert 0 < found["understeer gradient at the wheels between the first two"]["value"] < 0.01


@pytest.mark.quick
def test_a_washboard_is_felt_wave_by_wave(tmp_path):
    found = driven("washboard", tmp_path / "waves")
    frequency = found["frequency of the wheel load"]
    assert frequency["value"] == pytest.approx(frequency["expected"], rel=0.01)
    results = read_results(tmp_path / "waves" / "results.csv")
    force = [f for t, f in zip(results["time"], results["car.front_left.tie_rod_force"]) if 2 <= t <= 5]
    assert found["largest front_left.tie_rod_force"]["value"] == max(force)
    assert found["smallest front_left.tie_rod_force"]["value"] == min(force)


def test_an_fmu_with_other_names_is_driven(tmp_path, exported):
    """The shipped vehicle as an FMU in which some variables have other names: the same readings."""
    other = {"vehicle_speed": "v_x", "front_left.brake_torque": "M_B_FL", "rear_right.wheel_speed": "omega_4"}

    def renamed(name, data):
        if name == "modelDescription.xml":
            for ours, theirs in other.items():
                assert data.count(f'name="{ours}"'.encode()) >= 1
                data = data.replace(f'name="{ours}"'.encode(), f'name="{theirs}"'.encode())
        return data

    fmu = rewrite(exported(CAR), tmp_path / "their-car.fmu", renamed)
    names = tmp_path / "names.toml"
    names.write_text("[names]\n" + "".join(f'"{ours}" = "{theirs}"\n' for ours, theirs in other.items()))
    ours = driven("abs-stop-80", tmp_path / "ours")
    theirs = driven("abs-stop-80", tmp_path / "theirs", "--names", names, vehicle=fmu)
    assert theirs == ours
    assert (tmp_path / "theirs" / "car.fmu").read_bytes() == fmu.read_bytes()
    # without the names it is said what is missing
    done = latsch("manoeuvre", "abs-stop-80", "--vehicle", fmu, "--output", tmp_path / "none")
    assert done.returncode == 2 and "vehicle_speed" in done.stderr
    names.write_text("[nams]\n")
    done = latsch("manoeuvre", "abs-stop-80", "--vehicle", fmu, "--output", tmp_path / "none", "--names", names)
    assert done.returncode == 2 and "names.toml:1" in done.stderr
