"""What a study of scripts/sweep.py says: its parameters and their values, and what is kept of a run."""

import dataclasses
import difflib
import itertools
import json
import math
import re
import tomllib

# more runs than this are taken for a mistake in a count
MAX_RUNS = 1_000_000
REDUCTIONS = ["last", "min", "max", "mean"]


class Wrong(Exception):
    """What is wrong with a study or a command, where, and what to do."""


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
    begin: float = -math.inf
    end: float = math.inf

    def channels(self):
        return [c for c in (self.channel, self.when) if c]

    def of(self, time, columns):
        """Of a run; None where there is no sample or no crossing."""
        kept = [i for i, t in enumerate(time) if self.begin <= t <= self.end]
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


class TomlTable:
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
        if value is not default and not is_finite(value):
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
        value = self.take(key, str, what, default, needed)
        if value == "":
            raise Wrong(f"{self.at(key)}: {what} is needed, not an empty text")
        return value

    def end(self):
        for key in self.values:
            raise Wrong(f"{self.at(key)}: there is no such key; {nearest(key, self.known)}")


def is_finite(value):
    """Whole numbers may be larger than any of the program's."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


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
    table = TomlTable(entry, place + ".")
    targets = table.take("set", (str, list), "component.variable, or several in [ ],", name)
    targets = [targets] if isinstance(targets, str) else targets
    if not targets:
        raise Wrong(f"{place}.set: at least one component.variable is needed")
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
        return Vary(name, targets, unit, check_values(values, unit, f"{place}.values"))
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
    """Values of one kind, all different."""
    kinds = {bool: "true or false", str: "texts", float: "numbers"}
    found = {float if type(v) is int else type(v) for v in values}
    if len(found) != 1 or not found <= kinds.keys():
        raise Wrong(f"{place}: numbers are needed, or texts, or true and false, all of one kind, not {shown(values)}")
    if found == {float} and not all(map(is_finite, values)):
        raise Wrong(f"{place}: finite numbers are needed, not {shown(values)}")
    values = [float(v) if found == {float} and unit else v for v in values]
    if unit and found != {float}:
        raise Wrong(f"{place}: only numbers have a unit")
    seen = set()
    for value in values:
        if value in seen:
            raise Wrong(f"{place}: {shown(value)} is there twice")
        seen.add(value)
    return values


def check_value(value, place):
    """A single one."""
    if not isinstance(value, (bool, str, int, float)) or (not isinstance(value, str) and not is_finite(value)):
        raise Wrong(f"{place}: a finite number, a text, or true or false is needed, not {shown(value)}")


def read_result(name, entry):
    place = f"results.{name}"
    table = TomlTable(entry, place + ".")
    begin, end = table.number("from", -math.inf), table.number("to", math.inf)
    reductions = {kind: table.text(kind, what="the name of a channel") for kind in REDUCTIONS}
    given = {kind: channel for kind, channel in reductions.items() if channel is not None}
    value = table.text("value", what="the name of a channel")
    when = table.text("when", what="the name of a channel")
    limit, above = crossing(table, place) if when else (0.0, True)
    table.end()
    if len(given) + (when is not None) != 1 or (value is not None and when is None):
        raise Wrong(f"{place}: one of {', '.join(REDUCTIONS)} is needed, or when with above or below")
    if not begin < end:
        raise Wrong(f"{place}: from = {begin} s has to be before to = {end} s")
    if when:
        return Result(name, "time" if value is None else "value", value, when, float(limit), above, begin, end)
    ((kind, channel),) = given.items()
    return Result(name, kind, channel, begin=begin, end=end)


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
        table = TomlTable(values, "")
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
            table = TomlTable(self.until, "until.")
            channel = table.text("channel", needed=True, what="the name of a channel")
            self.until = Result("until", "time", None, channel, *crossing(table, "until"))
            table.end()
        for target, value in self.set.items():
            check_target(target, "set")
            check_value(value, f"set.{target}")
        self.vary = [read_vary(name, entry) for name, entry in vary.items()]
        self.results = [read_result(name, entry) for name, entry in results.items()]
        for key in ("vary", "results"):
            if not getattr(self, key):
                raise Wrong(f"{key}: is empty")
        taken = ["run", "status", "error", "warnings", "key"]
        for entry in [*self.vary, *self.results]:
            if re.search(r"[][]", entry.name):
                raise Wrong(f"{entry.name}: a name has no brackets; the unit of a column is put in some behind it")
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
            table = TomlTable(sample, "sample.")
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
