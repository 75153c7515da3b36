"""Whatever a master does wrong: fmi2Error and one message that says what, and reset mends it."""

import ctypes
import math

import pytest
from fmpy.fmi1 import FMICallException

from test_fmpy import START

OK, DISCARD, ERROR = 0, 2, 3


def refuse(slave, call, *words):
    """The call gives fmi2Error with exactly one message that has these words."""
    before = len(slave.messages)
    with pytest.raises(FMICallException) as caught:
        call()
    assert caught.value.status == ERROR
    new = slave.messages[before:]
    assert len(new) == 1, new
    status, category, text = new[0]
    assert status == ERROR and category == "logStatusError"
    for word in words:
        assert word in text, text


def recover(slave):
    """After an error nothing but reset helps; then all is well."""
    refuse(slave, lambda: slave.raw.doStep(0.0, 1e-3), "after an error", "fmi2Reset")
    slave.raw.reset()
    slave.begin(START)
    slave.steps(2)
    assert math.isfinite(slave.get("force_z")[0])


@pytest.mark.parametrize(
    "time, length, words",
    [
        (0.0, math.nan, ["finite"]),
        (math.nan, 1e-3, ["finite"]),
        (0.0, math.inf, ["finite"]),
        (0.0, 0.0, ["positive"]),
        (0.0, -1e-3, ["positive"]),
        (0.5, 1e-3, ["0.5", "ended at 0 s"]),
        (0.0, 1e9, ["steps"]),
    ],
)
def test_steps_that_make_no_sense(slaves, time, length, words):
    slave = slaves(START)
    refuse(slave, lambda: slave.raw.doStep(time, length), *words)
    recover(slave)


def test_a_step_too_short_to_move_the_clock(slaves):
    slave = slaves(START)
    slave.steps(10)
    refuse(slave, lambda: slave.raw.doStep(0.01, 1e-30), "too short")


def test_stop_time_is_the_end(slaves):
    slave = slaves()
    slave.begin(START, stop=0.01)
    slave.steps(10)
    refuse(slave, lambda: slave.raw.doStep(0.01, 1e-3), "stop time 0.01")


@pytest.mark.parametrize(
    "name, value, words",
    [
        ("slip", math.nan, ["slip", "finite"]),
        ("slip_angle", math.inf, ["slip_angle", "finite"]),
        ("deflection", 0.5, ["deflection = 0.5 m", "-0.2 to 0.1 m"]),
        ("path_speed", -1e6, ["path_speed", "range"]),
        ("force_z", 1.0, ["force_z", "computed"]),
        ("belt_mass", 9.0, ["belt_mass", "after initialization"]),
    ],
)
def test_values_that_are_refused(slaves, name, value, words):
    slave = slaves(START)
    refuse(slave, lambda: slave.set(**{name: value}), *words)
    recover(slave)


def test_types_and_references(slaves):
    slave = slaves(START)
    refuse(slave, lambda: slave.raw.getReal([10000]), "10000")
    slave.raw.reset()
    slave.begin(START)
    refuse(slave, lambda: slave.raw.getInteger([slave.references["slip"]]), "slip", "not an Integer")
    slave.raw.reset()
    slave.begin(START)
    refuse(slave, lambda: slave.raw.getReal([slave.references["stripes"]]), "stripes", "not a Real")
    slave.raw.reset()
    refuse(slave, lambda: slave.raw.setBoolean([slave.references["even_stripes"]], [7]), "true or false")
    slave.raw.reset()
    refuse(slave, lambda: slave.raw.setInteger([slave.references["stripes"]], [0]), "stripes = 0", "1 to 64")
    slave.raw.reset()
    slave.begin(START)
    refuse(slave, lambda: slave.rates(force_x=1.0), "force_x")


def test_parameters_that_contradict_each_other(slaves):
    slave = slaves()
    slave.raw.setupExperiment()
    slave.set(friction_static_zero=0.5)
    slave.raw.enterInitializationMode()
    refuse(slave, slave.raw.exitInitializationMode, "friction_static_zero", "friction_sliding_zero")


def test_patch_longer_than_the_ring(slaves):
    slave = slaves()
    slave.raw.setupExperiment()
    slave.raw.setInteger([slave.references["bristles_per_stripe"]], [8])
    slave.raw.enterInitializationMode()
    refuse(slave, slave.raw.exitInitializationMode, "ring of bristles", "more or longer bristles")


