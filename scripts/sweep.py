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
import contextlib
import csv
import dataclasses
import hashlib
import io
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
import urllib.parse
import xml.etree.ElementTree
import zipfile

import cloudpickle
import dask
import sweep_study
import tomli_w
from distributed import Client, KilledWorker, LocalCluster, WorkerPlugin, as_completed, get_worker, progress
from sweep_study import Study, Wrong, nearest, shown

# workers elsewhere have no such file
cloudpickle.register_pickle_by_value(sweep_study)

ROOT = pathlib.Path(__file__).resolve().parent.parent
# the name of the program in the kit, which no study's file has
PROGRAM = ".latsch"
# of the events with rows
TOPIC = "latsch-study-rows"
# what stands in the column `status`
OK, FAILED, LOST = "ok", "failed", "lost"
# what is kept of a run
ROW = ["status", "error", "warnings", "values"]


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
                self.add(self.beside(value[1:], target, self.folder), target)
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
                if source and source.startswith("file:"):
                    raise Wrong(f"{place}: {source}: is another file on another machine; name it as seen from the system's")
                if source and not re.match(r"[a-z]+:", source):
                    yield self.beside(urllib.parse.unquote(source), place), place

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

    def beside(self, file, place, folder=None):
        if pathlib.PurePath(file).is_absolute():
            seen_from = "the study's" if folder else "the system's"
            raise Wrong(f"{place}: {file}: an absolute path is another one on another machine; name the file as seen from {seen_from}")
        return pathlib.Path(os.path.normpath((folder or self.system.parent) / file))

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

    def teardown(self, worker):
        shutil.rmtree(self.top, ignore_errors=True)

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


def try_out(study, kit, packed):
    """Runs one step, so that wrong names and files are found before anything else; gives the channels' units."""
    start, step = kit.start or 0.0, kit.step
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


@contextlib.contextmanager
def connected(options, runs):
    """A client of the cluster, which is let go of at the end, in whatever way that comes."""
    # a task in the queue of a worker that dies would count as one that killed it: one at a time, with many tasks
    dask.config.set({"distributed.scheduler.allowed-failures": options.retries, "distributed.scheduler.worker-saturation": 1.0})
    with contextlib.ExitStack() as stack:
        if options.scheduler:
            try:
                client = Client(options.scheduler, timeout=30)
            except (OSError, ValueError) as error:
                raise Wrong(f"--scheduler {options.scheduler}: there is no cluster: {error}") from None
        else:
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            workers = min(options.workers, runs)
            cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0", local_directory=folder)
            client = Client(stack.enter_context(cluster))
        yield stack.enter_context(client)


def compute(client, study, keys, commands, packed, store, retries):
    """All runs on the cluster; each row is kept as soon as it is there."""
    job = Job(packed, study)
    client.register_plugin(job)
    try:
        rows = {}
        client.subscribe_topic(TOPIC, lambda event: rows.update({event[1]["key"]: event[1]}))
        names = [f"latsch-run-{key}-{job.name}" for key in keys]
        futures = client.map(run, keys, commands, job=job.name, key=names, retries=retries)
        key_of_name = dict(zip(names, keys))
        if sys.stdout.isatty():
            threading.Thread(target=progress, args=(futures,), daemon=True).start()
        tenth = -(-len(keys) // 10)
        for count, future in enumerate(as_completed(futures), 1):
            row = rows.pop(key_of_name[future.key], None)
            if row is None:
                error = future.exception() if future.status == "error" else None
                row = {"status": LOST, "error": lost(error, study, retries), "warnings": None, "values": {}}
            store.add(key_of_name[future.key], {name: row[name] for name in ROW})
            # let go of it: the cluster need not keep it
            future.release()
            if not sys.stdout.isatty() and count % tenth == 0:
                print(f"{count} of {len(keys)} runs", flush=True)
    finally:
        # its files are of no use to others on the cluster; one that is gone has none
        with contextlib.suppress(OSError, RuntimeError, TimeoutError):
            client.unregister_worker_plugin(job.name)


def lost(error, study, retries):
    attempts = f"with {retries + 1} attempts"
    if isinstance(error, subprocess.TimeoutExpired):
        return f"took longer than the timeout of {study.timeout} s, {attempts}"
    if isinstance(error, KilledWorker):
        return f"no answer from the cluster: every worker died that had this run, {attempts}"
    why = f"{type(error).__name__}: {error}" if error else "the run was dropped"
    return f"no answer from the cluster, {attempts}: {why}"


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
        raise Wrong("the program latsch is not there; build it (cargo build --release), install it (cargo install --path .), or name it with --latsch")
    return pathlib.Path(found).resolve()


def read_options():
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


def interrupt(_signal, _frame):
    raise KeyboardInterrupt


def main():
    options = read_options()
    path = options.output or options.study.with_suffix(".parquet")
    try:
        study = Study(options.study)
        kit = Kit(study, program_of(options.latsch))
        packed = kit.packed()
        units = try_out(study, kit, packed)
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
    try:
        with connected(options, len(missing)) if missing else contextlib.nullcontext() as client:
            store.open()
            if missing:
                own = [[values[i] for i in missing] for values in (keys, commands)]
                compute(client, study, *own, packed, store, options.retries)
    except Wrong as wrong:
        print(f"error: {wrong}", file=sys.stderr)
        return 2
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
    # told to end, it lets go of its cluster first
    signal.signal(signal.SIGTERM, interrupt)
    try:
        sys.exit(main())
    except Exception:
        traceback.print_exc()
        sys.exit(3)
