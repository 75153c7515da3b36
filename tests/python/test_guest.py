"""An FMU is a guest in somebody else's process: a host in C watches what it does there."""

import os
import pathlib
import shutil
import subprocess

import fmpy
import pytest

from conftest import ROOT, latsch


@pytest.fixture(scope="session")
def program(tmp_path_factory):
    path = tmp_path_factory.mktemp("host") / "guest"
    source = ROOT / "tests" / "data" / "guest.c"
    done = subprocess.run(
        ["cc", "-O1", "-Wall", "-Wextra", "-Werror", "-o", path, source, "-lpthread", "-ldl", "-lm"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return path


class Host:
    """Runs the host on an FMU."""

    def __init__(self, program, fmu):
        self.program = program
        description = fmpy.read_model_description(str(fmu))
        self.folder = pathlib.Path(fmpy.extract(str(fmu)))
        [library] = (self.folder / "binaries" / "linux64").iterdir()
        variables = {v.name: v for v in description.modelVariables}
        inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        moved = "slip" if "slip" in inputs else inputs[0]
        outputs = [str(v.valueReference) for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        self.arguments = [
            library,
            description.guid,
            f"file://{self.folder}/resources",
            variables[moved].valueReference,
            variables["stripes"].valueReference if "stripes" in variables else 0,
            ",".join(outputs),
        ]

    def run(self, *what, timeout=300):
        before = self.files()
        done = subprocess.run(
            list(map(str, [self.program, *self.arguments, *what])),
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=timeout,
            # glibc's caches of freed memory would count as allocated
            env=dict(os.environ, GLIBC_TUNABLES="glibc.malloc.tcache_count=0"),
        )
        assert done.returncode == 0, (done.stdout, done.stderr)
        assert done.stderr == ""
        assert self.files() == before
        return done.stdout

    def files(self):
        """Everything in the FMU's folder, which is also the working folder."""
        return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="session")
def host(program, fmu):
    host = Host(program, fmu)
    yield host
    shutil.rmtree(host.folder, ignore_errors=True)


def test_no_growth_over_many_instances(host):
    print(host.run("made", 20_000))


def test_no_growth_over_many_runs(host):
    print(host.run("run", 2000))


def test_many_threads_get_the_bits_of_one(host):
    assert host.run("threads", 16) == ""


def test_the_hosts_floating_point_settings_neither_change_nor_matter(host):
    assert host.run("floats") == ""


def test_it_leaves_no_traces_and_unloads(host):
    assert host.run("traces") == ""


def test_a_state_continues_in_another_process(host, tmp_path):
    path = tmp_path / "state"
    there = host.run("save", path)
    assert len(there.split()) > 5 and path.stat().st_size > 1000
    assert host.run("continue", path) == there


def test_a_panic_is_a_message_and_does_not_keep_the_library(program, template_library, tmp_path):
    path = tmp_path / "bomb.fmu"
    done = latsch("export", "bomb", "--library", template_library, "--output", path)
    assert done.returncode == 0, done.stderr
    host = Host(program, path)
    assert host.run("panic") == ""
    shutil.rmtree(host.folder)
