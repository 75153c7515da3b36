#!/usr/bin/env python3
"""Parameter studies of co-simulated systems, on this machine or on a cluster of Dask: one table of results.

    scripts/sweep.py STUDY.toml [--output F.parquet] [--workers N | --scheduler tcp://HOST:PORT]

Every run is one `latsch cosimulate`. The system, its files and the program are sent to the workers. What is done is
kept beside the table, so that the same command goes on where a study was interrupted. docs/studies.md has the form of
a study, what workers need, and an example. Needs Python 3.11 or newer and scripts/sweep-requirements.txt.

Exit status: 0 all runs are there, 1 some have an error in their row, 2 the study or the command is wrong, 3 the script
itself failed (what is done is kept), 130 interrupted.
"""

import argparse
import csv
import dataclasses
import difflib
import hashlib
import io
import itertools
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import tomllib
import traceback
import xml.etree.ElementTree
import zipfile

import dask
import tomli_w
from distributed import Client, KilledWorker, LocalCluster, WorkerPlugin, as_completed, get_worker, progress

ROOT = pathlib.Path(__file__).resolve().parent.parent
# more runs than this are taken for a mistake in a count
MAX_RUNS = 1_000_000
# the name of the program in the kit, which no study's file has
PROGRAM = ".latsch"
# of the events with rows
TOPIC = "latsch-study-rows"
REDUCTIONS = ["last", "min", "max", "mean"]
# what stands in the column `status`
OK, FAILED, LOST = "ok", "failed", "lost"
# what is kept of a run
ROW = ["status", "error", "warnings", "values"]


class Wrong(Exception):
    """What is wrong with a study or a command, where, and what to do."""


# ---- what a study says


@dataclasses.dataclass
class Result:
    """What is kept of a run: a reduction of a channel, or when a channel is first beyond a value."""

    name: str
    # last, min, max, mean, value or time
    kind: str
    # whose value it is; none for a time
    channel: str | None
    # the channel that is watched, its value, and the sign of "beyond"
    when: str | None = None
    limit: float = 0.0
    above: bool = True
    # only samples of this time [s]
    first: float = -math.inf
    last: float = math.inf

    def channels(self):
        return [c for c in (self.channel, self.when) if c]

    def of(self, time, columns):
        """Of a run; None where there is no sample or no crossing."""
        kept = [i for i, t in enumerate(time) if self.first <= t <= self.last]
        if not kept:
            return None
        t = time[kept[0] : kept[-1] + 1]
        part = {name: columns[name][kept[0] : kept[-1] + 1] for name in self.channels()}
        if self.when:
            return self.at_crossing(t, part[self.when], t if self.kind == "time" else part[self.channel])
        x = part[self.channel]
        if self.kind == "mean":
            if len(t) == 1:
                return x[0]
            # over time, trapezoidal; fsum rounds once, in whatever order a machine would add
            area = math.fsum(0.5 * (x[i] + x[i + 1]) * (t[i + 1] - t[i]) for i in range(len(t) - 1))
            return area / (t[-1] - t[0])
        return {"last": x[-1], "min": min(x), "max": max(x)}[self.kind]

    def at_crossing(self, time, watched, of):
        sign = 1.0 if self.above else -1.0
        for i, value in enumerate(watched):
            if sign * (value - self.limit) > 0.0:
                if i == 0:
                    return of[0]
                # on a straight line between the two communication points
                share = (self.limit - watched[i - 1]) / (value - watched[i - 1])
                return of[i - 1] + share * (of[i] - of[i - 1])
        return None


@dataclasses.dataclass
class Vary:
    """A parameter of the study: its column, what it sets, and its values or its range."""

    name: str
    targets: list
    unit: str | None
    # on a grid
    values: list | None
    # sampled between these
    low: float = 0.0
    high: float = 0.0
    log: bool = False

    def within(self, share):
        """The value at a share of the range."""
        if self.log:
            return math.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
        return self.low + share * (self.high - self.low)

    def column(self):
        return f"{self.name} [{self.unit}]" if self.unit else self.name