@pytest.mark.quick
def test_order_of_calls(slaves):
    slave = slaves()
    refuse(slave, lambda: slave.raw.doStep(0.0, 1e-3), "before initialization")
    slave.raw.reset()
    refuse(slave, slave.raw.enterInitializationMode, "fmi2SetupExperiment")
    slave.raw.reset()
    refuse(slave, slave.raw.exitInitializationMode, "before initialization")
    slave.raw.reset()
    refuse(slave, slave.raw.terminate, "before initialization")
    slave.raw.reset()
    refuse(slave, lambda: slave.get("force_z"), "before initialization")
    slave.raw.reset()
    refuse(slave, lambda: slave.raw.setupExperiment(startTime=math.nan), "finite")
    slave.raw.reset()
    slave.begin(START)
    refuse(slave, lambda: slave.raw.setupExperiment(), "between steps")
    slave.raw.reset()
    slave.begin(START)
    slave.raw.terminate()
    refuse(slave, lambda: slave.raw.doStep(0.0, 1e-3), "after fmi2Terminate")
    recover(slave)


def test_null_pointers(slaves):
    slave = slaves(START)
    dll, component = slave.raw.dll, ctypes.c_void_p(slave.raw.component)
    reference = (ctypes.c_uint * 1)(0)
    assert dll.fmi2GetReal(component, reference, ctypes.c_size_t(1), None) == ERROR
    assert "null pointer" in slave.messages[-1][2]
    slave.raw.reset()
    slave.begin(START)
    # nothing asked, nothing needed
    assert dll.fmi2GetReal(component, None, ctypes.c_size_t(0), None) == OK
    assert dll.fmi2SetFMUstate(component, None) == ERROR
    slave.raw.reset()
    assert dll.fmi2GetFMUstate(component, None) == ERROR
    slave.raw.reset()
    assert dll.fmi2FreeFMUstate(component, None) == OK
    # no instance: nobody to tell
    assert dll.fmi2DoStep(None, ctypes.c_double(0), ctypes.c_double(1e-3), 0) == ERROR
    assert dll.fmi2Reset(None) == ERROR
    dll.fmi2FreeInstance(None)


def test_what_is_not_offered_says_so(slaves):
    slave = slaves(START)
    dll, component = slave.raw.dll, ctypes.c_void_p(slave.raw.component)
    assert dll.fmi2CancelStep(component) == ERROR
    assert len(slave.messages) == 1 and "asynchronous" in slave.messages[0][2]
    slave.raw.reset()
    slave.begin(START)
    refuse(slave, lambda: slave.directional(["force_x"], dict(belt_mass=1.0)), "belt_mass", "no real input")
    slave.raw.reset()
    slave.begin(START)
    # status: no asynchronous steps, so most kinds have no answer
    status, time, boolean = ctypes.c_int(), ctypes.c_double(), ctypes.c_int()
    slave.steps(3)
    assert dll.fmi2GetStatus(component, 0, ctypes.byref(status)) == DISCARD
    assert dll.fmi2GetRealStatus(component, 2, ctypes.byref(time)) == OK and time.value == pytest.approx(3e-3)
    assert dll.fmi2GetBooleanStatus(component, 3, ctypes.byref(boolean)) == OK and boolean.value == 0
    assert dll.fmi2GetRealStatus(component, 0, ctypes.byref(time)) == DISCARD


@pytest.mark.quick
def test_what_is_legal_before_the_start_and_after_the_end(slaves):
    """The table of FMI 2.0.5, section 4.2.4, where masters lean on it: rates before initialization, everything to be
    read after the end and, for debugging, after an error."""
    slave = slaves()
    slave.rates(slip_angle=0.5)
    slave.begin(dict(START, command_actuators=False))
    slave.steps(3)
    outputs, along = ("force_y", "moment_z"), (["force_y"], dict(slip_angle=1.0))
    seen = slave.get(*outputs), slave.derivatives(*outputs), slave.directional(*along)
    assert all(seen[1]) and all(seen[2]), "the rate moves it"
    slave.raw.terminate()
    assert (slave.get(*outputs), slave.derivatives(*outputs), slave.directional(*along)) == seen
    assert slave.messages == []
    slave.raw.reset()
    slave.begin(START)
    slave.steps(3)
    seen = slave.get(*outputs), slave.derivatives(*outputs), slave.directional(*along)
    refuse(slave, lambda: slave.set(slip=math.nan), "finite")
    assert (slave.get(*outputs), slave.derivatives(*outputs), slave.directional(*along)) == seen
    # how the last step went is no question after an error
    dll, component, time = slave.raw.dll, ctypes.c_void_p(slave.raw.component), ctypes.c_double()
    assert dll.fmi2GetRealStatus(component, 2, ctypes.byref(time)) == ERROR


