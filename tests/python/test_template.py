"""A user's own model: the template copied out of the repository, with the oscillator of its README."""

import math
import re
import zipfile

import fmpy.fmi1
import pytest

from conftest import Slave, latsch

FATAL = 4


def test_oscillator_swings_as_it_should(template_library, tmp_path):
    path = tmp_path / "oscillator.fmu"
    done = latsch("export", "oscillator", "--library", template_library, "--output", path)
    assert done.returncode == 0, done.stderr
    slave = Slave(path)
    slave.begin(dict(force=10.0))
    assert slave.get("position") == [0.1]
    slave.set(force=0.0)
    for k in range(200):
        # released: 0.1 m cos(10 t); symplectic Euler with 1e-4 s is within 1e-4 m
        assert slave.get("position")[0] == pytest.approx(0.1 * math.cos(10 * k * 0.01), abs=1e-4)
        assert slave.derivatives("position")[0] == pytest.approx(-math.sin(10 * k * 0.01), abs=2e-3)
        assert slave.derivatives("position", order=2) == [0.0]
        slave.raw.doStep(k * 0.01, 0.01)
    slave.close()


def test_our_own_importer_runs_it_too(template_library, tmp_path):
    path = tmp_path / "oscillator.fmu"
    assert latsch("export", "oscillator", "--library", template_library, "--output", path).returncode == 0
    done = latsch("simulate", path, "--set", "force=10", "--set", "stiffness=0.4 kN/m", "--output",
                  tmp_path / "o.csv", "--report", tmp_path / "o.html")
    assert done.returncode == 0, done.stderr
    last = (tmp_path / "o.csv").read_text().splitlines()[-1].split(",")
    assert float(last[0]) == 1.0 and float(last[2]) == pytest.approx(0.025)
    assert "position" in (tmp_path / "o.html").read_text()


def test_the_authors_documentation_is_in_the_fmu(template_library, tmp_path):
    path = tmp_path / "oscillator.fmu"
    assert latsch("export", "oscillator", "--library", template_library, "--output", path).returncode == 0
    with zipfile.ZipFile(path) as archive:
        page = archive.read("documentation/index.html").decode()
    assert "<h2>Equations</h2>" in page and "<mi>x</mi>" in page
    for name in ["mass", "stiffness", "force", "position"]:
        assert f"<code>{name}</code>" in page


def test_a_panic_says_what_and_where(template_library, tmp_path):
    path = tmp_path / "bomb.fmu"
    assert latsch("export", "bomb", "--library", template_library, "--output", path).returncode == 0
    slave = Slave(path)
    slave.begin(dict(fuse=0.0))
    slave.raw.doStep(0.0, 1e-3)
    slave.set(fuse=1.0)
    for call, name, words, before in [
        (lambda: slave.raw.doStep(1e-3, 1e-3), "fmi2DoStep", "boom", None),
        (lambda: slave.begin(dict(fuse=2.0)), "fmi2ExitInitializationMode", "boom at the start", "new"),
    ]:
        if before:
            slave.close()
            slave = Slave(path)
        with pytest.raises(fmpy.fmi1.FMICallException):
            call()
        (status, _, message), = slave.messages
        assert status == FATAL and message.startswith(f"{name}: ") and f": {words}." in message
        assert re.search(r"src/lib\.rs:\d+: ", message), message
    slave.close()
    # a master's user sees it too
    done = latsch("simulate", path, "--set", "fuse=1", "--output", tmp_path / "x.csv")
    assert done.returncode != 0 and "boom" in done.stderr and "src/lib.rs:" in done.stderr


def test_an_output_that_is_no_number_is_an_error_that_names_it(template_library, tmp_path):
    path = tmp_path / "bomb.fmu"
    assert latsch("export", "bomb", "--library", template_library, "--output", path).returncode == 0
    slave = Slave(path)
    slave.begin(dict(fuse=0.0))
    slave.set(fuse=-1.0)
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.raw.doStep(0.0, 1e-3)
    (status, _, message), = slave.messages
    assert status == 3 and message.startswith("fmi2DoStep: left = NaN after the step to 0.001 s"), message
    slave.close()


def test_an_fmu_with_several_binaries(template_library, tmp_path):
    path, dll = tmp_path / "both.fmu", tmp_path / "models.dll"
    dll.write_bytes(b"MZ and so on")
    export = ["export", "oscillator", "--library", template_library, "--output", path]
    both = ["--binary", f"linux64={template_library}", "--binary", f"win64={dll}"]
    done = latsch(*export, *both)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(path) as archive:
        names = [n for n in archive.namelist() if n.startswith("binaries/")]
        assert names == ["binaries/linux64/oscillator.so", "binaries/win64/oscillator.dll"]
        assert archive.read(names[0]) == template_library.read_bytes()
    for wrong, words in [
        ([*both, "--binary", f"win64={dll}"], "two binaries for win64"),
        (["--binary", f"linux64={dll}"], "no library for linux64"),
        (["--binary", "amiga=x"], "no platform"),
        (["--binary", "win64"], "PLATFORM=FILE"),
        (["--binary", f"win64={tmp_path}/nothing.dll"], "nothing.dll"),
    ]:
        done = latsch(*export, *wrong)
        assert done.returncode == 2 and words in done.stderr, done.stderr


def test_export_refuses_what_is_no_model_library(template_library, tmp_path):
    done = latsch("export", "pendulum", "--library", template_library, "--output", tmp_path / "x.fmu")
    assert done.returncode == 2 and "oscillator" in done.stderr
    other = tmp_path / "libother.so"
    other.write_bytes(b"\x7fELF no")
    done = latsch("export", "oscillator", "--library", other, "--output", tmp_path / "x.fmu")
    assert done.returncode == 2 and "libother.so" in done.stderr
    assert not (tmp_path / "x.fmu").exists()