class Table:
    """A table of the study, whose keys are taken one after the other; what is left at the end is unknown."""

    def __init__(self, values, place):
        if not isinstance(values, dict):
            raise Wrong(f"{place}: a table is needed, not {shown(values)}")
        self.values, self.place, self.known = dict(values), place, []

    def at(self, key):
        return f"{self.place}{key}"

    def take(self, key, kinds, what, default=None, needed=False):
        self.known.append(key)
        if key not in self.values:
            if needed:
                raise Wrong(f"{self.at(key)}: is missing; {what} is needed")
            return default
        value = self.values.pop(key)
        # true and false are numbers to Python
        if not isinstance(value, kinds) or (isinstance(value, bool) and kinds is not bool):
            raise Wrong(f"{self.at(key)}: {what} is needed, not {shown(value)}")
        return value

    def number(self, key, default=None, needed=False, what="a number"):
        value = self.take(key, (int, float), what, default, needed)
        if value is not default and not math.isfinite(value):
            raise Wrong(f"{self.at(key)}: a finite number is needed, not {shown(value)}")
        return value

    def positive(self, key, default=None):
        value = self.number(key, default, what="a positive number")
        if value is not None and value <= 0:
            raise Wrong(f"{self.at(key)}: a positive number is needed, not {shown(value)}")
        return value

    def whole(self, key, default=None, needed=False, least=1):
        value = self.take(key, int, "a whole number", default, needed)
        if value is not None and value < least:
            raise Wrong(f"{self.at(key)}: a whole number from {least} on is needed, not {value}")
        return value

    def text(self, key, default=None, needed=False, what="a text"):
        return self.take(key, str, what, default, needed)

    def end(self):
        for key in self.values:
            raise Wrong(f"{self.at(key)}: there is no such key; {nearest(key, self.known)}")


def shown(value):
    return json.dumps(value, default=str)


def nearest(name, names):
    near = difflib.get_close_matches(name, names, 3, 0.5)
    return f"did you mean {' or '.join(near)}?" if near else f"there is {', '.join(names)}"


def crossing(table, key):
    """The value behind `above` or `below`, and which of them it is."""
    above, below = table.number("above"), table.number("below")
    if (above is None) == (below is None):
        raise Wrong(f"{key}: either above or below is needed, a number in the channel's unit")
    return (above, True) if below is None else (below, False)


def read_vary(name, entry):
    place = f"vary.{name}"
    if isinstance(entry, list):
        entry = {"values": entry}
    table = Table(entry, place + ".")
    targets = table.take("set", (str, list), "component.variable, or several in [ ],", name)
    targets = [targets] if isinstance(targets, str) else targets
    for target in targets:
        check_target(target, place)
    unit = table.text("unit")
    values = table.take("values", list, "a list of values")
    low, high = table.number("from"), table.number("to")
    count, scale = table.whole("count", least=2), table.text("scale", "linear")
    table.end()
    if scale not in ("linear", "log"):
        raise Wrong(f"{place}.scale: linear or log is needed, not {shown(scale)}")
    if values is not None:
        if low is not None or high is not None or count is not None:
            raise Wrong(f"{place}: either values, or from and to, not both")
        return Vary(name, targets, unit, check_values(values, unit, place))
    if low is None or high is None:
        raise Wrong(f"{place}: values = [...] is needed, or from and to")
    if not low < high:
        raise Wrong(f"{place}: from = {low!r} has to be less than to = {high!r}")
    if scale == "log" and low <= 0:
        raise Wrong(f"{place}.from: a logarithmic scale needs a positive number, not {low!r}")
    vary = Vary(name, targets, unit, None, float(low), float(high), scale == "log")
    if count is not None:
        vary.values = [vary.low, *(vary.within(i / (count - 1)) for i in range(1, count - 1)), vary.high]
    return vary


def check_target(target, place):
    if not isinstance(target, str) or "." not in target:
        raise Wrong(f"{place}: component.variable is needed, not {shown(target)}; a name of your own needs set = \"...\"")


def check_values(values, unit, place):
    kinds = {bool: "true or false", str: "texts", float: "numbers"}
    found = {float if type(v) is int else type(v) for v in values}
    if len(found) != 1 or not found <= kinds.keys():
        raise Wrong(f"{place}.values: numbers are needed, or texts, or true and false, all of one kind, not {shown(values)}")
    values = [float(v) if found == {float} and unit else v for v in values]
    if found == {float} and not all(math.isfinite(v) for v in values):
        raise Wrong(f"{place}.values: finite numbers are needed, not {shown(values)}")
    if unit and found != {float}:
        raise Wrong(f"{place}.unit: only numbers have one")
    for value in values:
        if values.count(value) > 1:
            raise Wrong(f"{place}.values: {shown(value)} is there twice")
    return values


