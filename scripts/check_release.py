"""Runs what was released: FMUs with linux64 in FMPy, every binary that can be run here in a host in C, bit for bit, and the
programs of all systems on one of the FMUs.

    check_release.py [--program PLATFORM=PATH]... F.fmu...
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import tempfile

import fmpy
import fmpy.validation
import numpy as np

DATA = pathlib.Path(__file__).resolve().parents[1] / "tests" / "data"
MINGW, ARM = "x86_64-w64-mingw32-gcc", "aarch64-linux-gnu-gcc"
# what the programs simulate
TRIED = "ring-brush-wheel.fmu"


class System:
    """How a platform's binaries are run here: what is put before them, what makes programs for it."""

    def __init__(self, platform, folder):
        self.platform, self.folder = platform, folder
        self.environment = dict(os.environ, WINEDEBUG="-all", WINEPREFIX=str(folder / "wine"))
        # wine shows the root of the file system as the drive Z
        self.drive = "Z:" if platform == "win64" else ""
        self.runner, self.compiler, self.lacks = [], "cc", None
        if platform == "win64":
            self.need([shutil.which("wine64") or "/usr/lib/wine/wine64"], MINGW, "wine64 and " + MINGW)
        elif platform == "aarch64-linux":
            self.need(["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], ARM, "qemu-user and " + ARM)

    def need(self, runner, compiler, words):
        self.runner, self.compiler = runner, compiler
        if not (shutil.which(runner[0]) and shutil.which(compiler)):
            self.lacks = words

    def run(self, *command):
        done = subprocess.run(
            [*self.runner, *map(str, command)], capture_output=True, text=True, env=self.environment, timeout=1200, cwd=self.folder
        )
        assert done.returncode == 0, (command, done.returncode, done.stdout[-1000:], done.stderr[-1000:])
        return done.stdout

    def uri(self, path):
        return f"file:///{self.drive}{path}" if self.drive else f"file://{path}"


def driven(variables):
    """The input that moves: the slip, or what there is first."""
    inputs = [v for v in variables if v.type == "Real" and v.causality == "input"]
    return next((v for v in inputs if v.name == "slip"), inputs[0])


def run_host(system, fmu, library, resources):
    """What the host prints of a binary of a system."""
    program = system.folder / f"step-{system.compiler}.exe"
    if not program.exists():
        # -w: functions are called through one untyped pointer
        links = [] if system.drive else ["-ldl"]
        subprocess.run([system.compiler, "-w", "-std=gnu11", "-o", program, DATA / "step.c", *links], check=True)
    description = fmpy.read_model_description(str(fmu))
    reals = [v for v in description.modelVariables if v.type == "Real"]
    outputs = [v.valueReference for v in reals if v.causality == "output"]
    lines = system.run(
        program, f"{system.drive}{library}", description.guid, system.uri(resources), driven(reals).valueReference, *outputs
    ).split()
    assert len(lines) == 500 * len(outputs)
    return lines


def check(fmu, folder):
    """An FMU: in FMPy, and all its binaries in the host."""
    assert fmpy.validation.validate_fmu(str(fmu)) == []
    moved = driven(fmpy.read_model_description(str(fmu)).modelVariables).name
    start = {"slip": 0.03} if moved == "slip" else {}
    result = fmpy.simulate_fmu(str(fmu), stop_time=1.0, output_interval=1e-3, start_values=start)
    assert len(result) == 1001 and all(np.isfinite(result[name]).all() for name in result.dtype.names)
    print(f"{fmu}: linux64 runs in FMPy")

    unpacked = pathlib.Path(fmpy.extract(str(fmu), str(folder / "fmu")))
    name, expected = fmu.stem.replace("-", "_"), None
    for platform, ending in {"linux64": "so", "aarch64-linux": "so", "win64": "dll"}.items():
        system = System(platform, folder)
        library = unpacked / "binaries" / platform / f"{name}.{ending}"
        if not library.exists():
            print(f"{fmu}: has no {platform}")
        elif system.lacks:
            print(f"{fmu}: {platform} was NOT RUN: {system.lacks} are needed here")
        else:
            got = run_host(system, fmu, library, unpacked / "resources")
            expected = expected or got
            assert got == expected, f"{platform} gives other bits than linux64"
            print(f"{fmu}: {platform} gives linux64's bits, {len(got)} numbers")


def check_programs(programs, fmu, folder):
    """The program of each system simulates an FMU as that of the first one does, to the byte, and exports one; it checks it where
    it can start itself, which it cannot inside qemu."""
    expected = None
    for platform, program in programs.items():
        system = System(platform, folder)
        if system.lacks:
            print(f"{program.name}: {platform} was NOT RUN: {system.lacks} are needed here")
            continue
        own = folder / platform
        shutil.copytree(program.parent, own)
        if platform == "win64":
            library = own / "bcryptprimitives.dll"
            subprocess.run([MINGW, "-shared", "-o", library, DATA / "bcryptprimitives.c", "-ladvapi32"], check=True)
        shutil.copy(fmu, folder)
        system.run(own / program.name, "simulate", fmu.name, "--stop", "0.5", "--set", "brake_torque=900", "--output", "results.csv")
        results = (folder / "results.csv").read_bytes()
        expected = expected or results
        assert results == expected, f"{platform}: the program gives other results"
        system.run(own / program.name, "export", fmu.stem, "--output", "own.fmu")
        said = system.run(own / program.name, "check", "own.fmu") if platform != "aarch64-linux" else ""
        print(f"{program.name}: {platform} simulates and exports {said.strip()}")


parser = argparse.ArgumentParser()
parser.add_argument("--program", action="append", default=[])
parser.add_argument("fmus", nargs="+", type=pathlib.Path)
options = parser.parse_args()
for path in options.fmus:
    with tempfile.TemporaryDirectory() as temporary:
        check(path, pathlib.Path(temporary))
all_programs = {platform: pathlib.Path(path) for platform, path in (p.split("=", 1) for p in options.program)}
with tempfile.TemporaryDirectory() as temporary:
    check_programs(all_programs, next(f for f in options.fmus if f.name == TRIED), pathlib.Path(temporary))
