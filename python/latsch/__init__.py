"""Tires, rigs and vehicles of latsch from Python: models, FMUs, curves, parameters, diagnoses.

Everything is done by the program `latsch` that is inside this package; what it refuses is raised as LatschError with its message.
Quantities are in SI units unless a recording says otherwise; signs are those of ISO 8855.
"""

from __future__ import annotations

import csv
import html
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np

with warnings.catch_warnings():
    # a notebook without widgets gets bars of text
    warnings.simplefilter("ignore")
    from tqdm.auto import tqdm

__all__ = [
    "Characteristics", "Diagnosis", "Identification", "LatschError", "Page", "Recording",
    "characterize", "describe", "diagnose", "export", "identify", "main", "models", "program", "rig_program", "simulate",
]

PathLike = Union[str, "os.PathLike[str]"]
Value = Union[float, int, bool, str]


class LatschError(Exception):
    """What the program refused or could not do. `exit_code` is 1 where a model left its validity, 2 where the call or a file is wrong."""

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message)
        self.exit_code = exit_code


@dataclass
class Recording(Mapping[str, np.ndarray]):
    """Channels over one time, by name; `recording["force_y"]` is an array."""

    time: np.ndarray
    """In seconds."""
    channels: dict[str, np.ndarray]
    units: dict[str, str]
    """Of the channels."""
    notes: list[str] = field(default_factory=list)
    """What the program said beside the result."""

    def __getitem__(self, name: str) -> np.ndarray:
        return self.time if name == "time" else self.channels[name]

    def __iter__(self):
        return iter(self.channels)

    def __len__(self) -> int:
        return len(self.channels)

    @classmethod
    def read(cls, path: PathLike) -> Recording:
        """Reads a CSV file as latsch writes it."""
        with open(path, newline="", encoding="utf-8") as file:
            head = next(csv.reader(file))
            values = np.loadtxt(file, delimiter=",", ndmin=2)
        titles = [re.fullmatch(r"(.*?)\s*\[(.*)\]", title, re.DOTALL) for title in head]
        names = [title[1] for title in titles if title]
        units = {title[1]: title[2] for title in titles if title}
        del units["time"]
        columns = dict(zip(names, values.T, strict=True))
        return cls(columns.pop("time"), columns, units)

    def write(self, path: PathLike) -> None:
        """Writes a CSV file that latsch reads."""
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time [s]", *(f"{name} [{self.units[name]}]" for name in self.channels)])
            rows = np.column_stack([self.time, *self.channels.values()])
            writer.writerows([[repr(value) for value in row] for row in rows.tolist()])


@dataclass
class Page:
    """An HTML page that needs nothing else. A notebook shows it."""

    html: str = field(repr=False)

    def save(self, path: PathLike) -> None:
        pathlib.Path(path).write_text(self.html, encoding="utf-8")

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.html)}" style="width:100%;height:40em;border:0"></iframe>'


@dataclass
class Characteristics:
    """Curves of tires and what is read from them."""

    curves: dict[str, np.ndarray]
    """All states as columns: `tire`, `curve`, and numbers in SI units by name, such as `slip_angle` and `force_y`."""
    readings: list[dict[str, Any]]
    """`tire`, `reading`, `load` in N, `value` (not a number where there is none), `unit`."""
    page: Page
    notes: list[str]

    def reading(self, name: str, load: float, tire: str | None = None) -> float:
        """The number called `name` at a load in N, of a tire, or of the only one."""
        found = [r["value"] for r in self.readings if r["reading"] == name and r["load"] == load and tire in (None, r["tire"])]
        if len(found) > 1:
            raise KeyError(f"{name!r} is there of each tire: say which, of {self._all('tire')}")
        if not found:
            of = "" if tire is None else f" of {tire!r}"
            raise KeyError(f"there is no {name!r} at {load} N{of}; readings are {self._all('reading')}, loads {self._all('load')}, tires {self._all('tire')}")
        return found[0]

    def _all(self, key: str) -> str:
        return ", ".join(map(str, dict.fromkeys(r[key] for r in self.readings)))


@dataclass
class Identification:
    """Parameters that recordings tell."""

    result: dict[str, Any]
    """Everything, as `latsch identify --format json` prints it."""
    parameters: str
    """TOML for `export` and `simulate`."""
    page: Page
    notes: list[str]


@dataclass
class Diagnosis:
    """Where recordings and a model differ, and why."""

    result: dict[str, Any]
    """The content of diagnosis.json."""
    page: Page
    notes: list[str]

    @property
    def verdict(self) -> str:
        return self.result["verdict"]


def program() -> pathlib.Path:
    """The program inside this package."""
    return pathlib.Path(__file__).parent / "bin" / ("latsch.exe" if sys.platform == "win32" else "latsch")