def read_result(name, entry):
    place = f"results.{name}"
    table = Table(entry, place + ".")
    first, last = table.number("from", -math.inf), table.number("to", math.inf)
    reductions = {kind: table.text(kind, what="the name of a channel") for kind in REDUCTIONS}
    given = {kind: channel for kind, channel in reductions.items() if channel is not None}
    value = table.text("value", what="the name of a channel")
    when = table.text("when", what="the name of a channel")
    limit, above = crossing(table, place) if when else (0.0, True)
    table.end()
    if len(given) + (when is not None) != 1 or (value is not None and when is None):
        raise Wrong(f"{place}: one of {', '.join(REDUCTIONS)} is needed, or when with above or below")
    if not first < last:
        raise Wrong(f"{place}: from = {first} s has to be before to = {last} s")
    if when:
        return Result(name, "time" if value is None else "value", value, when, float(limit), above, first, last)
    ((kind, channel),) = given.items()
    return Result(name, kind, channel, first=first, last=last)


class Study:
    """A study file. Everything about it that can be known without a run is checked."""

    def __init__(self, path):
        self.path = path
        try:
            values = tomllib.loads(path.read_text())
        except OSError as error:
            raise Wrong(f"the study cannot be read: {error.strerror}") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise Wrong(f"no TOML: {error}") from None
        table = Table(values, "")
        self.system = table.take("system", (str, dict), "the name of a system's file, or a table of its components,", needed=True)
        self.export = table.take("export", list, "a list of shipped models", [])
        self.start, self.stop = table.number("start"), table.number("stop")
        self.step, self.timeout = table.positive("step"), table.positive("timeout", 3600)
        self.order = table.take("order", list, "a list of components")
        self.record_every = table.whole("record_every", 1)
        self.until = table.take("until", dict, "{ channel = ..., below = ... }")
        self.set = table.take("set", dict, "{ \"component.variable\" = value }", {})
        sample = table.take("sample", dict, "a table")
        vary = table.take("vary", dict, "a table of parameters", needed=True)
        results = table.take("results", dict, "a table of results", needed=True)
        table.end()
        for key in ("export", "order"):
            if not all(isinstance(name, str) for name in getattr(self, key) or []):
                raise Wrong(f"{key}: names are needed, not {shown(getattr(self, key))}")
        if self.until is not None:
            table = Table(self.until, "until.")
            channel = table.text("channel", needed=True, what="the name of a channel")
            self.until = Result("until", "time", None, channel, *crossing(table, "until"))
            table.end()
        for target, value in self.set.items():
            check_target(target, "set")
            check_values([value], None, f"set.{target}")
        self.vary = [read_vary(name, entry) for name, entry in vary.items()]
        self.results = [read_result(name, entry) for name, entry in results.items()]
        for key in ("vary", "results"):
            if not getattr(self, key):
                raise Wrong(f"{key}: is empty")
        taken = ["run", "status", "error", "warnings", "key"]
        for entry in [*self.vary, *self.results]:
            if entry.name in taken:
                raise Wrong(f"{entry.name}: there is a column of that name already; choose another")
            taken.append(entry.name)
        targets = [*self.set, *itertools.chain.from_iterable(v.targets for v in self.vary)]
        for target in targets:
            if targets.count(target) > 1:
                raise Wrong(f"{target}: has two values; only one of set and vary may name it, once")
        self.points = self.design(sample)

    def design(self, sample):
        """The values of each run: all combinations of those on a grid, each with all samples of the others."""
        drawn = [v for v in self.vary if v.values is None]
        samples = [()]
        if sample is not None:
            table = Table(sample, "sample.")
            method = table.text("method", "latin-hypercube")
            count, seed = table.whole("count", needed=True), table.whole("seed", needed=True, least=0)
            table.end()
            if method not in ("latin-hypercube", "random"):
                raise Wrong(f"sample.method: latin-hypercube or random is needed, not {shown(method)}")
            if not drawn:
                raise Wrong("sample: no parameter is sampled; that are those with from and to and without count")
            self.limit(count)
            samples = draw(method, len(drawn), count, seed)
        elif drawn:
            raise Wrong(f"vary.{drawn[0].name}: needs a count for a grid, or the study a table [sample]")
        grid = [v for v in self.vary if v.values is not None]
        self.limit(len(samples) * math.prod(len(v.values) for v in grid))
        points = []
        for values in itertools.product(*(v.values for v in grid)):
            for shares in samples:
                point = dict(zip((v.name for v in grid), values))
                point.update((v.name, v.within(share)) for v, share in zip(drawn, shares))
                points.append({v.name: point[v.name] for v in self.vary})
        return points

    @staticmethod
    def limit(count):
        if count > MAX_RUNS:
            raise Wrong(f"these are {count} runs, more than {MAX_RUNS}; take fewer values")

    def arguments(self, point, stop=None, until=True):
        """Of `latsch cosimulate`, without its output."""
        command = ["--record-every", str(self.record_every)]
        options = {"--start": self.start, "--stop": self.stop if stop is None else stop, "--step": self.step}
        for name, value in options.items():
            command += [name, repr(value)] if value is not None else []
        command += ["--order", ",".join(self.order) or "none"] if self.order is not None else []
        if self.until and until:
            command += ["--until", f"{self.until.when}{'>' if self.until.above else '<'}{self.until.limit!r}"]
        for target, value in self.set.items():
            command += ["--set", f"{target}={written(value)}"]
        for vary in self.vary:
            unit = f" {vary.unit}" if vary.unit else ""
            for target in vary.targets:
                command += ["--set", f"{target}={written(point[vary.name])}{unit}"]
        return command


