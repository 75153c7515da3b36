"""RPC III files against two packages of other people: `rpc3-file` and `rpc-reader`."""

import numpy as np
import pytest
import rpc3
from conftest import latsch, read_results
from rpc_reader.rpc_reader import ReadRPC

rpc3.rpc3.progressbar = False
# The greatest number of two bytes that is used. `rpc-reader` divides by 32768 and multiplies by this on top of SCALE.
FULL_SCALE = 32752


def simulated(tmp_path, ending):
    """The same run of a tire, as a file with this ending."""
    file = tmp_path / f"run.{ending}"
    done = latsch("simulate", "magic-formula-wheel", "--set", "initial_speed=20", "--set", "brake_torque=900", "--step",
                  "0.001", "--stop", "1.5", "--output", file)
    assert done.returncode == 0, done.stderr
    return file


@pytest.mark.quick
def test_both_packages_read_what_is_written(tmp_path):
    expected = read_results(simulated(tmp_path, "csv"))
    time = expected.pop("time")
    file = simulated(tmp_path, "rsp")
    channels, header = rpc3.read(str(file))
    assert [c.name for c in channels] == list(expected)
    assert {c.name: c.unit for c in channels}["force_z"] == "N"
    theirs = ReadRPC(file)
    theirs.import_rpc_data_from_file()
    for k, channel in enumerate(channels):
        values = np.array(expected[channel.name])
        resolution = np.abs(values).max() / FULL_SCALE
        assert channel.dt == pytest.approx(1e-3, rel=1e-12) and channel.data.size == len(time)
        # half a step of the resolution, and the rounding of single precision
        most = 0.5 * resolution + 1e-7 * np.abs(values).max()
        assert np.abs(channel.data - values).max() <= most, channel.name
        again = theirs.get_data()[: values.size, k] * 32768 / FULL_SCALE
        assert np.abs(again - values).max() <= most, channel.name
    # one with something in it
    assert np.ptp(expected["force_x"]) > 500
    # frames are whole
    assert theirs.get_data_size() == (2048, len(expected))


def written(file, kind, samples, frame, group):
    """A file of `rpc3-file` with several frames per group, of which the last is not full, and its values."""
    time = np.arange(samples) * 2e-3
    made = {
        "F_z": ("kN", 4.0 + 1.5 * np.sin(9 * time)),
        "travel": ("mm", -12.0 * np.cos(31 * time)),
        "switch": ("V", np.where(time > 1, 5.0, 0.0)),
    }
    channels = [rpc3.Channel(name=name, unit=unit, dt=2e-3, data=values) for name, (unit, values) in made.items()]
    rpc3.write(str(file), channels, datatype=kind, pts_per_group=group,
               extra_params={"PTS_PER_FRAME": frame, "FRAMES": -(-samples // frame)})
    return time, made


@pytest.mark.quick
@pytest.mark.parametrize("kind, frame, group", [(int, 256, 1024), (float, 256, 1024), (int, 512, 512), (float, 64, 2048)])
def test_what_the_package_writes_is_read(tmp_path, kind, frame, group):
    file = tmp_path / "rig.rsp"
    time, made = written(file, kind, 2900, frame, group)
    # the run has the recording's channels beside its own
    plan = tmp_path / "copy.toml"
    plan.write_text(
        'step = 2e-3\nrecord_every = 1\n[component.rig]\nmodel = "magic-formula-hydropulse"\n'
        '[[inputs]]\nfile = "rig.rsp"\nconnect = { F_z = "rig.force" }\n'
    )
    done = latsch("cosimulate", plan, "--output", tmp_path / "out.csv")
    assert done.returncode == 0, done.stderr
    read = read_results(tmp_path / "out.csv")
    unit, values = made["F_z"]
    # an input is what the component had until then: the sample before
    assert len(read["time"]) == time.size and read["time"][-1] == pytest.approx(time[-1], rel=1e-9)
    resolution = np.abs(values).max() / FULL_SCALE if kind is int else 1e-7 * np.abs(values).max()
    assert np.abs(np.array(read["rig.force"][1:]) - 1e3 * values[:-1]).max() <= 1e3 * (0.5001 * resolution + 1e-7 * 5.5)


@pytest.mark.quick
def test_what_is_no_such_file_is_refused(tmp_path):
    file = tmp_path / "rig.rsp"
    written(file, int, 1500, 512, 512)
    whole = file.read_bytes()
    for damaged, words in [(whole[:-2], "bytes"), (whole.replace(b"BINARY\0", b"BINARI\0"), "BINARI"),
                           (whole.replace(b"TIME_HISTORY", b"HISTOGRAM\0\0\0"), "HISTOGRAM")]:
        file.write_bytes(damaged)
        done = latsch("loads", file, "--recording", file)
        assert done.returncode == 2 and "rig.rsp" in done.stderr and words in done.stderr, done.stderr