def _environment() -> dict[str, str]:
    library = next((pathlib.Path(__file__).parent / "lib").glob("*latsch_fmu.*"))
    return {"LATSCH_LIBRARY": str(library), **os.environ}


def _run(*arguments: object) -> tuple[str, list[str]]:
    """What the program printed, and its notes and warnings. How far it is shows in notebooks and on terminals, if it takes a second."""
    command = [program(), "--color", "never", "--progress", "json", *map(str, arguments)]
    printed, said = [], []
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8", env=_environment()) as running,
        tqdm(total=100, disable=not _is_watched(), delay=1, leave=False) as bar,
    ):
        reader = threading.Thread(target=lambda: printed.append(running.stdout.read()))
        reader.start()
        try:
            for line in running.stderr:
                if not line.startswith('{"progress":'):
                    said.append(line.rstrip("\n"))
                    continue
                share, what = (json.loads(line)[key] for key in ("progress", "what"))
                if share is None:
                    # nothing more is said of it: it shows at once
                    bar.delay, bar.bar_format = 0, "{desc} ..."
                else:
                    bar.bar_format = "{desc} {percentage:.0f} %|{bar}| {elapsed}"
                bar.set_description_str(what, refresh=share is None)
                bar.update(100 * (share or 0) - bar.n)
        except BaseException:
            # it tidies up
            running.terminate()
            raise
        finally:
            reader.join()
    if running.returncode != 0:
        text = "\n".join(said).strip() or printed[0].strip()
        raise LatschError(text.removeprefix("error: "), running.returncode)
    return printed[0], [line for line in said if line]