def written(value):
    """As the program reads it: the shortest text that is the same number."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)


def draw(method, dimensions, count, seed):
    """Shares of the ranges, a row for each sample."""
    # here and not above, as all that only this process needs: workers of a local cluster import this file
    import numpy
    import scipy.stats.qmc

    if method == "random":
        return numpy.random.default_rng(seed).random((count, dimensions)).tolist()
    return scipy.stats.qmc.LatinHypercube(dimensions, rng=seed).random(count).tolist()


# ---- what is sent to the workers


class Kit:
    """The files of a study by their place, as seen from the study's folder, and the program."""

    def __init__(self, study, program):
        self.folder = study.path.resolve().parent
        self.contents = {}
        self.system = None
        self.start, self.step = study.start, study.step
        if isinstance(study.system, dict):
            self.system = self.folder / f"{study.path.stem}.system.toml"
            try:
                text = tomli_w.dumps(study.system)
            except TypeError as error:
                raise Wrong(f"system: {error}") from None
            self.contents[self.system] = text.encode()
        else:
            self.system = pathlib.Path(os.path.normpath(self.folder / study.system))
            self.add(self.system, "system")
        made = self.exported(study.export, program)
        for file, place in self.needed():
            if file in made:
                self.contents[file] = made.pop(file)
            else:
                self.add(file, place)
        for file in made:
            raise Wrong(f"export: {file.stem}: the system names no {file.name} beside it")
        for target, value in [*study.set.items(), *((v.name, x) for v in study.vary for x in v.values or [])]:
            if isinstance(value, str) and value.startswith("@"):
                self.add(self.folder / value[1:], target)
        self.program = program.read_bytes()

    def add(self, file, place):
        if not file.is_file():
            hint = f"; export = [{shown(file.stem)}] makes it, if that is a shipped model" if file.suffix == ".fmu" else ""
            raise Wrong(f"{place}: {os.path.relpath(file, self.folder)}: there is no such file{hint}")
        self.contents[pathlib.Path(os.path.normpath(file))] = file.read_bytes()

    def exported(self, models, program):
        made = {}
        with tempfile.TemporaryDirectory() as folder:
            for model in models:
                file = self.system.parent / f"{model}.fmu"
                if file.exists():
                    raise Wrong(f"export: {model}: {os.path.relpath(file, self.folder)} is there already; take it out of one of both")
                path = pathlib.Path(folder) / "model.fmu"
                done = subprocess.run([program, "export", model, "--output", path], capture_output=True, text=True)
                if done.returncode != 0:
                    raise Wrong(f"export: {model}: {words(done.stderr, 'error')}")
                made[file] = path.read_bytes()
        return made

    def needed(self):
        """The files that the system names, with the place; its start and step as well, where the study has none."""
        text = self.contents[self.system]
        place = "system" if self.system.suffix == ".toml" else self.system.name
        if self.system.suffix == ".toml":
            try:
                values = tomllib.loads(text.decode())
            except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
                raise Wrong(f"{self.system.name}: no TOML: {error}") from None
            self.own(values.get("start"), values.get("step"))
            yield from self.named(values, place)
            return
        if self.system.suffix == ".ssp":
            try:
                text = zipfile.ZipFile(io.BytesIO(text)).read("SystemStructure.ssd")
            except (zipfile.BadZipFile, KeyError) as error:
                raise Wrong(f"{self.system.name}: no SSP: {error}") from None
        elif self.system.suffix != ".ssd":
            raise Wrong(f"system: a .toml, .ssd or .ssp is needed, not {self.system.name}")
        try:
            root = xml.etree.ElementTree.fromstring(text)
        except xml.etree.ElementTree.ParseError as error:
            raise Wrong(f"{self.system.name}: no XML: {error}") from None
        attribute = {key: value for element in root.iter() for key, value in element.items() if key in ("startTime", "baseStepSize")}
        self.own(attribute.get("startTime"), attribute.get("baseStepSize"))
        if self.system.suffix == ".ssd":
            for element in root.iter():
                source = element.get("source")
                if source and not re.match(r"[a-z]+:", source):
                    yield self.beside(source, place), place

    def own(self, start, step):
        try:
            self.start = float(start or 0.0) if self.start is None else self.start
            self.step = float(step) if self.step is None and step is not None else self.step
        except (TypeError, ValueError):
            # the program says what it thinks of them
            self.step = None

    def named(self, values, place):
        components, inputs = values.get("component", {}), values.get("inputs", [])
        for name, component in components.items() if isinstance(components, dict) else []:
            if isinstance(component, dict):
                texts = [component.get("fmu"), component.get("parameters")]
                settings = component.get("set", {})
                points = [v[1:] for v in settings.values() if isinstance(v, str) and v.startswith("@")] if isinstance(settings, dict) else []
                for file in [*texts, *points]:
                    if isinstance(file, str):
                        yield self.beside(file, f"{place}: component.{name}"), f"{place}: component.{name}"
        for entry in inputs if isinstance(inputs, list) else []:
            if isinstance(entry, dict) and isinstance(entry.get("file"), str):
                yield self.beside(entry["file"], f"{place}: inputs"), f"{place}: inputs"

    def beside(self, file, place):
        if pathlib.PurePath(file).is_absolute():
            raise Wrong(f"{place}: {file}: an absolute path is another one on another machine; name the file as seen from the system's")
        return pathlib.Path(os.path.normpath(self.system.parent / file))

    def packed(self):
        """What is sent: places below one folder, contents, the folder to run in, the system."""
        top = pathlib.Path(os.path.commonpath([self.folder, *(file.parent for file in self.contents)]))
        files = {str(file.relative_to(top)): content for file, content in sorted(self.contents.items())}
        files[PROGRAM] = self.program
        digest = hashlib.sha256()
        for name, content in files.items():
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
        return Packed(digest.hexdigest()[:16], files, str(self.folder.relative_to(top)), os.path.relpath(self.system, self.folder))


