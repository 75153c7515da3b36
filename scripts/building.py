"""What the studies run: programs built by cargo."""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def build(release, *commands):
    """Builds packages, those of each command together; returns the folder of what came out. Unless it is for a release, where a
    library has no more in it than it needs, all packages are built together: as tests have them already."""
    selections = [[word for package in packages for word in ("--package", package)] for packages in commands]
    for selection in selections if release else [["--workspace"]]:
        command = ["cargo", "build", "--locked", *selection, *(["--release"] if release else [])]
        if subprocess.run(command, cwd=ROOT).returncode != 0:
            sys.exit(f"{pathlib.Path(sys.argv[0]).name}: the build failed")
    done = subprocess.run(
        ["cargo", "metadata", "--format-version", "1", "--no-deps", "--offline"], cwd=ROOT, capture_output=True, text=True
    )
    if done.returncode != 0:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: cargo metadata failed: {done.stderr.strip()}")
    return pathlib.Path(json.loads(done.stdout)["target_directory"]) / ("release" if release else "debug")
