"""Runs released FMUs: linux64 in FMPy, and every binary that can be run here in a host in C, bit for bit."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import fmpy
import fmpy.validation
import numpy as np

HOST = pathlib.Path(__file__).resolve().parents[1] / "tests" / "data" / "step.c"
WINE = shutil.which("wine64") or next(filter(os.path.exists, ["/usr/lib/wine/wine64"]), None)


def driven(variables):
    """The input that moves: the slip, or what there is first."""
    inputs = [v for v in variables if v.type == "Real" and v.causality == "input"]
    return next((v for v in inputs if v.name == "slip"), inputs[0])


def run_host(compiler, runner, folder, fmu, library, resources):
    """What the host prints; `compiler` makes it, `runner` is put before it."""
    program = folder / f"step-{compiler}.exe"
    # -w: functions are called through one untyped pointer
    subprocess.run([compiler, "-w", "-std=gnu11", "-o", program, HOST, *([] if runner else ["-ldl"])], check=True)
    description = fmpy.read_model_description(str(fmu))
    reals = [v for v in description.modelVariables if v.type == "Real"]
    moved = driven(reals).valueReference
    outputs = [v.valueReference for v in reals if v.causality == "output"]
    environment = dict(os.environ, WINEDEBUG="-all", WINEPREFIX=str(folder / "wine"))
    done = subprocess.run(
        [*runner, *map(str, [program, library, description.guid, resources, moved, *outputs])],
        capture_output=True, text=True, env=environment, timeout=600,
    )
    assert done.returncode == 0, (done.returncode, done.stdout[-500:], done.stderr[-500:])
    lines = done.stdout.split()
    assert len(lines) == 500 * len(outputs)
    return lines


def check(fmu, folder):
    assert fmpy.validation.validate_fmu(str(fmu)) == []
    moved = driven(fmpy.read_model_description(str(fmu)).modelVariables).name
    start = {"slip": 0.03} if moved == "slip" else {}
    result = fmpy.simulate_fmu(str(fmu), stop_time=1.0, output_interval=1e-3, start_values=start)
    assert len(result) == 1001 and all(np.isfinite(result[name]).all() for name in result.dtype.names)
    print(f"{fmu}: linux64 runs in FMPy")

    unpacked = pathlib.Path(fmpy.extract(str(fmu), str(folder / "fmu")))
    name = fmu.stem.replace("-", "_")
    linux = unpacked / "binaries" / "linux64" / f"{name}.so"
    expected = run_host("cc", [], folder, fmu, linux, f"file://{unpacked}/resources")
    windows = unpacked / "binaries" / "win64" / f"{name}.dll"
    if not windows.exists():
        print(f"{fmu}: has no win64")
    elif WINE is None:
        print(f"{fmu}: win64 was NOT RUN: there is no wine64 here")
    else:
        # wine shows the root of the file system as the drive Z
        got = run_host("x86_64-w64-mingw32-gcc", [WINE], folder, fmu, f"Z:{windows}", f"file:///Z:{unpacked}/resources")
        assert got == expected, "win64 gives other bits than linux64"
        print(f"{fmu}: win64 gives linux64's bits under wine, {len(got)} numbers")


for argument in sys.argv[1:]:
    with tempfile.TemporaryDirectory() as temporary:
        check(pathlib.Path(argument), pathlib.Path(temporary))