@dataclasses.dataclass
class Packed:
    name: str
    files: dict
    inside: str
    system: str

    def unpack(self, folder):
        top = pathlib.Path(folder)
        for name, content in self.files.items():
            (top / name).parent.mkdir(parents=True, exist_ok=True)
            (top / name).write_bytes(content)
        (top / PROGRAM).chmod(0o755)
        (top / self.inside).mkdir(parents=True, exist_ok=True)
        return top


# ---- one run


def words(text, kind):
    """What a program's messages of one kind say, or all that it said."""
    lines = [line.removeprefix(f"{kind}: ") for line in text.splitlines() if line.startswith(f"{kind}: ")]
    return "; ".join(lines) or ("" if kind == "warning" else text.strip())


def execute(packed, top, output, arguments, timeout):
    """Runs the program in an unpacked kit; gives the finished process and where its results are."""
    folder = pathlib.Path(top) / packed.inside
    command = [str((pathlib.Path(top) / PROGRAM).resolve()), "cosimulate", packed.system, "--output", output, *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=timeout, stdin=subprocess.DEVNULL)
    return done, folder / output


def read_columns(path, wanted):
    """The time and some columns of a results file, and the units of all."""
    with open(path, newline="") as file:
        header = next(csv.reader([file.readline()]))
        cells = [re.fullmatch(r"(.*) \[(.*)\]", cell) for cell in header]
        units = {cell[1]: cell[2] for cell in cells}
        places = [[cell[1] for cell in cells].index(name) for name in wanted]
        rows = [line.split(",") for line in file]
    return [float(row[0]) for row in rows], {n: [float(row[i]) for row in rows] for n, i in zip(wanted, places)}, units


