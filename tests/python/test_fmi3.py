"""FMUs of FMI 3.0: valid, and bit for bit what those of FMI 2.0 are where inputs are held."""

import ctypes
import zipfile

import fmpy
import fmpy.fmi3
import pytest
from fmpy.validation import validate_fmu

from conftest import MODEL, MODELS, Slave, latsch

# of all kinds of variables and parts
SOME = [MODEL, "ring-brush-vehicle", "super-elastic-counterbalance-truck", "brake-hydraulics", "abs-controller"]


@pytest.fixture(scope="module")
def exported3(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmi3")

    def export(model):
        path = folder / f"{model}.fmu"
        if not path.exists():
            done = latsch("export", model, "--fmi", "3", "--output", path)
            assert done.returncode == 0, done.stderr
        return path

    return export


class Unit:
    """An instance of FMI 3.0, driven by hand, with its messages."""

    def __init__(self, fmu, folder, start=None, **how):
        self.description = fmpy.read_model_description(str(fmu))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages = []
        self.raw = fmpy.fmi3.FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(fmu), str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        log = lambda _, status, category, message: self.messages.append((status, category.decode(), message.decode()))
        try:
            self.raw.instantiate(logMessage=fmpy.fmi3.fmi3LogMessageCallback(log), **how)
        except Exception:
            self.raw.component = None
        if start is not None:
            self.raw.enterInitializationMode(startTime=0.0)
            self.set(**start)
            self.raw.exitInitializationMode()

    def references(self, names):
        return [self.variables[name].valueReference for name in names]

    def set(self, **values):
        for kind, change in [("Float64", self.raw.setFloat64), ("Boolean", self.raw.setBoolean)]:
            names = [name for name in values if self.variables[name].type == kind]
            change(self.references(names), [values[name] for name in names])

    def get(self, *names):
        return self.raw.getFloat64(self.references(names))

    def outputs(self):
        of = [v for v in self.variables.values() if v.causality in ("output", "local") and v.type == "Float64"]
        return self.raw.getFloat64([v.valueReference for v in of])

    def refuses(self, call, *words):
        """The call fails, with one message that has these words."""
        before = len(self.messages)
        with pytest.raises(Exception):
            call()
        [(status, category, message)] = self.messages[before:]
        assert (status, category) == (3, "logStatusError") and all(word in message for word in words), message


@pytest.fixture
def units(exported3, tmp_path):
    made = []

    def make(model=MODEL, start=None, **how):
        made.append(Unit(exported3(model), tmp_path / str(len(made)), start, **how))
        return made[-1]

    yield make
    for unit in made:
        if unit.raw.component:
            unit.raw.freeInstance()


@pytest.mark.parametrize("model", SOME)
def test_it_is_valid_and_runs_as_its_twin_of_fmi_2(model, exported, exported3, units):
    assert validate_fmu(str(exported3(model))) == []
    start, later = MODELS[model]
    unit, twin = units(model, start), Slave(exported(model), start)
    for k in range(60):
        if k == 30:
            unit.set(**later)
            twin.set(**later)
        assert unit.raw.doStep(k * 1e-3, 1e-3) == (False, False, False, pytest.approx((k + 1) * 1e-3))
        twin.raw.doStep(k * 1e-3, 1e-3)
        assert unit.outputs() == twin.outputs()
    names = [v.name for v in twin.description.modelVariables if v.causality == "output" and v.type == "Real"]
    assert unit.raw.getOutputDerivatives(unit.references(names), [1] * len(names)) == twin.derivatives(*names)
    assert unit.get("time") == [pytest.approx(0.06)]
    twin.close()


def test_states_go_back_and_through_bytes(units):
    start = dict(deflection=0.02, path_speed=15.0, slip_angle=0.03)
    unit, other = units(start=start), units(start=start)
    for k in range(20):
        unit.raw.doStep(k * 1e-3, 1e-3)
    state = unit.raw.getFMUState()
    data = unit.raw.serializeFMUState(state)
    ends = []
    for slave, saved in [(unit, state), (other, other.raw.deserializeFMUState(data)), (unit, state)]:
        slave.raw.setFMUState(saved)
        assert slave.get("time") == [pytest.approx(0.02)]
        for k in range(20, 40):
            slave.raw.doStep(k * 1e-3, 1e-3)
        ends.append(slave.outputs())
        if slave is other:
            slave.raw.freeFMUState(saved)
    assert ends[0] == ends[1] == ends[2]
    unit.raw.freeFMUState(state)


def test_directional_derivatives_are_those_of_its_twin(units, fmu):
    start = dict(deflection=0.02, path_speed=15.0, slip_angle=0.03, command_actuators=False)
    unit, twin = units(start=start), Slave(fmu, start)
    unknowns, seed = ["force_y", "force_z"], {"deflection": 1e-3, "slip_angle": 0.01}
    own = unit.raw.getDirectionalDerivative(unit.references(unknowns), unit.references(seed), list(seed.values()))
    assert list(own) == list(twin.directional(unknowns, seed)) and own[1] != 0.0
    twin.close()


def test_each_type_has_its_functions(units):
    unit = units()
    unit.raw.enterInitializationMode(startTime=0.0)
    values = {"command_actuators": False, "load_control": True}
    unit.set(**values)
    assert [bool(v) for v in unit.raw.getBoolean(unit.references(values))] == list(values.values())
    road, stripes, name, state = unit.references(["road_kind", "stripes", "tire_name", "pressure_state"])
    unit.raw.setInt64([road], [3])
    unit.raw.setInt32([stripes], [4])
    unit.raw.setString([name], ["größer"])
    assert [*unit.raw.getInt64([road]), *unit.raw.getInt32([stripes])] == [3, 4]
    assert list(unit.raw.getString([name])) == ["größer"]
    assert unit.raw.getInt64([state])[0] >= 1
    unit.refuses(lambda: unit.raw.getInt32([road]), "fmi3GetInt32", "Int32")


def test_wrong_calls_are_refused_in_its_own_words(units):
    reset = lambda unit: unit.raw.reset()
    unit = units()
    one = unit.references(["force_z"])
    unit.refuses(lambda: unit.raw.doStep(0.0, 1e-3), "fmi3DoStep", "before initialization")
    unit.refuses(lambda: unit.raw.terminate(), "fmi3Terminate", "only fmi3Reset, fmi3SetFMUState and fmi3FreeInstance help")
    reset(unit)
    unit.refuses(lambda: unit.raw.getFloat64(unit.references(["command_actuators"])), "fmi3GetFloat64", "before initialization")
    reset(unit)
    unit.raw.enterInitializationMode(startTime=0.0)
    unit.refuses(lambda: unit.raw.getFloat32(one), "fmi3GetFloat32", "no variables of this type")
    reset(unit)
    unit.refuses(lambda: unit.raw.enterEventMode(), "fmi3EnterEventMode", "not offered")
    reset(unit)
    unit.refuses(lambda: unit.raw.enterInitializationMode(startTime=float("nan")), "fmi3EnterInitializationMode", "NaN")
    reset(unit)
    unit.raw.enterInitializationMode(startTime=0.0)
    unit.raw.exitInitializationMode()
    references, values = (ctypes.c_uint32 * 1)(*one), (ctypes.c_double * 2)()
    count_two = lambda: unit.raw.fmi3GetFloat64(unit.raw.component, references, 1, values, 2)
    unit.refuses(count_two, "fmi3GetFloat64", "1 value references and 2 values")
    reset(unit)
    nowhere = ctypes.POINTER(ctypes.c_double)()
    unit.refuses(lambda: unit.raw.fmi3GetOutputDerivatives(unit.raw.component, references, 1, None, nowhere, 1), "fmi3GetOutputDerivatives")

    # what it is not is not made
    [(status, _, message)] = units(eventModeUsed=True).messages
    assert status == 3 and "fmi3InstantiateCoSimulation" in message and "Event Mode" in message


def test_the_page_inside_speaks_of_this_version(exported3):
    with zipfile.ZipFile(exported3("brake-hydraulics")) as archive:
        page = archive.read("documentation/index.html").decode()
        assert "binaries/x86_64-linux/brake_hydraulics.so" in archive.namelist()
    assert "FMI 3.0" in page and "fmi3" in page and "fmi2" not in page


def test_what_is_of_fmi_2_only_says_so(exported3, tmp_path):
    fmu = exported3(MODEL)
    done = latsch("simulate", fmu, "--output", tmp_path / "results.csv")
    assert done.returncode != 0 and 'only FMUs of FMI "2.0" can be imported' in done.stderr
    done = latsch("check", fmu)
    assert done.returncode != 0 and "this check is for FMI 2.0" in done.stderr
    done = latsch("export", MODEL, "--fmi", "3", "--effects", tmp_path / "none.toml")
    assert done.returncode != 0 and "leave out --fmi 3" in done.stderr