def _is_watched() -> bool:
    """Whether somebody sees what is written on the standard error: on a terminal, or in a notebook, which is none."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return sys.stderr.isatty() or getattr(shell, "kernel", None) is not None


def _text(value: Value) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    return str(value)


def _toml(value: Value) -> str:
    if isinstance(value, (bool, np.bool_)):
        return _text(value)
    return json.dumps(value) if isinstance(value, str) else repr(float(value))


def _given(folder: pathlib.Path, parameters: Mapping[str, Value] | PathLike | None, tire: PathLike | None) -> list[object]:
    """Arguments for parameters: a file, or a dictionary of numbers or texts with a unit."""
    arguments: list[object] = [] if tire is None else ["--tire", tire]
    if isinstance(parameters, Mapping):
        path = folder / "parameters.toml"
        lines = [f"{json.dumps(name)} = {_toml(value)}" for name, value in parameters.items()]
        path.write_text("\n".join(["[parameters]", *lines, ""]), encoding="utf-8")
        return [*arguments, "--parameters", path]
    return arguments if parameters is None else [*arguments, "--parameters", parameters]


def _options(**options: object) -> list[object]:
    """`--name value` of all that are given; lists with commas."""
    arguments: list[object] = []
    for name, value in options.items():
        if value is None:
            continue
        if isinstance(value, Iterable) and not isinstance(value, str):
            value = ",".join(map(str, value))
        arguments += [f"--{name.replace('_', '-')}", value]
    return arguments


def _recordings(folder: pathlib.Path, recordings: Mapping[str, Recording] | PathLike) -> PathLike:
    """A folder of recordings: the given one, or one that is made of recordings by name."""
    if not isinstance(recordings, Mapping):
        return recordings
    made = folder / "recordings"
    made.mkdir()
    for name, recording in recordings.items():
        recording.write(made / f"{name}.csv")
    return made


def _temporary() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="latsch-")


def models() -> list[dict[str, str]]:
    """The models that are shipped: `name` and `description`."""
    return json.loads(_run("models", "--format", "json")[0])


def describe(model: PathLike) -> dict[str, Any]:
    """A model or an FMU: `name`, `description`, and `variables` with units, defaults and ranges."""
    return json.loads(_run("describe", model, "--format", "json")[0])


def export(
    model: str,
    output: PathLike,
    *,
    parameters: Mapping[str, Value] | PathLike | None = None,
    tire: PathLike | None = None,
    fmi: int = 2,
) -> pathlib.Path:
    """Writes a model as an FMU of FMI 2.0 or 3.0 with parameters, given as a dictionary or a TOML file, or from a tire property
    file."""
    with _temporary() as folder:
        _run("export", model, *_given(pathlib.Path(folder), parameters, tire), "--fmi", fmi, "--output", output)
    return pathlib.Path(output)


def simulate(
    model: PathLike,
    inputs: Recording | PathLike | None = None,
    *,
    values: Mapping[str, Value] | None = None,
    parameters: Mapping[str, Value] | PathLike | None = None,
    tire: PathLike | None = None,
    start: float | None = None,
    stop: float | None = None,
    step: float | None = None,
    interval: float | None = None,
    channels: Iterable[str] | None = None,
    all: bool = False,
) -> Recording:
    """Runs a model or an FMU along recorded inputs. `values` are parameters and inputs for the whole run, numbers or texts with a unit."""
    with _temporary() as name:
        folder = pathlib.Path(name)
        if isinstance(inputs, Recording):
            inputs.write(folder / "inputs.csv")
            inputs = folder / "inputs.csv"
        sets = [f"--set={name}={_text(value)}" for name, value in (values or {}).items()]
        options = _options(inputs=inputs, start=start, stop=stop, step=step, interval=interval, channels=channels)
        output = folder / "results.csv"
        _, notes = _run(
            "simulate", model, *options, *sets, *_given(folder, parameters, tire), "--output", output, *(["--all"] if all else [])
        )
        result = Recording.read(output)
    result.notes = notes
    return result


def characterize(
    *tires: PathLike,
    loads: Iterable[float | str] | None = None,
    speeds: Iterable[float | str] | None = None,
    friction: Iterable[float] | None = None,
    slip_angle: float | str | None = None,
    slip: float | str | None = None,
    camber: float | str | None = None,
) -> Characteristics:
    """Measures tires on a flat track: names of models, with a file of parameters behind an @, or FMUs."""
    with _temporary() as name:
        folder = pathlib.Path(name)
        options = _options(loads=loads, speeds=speeds, friction=friction, slip_angle=slip_angle, slip=slip, camber=camber)
        _, notes = _run("characterize", *tires, *options, "--output", folder)
        with open(folder / "curves.csv", newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        names = [title.split(" [")[0] for title in head]
        columns = {
            name: np.array(column if name in ("tire", "curve") else [float(cell or "nan") for cell in column])
            for name, column in zip(names, zip(*rows, strict=True), strict=True)
        }
        with open(folder / "readings.csv", newline="", encoding="utf-8") as file:
            readings = [
                {"tire": row["tire"], "reading": row["reading"], "load": float(row["load [N]"]),
                 "value": float(row["value"] or "nan"), "unit": row["unit"]}
                for row in csv.DictReader(file)
            ]
        page = Page((folder / "index.html").read_text(encoding="utf-8"))
    return Characteristics(columns, readings, page, notes)


def rig_program(plan: PathLike, output: PathLike) -> pathlib.Path:
    """Writes the measurement programme of a plan, or of a shipped one by its name, into a folder."""
    _run("rig-program", plan, "--output", output)
    return pathlib.Path(output)


def identify(
    plan: PathLike,
    recordings: Mapping[str, Recording] | PathLike,
    *,
    model: PathLike | None = None,
    parameters: Mapping[str, Value] | PathLike | None = None,
    within: Mapping[str, float] | None = None,
    nearest: bool = False,
) -> Identification:
    """Identifies parameters group after group from recordings by name, or from a folder of them.

    `within` says of parameters that recordings do not tell within which share of their value they are known. With `nearest` the
    parameters that come nearest to what was read are the answer where none meet it, in place of an error."""
    with _temporary() as name:
        folder = pathlib.Path(name)
        options = _options(recordings=_recordings(folder, recordings), model=model)
        for parameter, share in (within or {}).items():
            options += ["--within", f"{parameter}={share!r}"]
        if nearest:
            options.append("--nearest")
        printed, notes = _run(
            "identify", plan, *options, *_given(folder, parameters, None), "--format", "json",
            "--output", folder / "parameters-found.toml", "--report", folder / "report.html",
        )
        found = (folder / "parameters-found.toml").read_text(encoding="utf-8")
        page = Page((folder / "report.html").read_text(encoding="utf-8"))
    return Identification(json.loads(printed), found, page, notes)


def diagnose(
    model: PathLike,
    recordings: Mapping[str, Recording] | PathLike,
    *,
    output: PathLike | None = None,
    parameters: PathLike | None = None,
    map: PathLike | None = None,
    jobs: int | None = None,
) -> Diagnosis:
    """Finds where recordings, by name or of a folder, and a model, FMU or wired system differ. `output` keeps all files, the corrected model among them."""
    with _temporary() as name:
        folder = pathlib.Path(output if output is not None else pathlib.Path(name) / "found")
        options = _options(recordings=_recordings(pathlib.Path(name), recordings), parameters=parameters, map=map, jobs=jobs)
        printed, notes = _run("diagnose", model, *options, "--output", folder, "--format", "json")
        page = Page((folder / "report.html").read_text(encoding="utf-8"))
    return Diagnosis(json.loads(printed), page, notes)


def main() -> int:
    """The command line: all arguments go to the program."""
    return subprocess.call([program(), *sys.argv[1:]], env=_environment())