class Job(WorkerPlugin):
    """What all runs of a study share: on each worker, also on one that comes later or again."""

    def __init__(self, packed, study):
        self.packed, self.results, self.until, self.timeout = packed, study.results, study.until, study.timeout
        self.name = f"latsch-{packed.name}-{os.urandom(4).hex()}"

    def setup(self, worker):
        self.top = self.packed.unpack(pathlib.Path(worker.local_directory) / self.name)

    def answer(self, key, arguments):
        """What the model answers is a row, an error in words too; what befalls the machine is an exception, and tried
        again."""
        output = self.top / self.packed.inside / f"{key}.csv"
        try:
            done, _ = execute(self.packed, self.top, output.name, arguments, self.timeout)
            if done.returncode in (-signal.SIGKILL, -signal.SIGTERM, -signal.SIGHUP, -signal.SIGINT, 126, 127):
                raise RuntimeError(f"the program was ended from outside or cannot run here (status {done.returncode}) {done.stderr.strip()}")
            row = {"status": FAILED, "error": None, "warnings": words(done.stderr, "warning") or None, "values": {}}
            if done.returncode < 0:
                row["error"] = f"the program crashed: {signal.Signals(-done.returncode).name} {words(done.stderr, 'error')}".strip()
            elif done.returncode != 0:
                row["error"] = words(done.stderr, "error") or f"the program ended with status {done.returncode}"
            else:
                self.reduce(output, row)
            return row
        finally:
            output.unlink(missing_ok=True)

    def reduce(self, output, row):
        watched = [self.until] if self.until else []
        time, columns, _ = read_columns(output, sorted({c for r in [*self.results, *watched] for c in r.channels()}))
        infinite = [name for name, values in columns.items() if not all(map(math.isfinite, values))]
        if infinite:
            row["error"] = f"{infinite[0]} is not a finite number"
        elif self.until and not beyond(self.until, last := columns[self.until.when][-1]):
            sign = ">" if self.until.above else "<"
            row["error"] = f"{self.until.when} {sign} {self.until.limit!r} is not reached at the stop time, {time[-1]!r} s; it is {last!r}"
        else:
            row["status"], row["values"] = OK, {r.name: r.of(time, columns) for r in self.results}


def run(key, arguments, job):
    """One run on a worker. The row goes out as an event, which is with the scheduler before the task is done: a result
    would be lost if its worker died before it was fetched."""
    worker = get_worker()
    worker.log_event(TOPIC, {"key": key, **worker.plugins[job].answer(key, arguments)})


def beyond(until, value):
    return value > until.limit if until.above else value < until.limit


# ---- the table