def test_instantiation_is_refused_with_a_reason(fmu, slaves):
    slave = slaves()
    raw, callbacks = slave.raw, slave.callbacks
    location = f"file://{slave.folder}/resources".encode()
    guid = slave.description.guid.encode()

    def instantiate(name=b"tire", kind=1, guid=guid, location=location):
        slave.messages.clear()
        raw.dll.fmi2Instantiate.restype = ctypes.c_void_p
        return raw.dll.fmi2Instantiate(name, kind, guid, location, ctypes.byref(callbacks), 0, 0)

    for arguments, words in [
        (dict(guid=b"{00000000-0000-0000-0000-000000000000}"), "GUID"),
        (dict(guid=None), "GUID"),
        (dict(name=b"  "), "name"),
        (dict(name=None), "name"),
        (dict(kind=0), "co-simulation"),
        (dict(location=b"file:///nowhere/resources"), "/nowhere/resources/model.toml"),
        (dict(location=b"http://example.org/"), "file:"),
    ]:
        assert instantiate(**arguments) is None
        assert len(slave.messages) == 1 and words in slave.messages[0][2], slave.messages
    # without a location the FMU knows where it lies; with odd ones it reads URIs as they are defined
    for location in (None, b"", f"file:{slave.folder}/resources".encode(), f"file://localhost{slave.folder}/%72esources/".encode()):
        component = instantiate(location=location)
        assert component, slave.messages
        raw.dll.fmi2FreeInstance(ctypes.c_void_p(component))
    # no callbacks: nothing to log to, but no crash either
    assert raw.dll.fmi2Instantiate(b"tire", 1, guid, location, None, 0, 0) is None


def test_messages_are_safe_for_printf(slaves):
    slave = slaves()
    refuse(
        slave,
        lambda: slave.raw.setDebugLogging(True, ["50% #r1#"]),
        "50%% ##r1##",
    )


def test_log_categories(slaves):
    slave = slaves()
    slave.raw.setDebugLogging(True, ["logEvents"])
    slave.begin(START)
    assert [m[1] for m in slave.messages] == ["logEvents"] * 2
    slave.raw.setDebugLogging(False, [])
    slave.messages.clear()
    slave.raw.reset()
    assert slave.messages == []


def test_no_words_on_standard_streams(slaves, capfd):
    slave = slaves(START)
    refuse(slave, lambda: slave.raw.doStep(0.0, -1.0), "positive")
    out, err = capfd.readouterr()
    assert out == "" and err == ""


def test_derivatives_cannot_lead_out_of_the_range(slaves):
    slave = slaves(START)
    slave.rates(camber=20.0)
    slave.steps(20)
    refuse(slave, lambda: slave.steps(20, 0.02), "camber", "range -0.6 to 0.6")
    assert abs(slave.get("actual_camber")[0]) <= 0.6 + 1e-9
    recover(slave)


def test_a_failed_step_leaves_the_last_values(slaves):
    slave = slaves(START)
    slave.raw.reset()
    slave.raw.setInteger([slave.references["bristles_per_stripe"]], [13])
    slave.begin(START)
    slave.steps(10)
    before = slave.outputs()
    slave.set(deflection=0.06)
    with pytest.raises(FMICallException):
        slave.raw.doStep(0.01, 1.0)
    assert "ring of bristles" in slave.messages[-1][2]
    assert slave.outputs() == before


def test_every_byte_of_a_state_counts(slaves):
    slave = slaves(START)
    slave.steps(3)
    state = slave.raw.getFMUState()
    data = slave.raw.serializeFMUState(state)
    for position in [*range(60), *range(60, len(data), 97), len(data) - 1]:
        damaged = bytearray(data)
        damaged[position] ^= 0x10
        with pytest.raises(FMICallException):
            slave.raw.deserializeFMUState(bytes(damaged))
        slave.raw.setFMUState(state)
    for length in (0, 1, 40, len(data) - 1):
        with pytest.raises(FMICallException):
            slave.raw.deserializeFMUState(data[:length])
        slave.raw.setFMUState(state)