def try_out(study, packed):
    """Runs one step, so that wrong names and files are found before anything else; gives the channels' units."""
    start, step = study.kit.start or 0.0, study.kit.step
    stop = start + step if step else None
    with tempfile.TemporaryDirectory() as folder:
        packed.unpack(folder)
        failed = None
        # a corner of the study may be one that fails: the middle and the end have a say, too
        for index in sorted({0, len(study.points) // 2, len(study.points) - 1}):
            arguments = study.arguments(study.points[index], stop=stop, until=False)
            try:
                done, output = execute(packed, folder, "try.csv", arguments, study.timeout)
            except (OSError, subprocess.TimeoutExpired) as error:
                raise Wrong(f"the program cannot be run: {error}") from None
            if done.returncode == 0:
                break
            failed = failed or words(done.stderr, "error")
        else:
            raise Wrong(f"no run starts, neither the first nor the last nor that in the middle: {failed}")
        _, _, units = read_columns(output, [])
    for result in [*study.results, *([study.until] if study.until else [])]:
        for channel in result.channels():
            if channel not in units:
                place = "until" if result is study.until else f"results.{result.name}"
                raise Wrong(f"{place}: the system has no channel {channel}; {nearest(channel, list(units))}")
    return units


class Store:
    """The table's file, and beside it what is done of a study that is not finished."""

    def __init__(self, path, keys, replace):
        import pyarrow.parquet

        self.path, self.journal = path, path.with_name(path.name + ".journal")
        self.done = {}
        try:
            if path.exists():
                for row in pyarrow.parquet.read_table(path).to_pylist():
                    values = {re.sub(r" \[[^]]*\]$", "", name): value for name, value in row.items()}
                    self.done[row["key"]] = {name: row[name] for name in ("status", "error", "warnings")} | {"values": values}
            if self.journal.exists():
                self.read_journal()
        except (OSError, KeyError, ValueError, pyarrow.ArrowException) as error:
            raise Wrong(f"{path} or its journal is no table of a study: {error}; name another --output") from None
        others = self.done.keys() - keys
        if others and not replace:
            raise Wrong(
                f"{path} has {len(others)} runs that are not of this study with this program; name another --output, or --replace drops them"
            )
        # what befell a machine is no result
        self.done = {key: row for key, row in self.done.items() if key in keys and row["status"] != LOST}

    def read_journal(self):
        lines = self.journal.read_text().split("\n")
        for number, line in enumerate(lines):
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                # the last line may have been cut off
                if number == len(lines) - 1:
                    return
                raise
            self.done[row.pop("key")] = row

    def open(self):
        self.path.parent.mkdir(parents=True, exist_ok=True)
        # anew, with whole lines only
        with open(self.journal.with_name(self.journal.name + ".new"), "w") as file:
            for key, row in self.done.items():
                file.write(json.dumps({"key": key, **row}) + "\n")
        os.replace(file.name, self.journal)
        self.file = open(self.journal, "a")

    def add(self, key, row):
        self.done[key] = row
        if row["status"] != LOST:
            self.file.write(json.dumps({"key": key, **row}) + "\n")
            self.file.flush()

    def write(self, study, keys, units):
        import pyarrow.parquet

        columns = {"run": pyarrow.array(range(1, len(keys) + 1), pyarrow.int64())}
        for vary in study.vary:
            values = [point[vary.name] for point in study.points]
            numbers = not isinstance(values[0], (bool, str))
            columns[vary.column()] = pyarrow.array([float(v) for v in values] if numbers else values)
        for result in study.results:
            unit = units[result.channel] if result.channel else "s"
            values = [self.done[key]["values"].get(result.name) for key in keys]
            columns[f"{result.name} [{unit}]"] = pyarrow.array(values, pyarrow.float64())
        for name in ("status", "error", "warnings"):
            columns[name] = pyarrow.array([self.done[key][name] for key in keys], pyarrow.string())
        columns["key"] = pyarrow.array(keys, pyarrow.string())
        table = pyarrow.table(columns).replace_schema_metadata({"study": study.path.read_text()})
        new = self.path.with_name(self.path.name + ".new")
        pyarrow.parquet.write_table(table, new)
        os.replace(new, self.path)
        self.file.close()
        self.journal.unlink()


def compute(study, keys, commands, packed, store, options):
    """All runs on the cluster; each row is kept as soon as it is there."""
    # a task in the queue of a worker that dies would count as one that killed it: one at a time
    dask.config.set({"distributed.scheduler.allowed-failures": options.retries, "distributed.scheduler.worker-saturation": 1.0})
    with tempfile.TemporaryDirectory() as folder:
        if options.scheduler:
            cluster, client = None, Client(options.scheduler, timeout=30)
        else:
            cluster = LocalCluster(
                n_workers=min(options.workers, len(keys)), threads_per_worker=1, dashboard_address=":0", local_directory=folder
            )
            client = Client(cluster)
        try:
            job = Job(packed, study)
            client.register_plugin(job)
            rows = {}
            client.subscribe_topic(TOPIC, lambda event: rows.update({event[1]["key"]: event[1]}))
            names = [f"latsch-run-{key}-{job.name}" for key in keys]
            futures = client.map(run, keys, commands, job=job.name, key=names, retries=options.retries)
            key_of_name = dict(zip(names, keys))
            if sys.stdout.isatty():
                threading.Thread(target=progress, args=(futures,), daemon=True).start()
            tenth = -(-len(keys) // 10)
            for count, future in enumerate(as_completed(futures), 1):
                row = rows.pop(key_of_name[future.key], None)
                if row is None:
                    error = future.exception() if future.status == "error" else future.status
                    row = {"status": LOST, "error": lost(error, study, options.retries), "warnings": None, "values": {}}
                store.add(key_of_name[future.key], {name: row[name] for name in ROW})
                # let go of it: the cluster need not keep it
                future.release()
                if not sys.stdout.isatty() and count % tenth == 0:
                    print(f"{count} of {len(keys)} runs", flush=True)
        finally:
            client.close()
            if cluster:
                cluster.close()


def lost(error, study, retries):
    attempts = f"with {retries + 1} attempts"
    if isinstance(error, subprocess.TimeoutExpired):
        return f"took longer than the timeout of {study.timeout} s, {attempts}"
    if isinstance(error, KilledWorker):
        return f"no answer from the cluster: every worker died that had this run, {attempts}"
    return f"no answer from the cluster, {attempts}: {type(error).__name__}: {error}"


def key_of(packed, arguments, study):
    """What makes a run that run: the files and the program, what is set, and what is kept."""
    results = [dataclasses.astuple(r) for r in [*study.results, *([study.until] if study.until else [])]]
    return hashlib.sha256(json.dumps([packed.name, packed.system, arguments, results]).encode()).hexdigest()[:16]


def summary(store, keys, path):
    rows = [store.done[key] for key in keys]
    counts = {status: sum(row["status"] == status for row in rows) for status in (OK, FAILED, LOST)}
    print(f"{path}: {len(rows)} runs, " + ", ".join(f"{n} {status}" for status, n in counts.items() if n))
    for kind in ("error", "warnings"):
        texts = [row[kind] for row in rows if row[kind]]
        # runs that say the same but for their numbers are one line
        groups = {}
        for text in texts:
            groups.setdefault(re.sub(r"[-+0-9.e]*\d", "#", text), []).append(text)
        for group in sorted(groups.values(), key=len, reverse=True)[:5]:
            print(f"  {kind} of {len(group)}: {group[0]}")
    return 0 if counts[OK] == len(rows) else 1


def program_of(option):
    if option:
        found = pathlib.Path(option)
        if not found.is_file():
            raise Wrong(f"--latsch {option}: there is no such file")
        return found.resolve()
    built = ROOT / "target" / "release" / "latsch"
    found = built if built.is_file() else shutil.which("latsch")
    if not found:
        raise Wrong("the program latsch is not there; build it (cargo build --release), install it (scripts/install), or name it with --latsch")
    return pathlib.Path(found).resolve()


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path, metavar="STUDY.toml")
    parser.add_argument("--output", type=pathlib.Path, metavar="F.parquet", help="the table [default: beside the study]")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="a cluster that is there, as tcp://HOST:8786 [default: one on this machine]")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), metavar="N", help="of the cluster on this machine [default: its cores]")
    parser.add_argument("--retries", type=int, default=2, metavar="N", help="more attempts where a worker fails [default: 2]")
    parser.add_argument("--latsch", metavar="PROGRAM", help="the program [default: target/release/latsch, or the installed one]")
    parser.add_argument("--replace", action="store_true", help="drop runs of another study from the table")
    parser.add_argument("--check", action="store_true", help="only check the study and say how many runs it has")
    options = parser.parse_args()
    if options.workers < 1 or options.retries < 0:
        parser.error("--workers and --retries: a number from 1 and from 0 on")
    return options


def stop(_signal, _frame):
    raise KeyboardInterrupt


def main():
    options = arguments()
    # told to end, it lets go of its cluster first
    signal.signal(signal.SIGTERM, stop)
    path = options.output or options.study.with_suffix(".parquet")
    try:
        study = Study(options.study)
        study.kit = Kit(study, program_of(options.latsch))
        packed = study.kit.packed()
        units = try_out(study, packed)
        commands = [study.arguments(point) for point in study.points]
        keys = [key_of(packed, command, study) for command in commands]
        store = Store(path, set(keys), options.replace)
    except Wrong as wrong:
        print(f"error: {options.study}: {wrong}", file=sys.stderr)
        return 2
    missing = [i for i, key in enumerate(keys) if key not in store.done]
    print(f"{options.study}: {len(keys)} runs, {len(missing)} to do", flush=True)
    if options.check:
        return 0
    store.open()
    try:
        if missing:
            compute(study, [keys[i] for i in missing], [commands[i] for i in missing], packed, store, options)
    except KeyboardInterrupt:
        done = sum(key in store.done for key in keys)
        print(f"interrupted: {done} of {len(keys)} runs are done; the same command goes on", file=sys.stderr)
        return 130
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    store.write(study, keys, units)
    return summary(store, keys, path)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Exception:
        traceback.print_exc()
        sys.exit(3)
