#!/usr/bin/env python3
"""How fast others are at what latsch does, measured side by side in one run: a Markdown table of ratios.

    scripts/bench                       makes what this needs and runs it
    benches/peers.py LATSCH [--turns N] [--wall] [--reference-fmus DIR]

LATSCH is the program, with its library beside it. In each turn everything is measured once, one after the other, so that
a machine that becomes slower does so for all. A figure is the median over the turns, with the least and the greatest
behind it, in processor time unless --wall; a ratio is the median of the turns' ratios. --reference-fmus names a folder
with FMUs of https://github.com/modelica/Reference-FMUs (BouncingBall.fmu, Dahlquist.fmu, VanDerPol.fmu ...), which no
package brings.
"""

import argparse
import contextlib
import functools
import importlib.metadata
import math
import os
import pathlib
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib

import fmpy
import fmpy.fmi2
import numpy as np
import scipy.optimize

STEP = 1e-3
# --wall: elapsed time instead of processor time
WALL = False
MODELS = ["ring-brush-flat-track", "magic-formula-flat-track", "ring-brush-corner", "magic-formula-corner", "brake-hydraulics", "abs-controller"]
# rolling at combined slip under about 4 kN
ROLLING = {"deflection": 0.02, "path_speed": 27.8, "slip": 0.03, "slip_angle": 0.03}
BRAKE = {"driver_pressure": 9e6}
EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"
SSD = "SystemStructure.ssd"
CARS = ["ring-brush-vehicle", "magic-formula-vehicle"]
# systems by their folders, each with outputs that its user watches
WATCHED = {
    "abs-stop": ["corner.vehicle_speed", "corner.wheel_speed", "corner.slip", "corner.force_x", "corner.force_z", "brake.pressure",
                 "brake.brake_torque", "abs.inlet_valve_1"],
} | {
    car: ["car.vehicle_speed", "car.front_left.wheel_speed", "car.front_left.force_x", "car.front_left.force_z",
          "car.front_left.longitudinal_link_force", "car.front_left.tie_rod_force", "brake_fl.brake_torque", "abs.inlet_valve_1"]
    for car in CARS
}
# the car's step with which it is measured, and the pressure that its driver has in the brakes all the time
CAR_STEP, PRESSURE = 5e-4, 1.5e7


def version(package):
    return f"{package} {importlib.metadata.version(package)}"


@contextlib.contextmanager
def quiet():
    """Some peers print from C++."""
    sys.stdout.flush()
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)


class Machine:
    """The program and its FMUs."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        for model in MODELS + CARS:
            self.call("export", model, "--output", folder / f"{model}.fmu")
        for system in WATCHED:
            place = folder / system
            place.mkdir()
            for fmu in folder.glob("*.fmu"):
                (place / fmu.name).symlink_to(fmu)
            if system in CARS:
                (place / SSD).write_text(car_structure(system))
            else:
                shutil.copy(EXAMPLES / system / SSD, place)

    def call(self, *arguments):
        subprocess.run([self.program, *map(str, arguments)], check=True, capture_output=True)

    def fmu(self, model):
        return self.folder / f"{model}.fmu"

    def simulate(self, fmu, values, steps):
        settings = [word for name, value in values.items() for word in ("--set", f"{name}={value!r}")]
        times = ["--start", 0, "--stop", steps * STEP, "--step", STEP]
        self.call("simulate", fmu, *times, *settings, "--output", self.folder / "out.csv")

    def cosimulate(self, system, steps):
        self.call("cosimulate", self.folder / system / SSD, "--stop", steps * STEP, "--output", self.folder / "out.csv")


def car_structure(car):
    """The car of examples/car-abs-stop in the form that all masters read, with a driver who brakes from the beginning."""
    system = tomllib.loads((EXAMPLES / "car-abs-stop" / "system.toml").read_text())
    wires = [(source.split(".", 1), target.split(".", 1)) for source, target in system["connect"].items()]

    def component(name, about):
        model = car if name == "car" else about["model"]
        values = dict(about.get("set", {}))
        if name == "car":
            values |= {"initial_speed": 80 / 3.6, "step_size": CAR_STEP}
        else:
            values["driver_pressure"] = PRESSURE
        ends = [(w[0][1], "output") for w in wires if w[0][0] == name] + [(w[1][1], "input") for w in wires if w[1][0] == name]
        connectors = "".join(f'<ssd:Connector name="{n}" kind="{kind}"><ssc:Real/></ssd:Connector>' for n, kind in ends)
        kinds = {bool: "Boolean", int: "Integer", float: "Real"}
        parameters = "".join(
            f'<ssv:Parameter name="{n}"><ssv:{kinds[type(v)]} value="{str(v).lower()}"/></ssv:Parameter>' for n, v in values.items()
        )
        return (
            f'<ssd:Component name="{name}" source="{model}.fmu"><ssd:Connectors>{connectors}</ssd:Connectors><ssd:ParameterBindings>'
            '<ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="1.0" name="start"><ssv:Parameters>'
            f"{parameters}</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings></ssd:Component>"
        )

    # in the order in which they step
    elements = "".join(component(name, system["component"][name]) for name in system["order"])
    connections = "".join(
        f'<ssd:Connection startElement="{a}" startConnector="{x}" endElement="{b}" endConnector="{y}"/>' for (a, x), (b, y) in wires
    )
    example = (EXAMPLES / "abs-stop" / SSD).read_text()
    head, tail = example[: example.index("<ssd:Elements>")], example[example.index("</ssd:System>") :]
    return f"{head}<ssd:Elements>{elements}</ssd:Elements><ssd:Connections>{connections}</ssd:Connections>{tail}"


class Slave:
    """An instance in FMPy, kept between runs."""

    def __init__(self, fmu):
        description = fmpy.read_model_description(str(fmu))
        self.folder = fmpy.extract(str(fmu))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.outputs = [v.valueReference for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        # how many steps of its own the model takes in a communication step
        own = next(float(v.start) for v in description.modelVariables if v.name == "step_size")
        self.own_step, self.own_steps = own, round(STEP / own)
        self.raw = fmpy.fmi2.FMU2Slave(
            guid=description.guid, unzipDirectory=self.folder, modelIdentifier=description.coSimulation.modelIdentifier, instanceName="x"
        )
        self.raw.instantiate()
        self.fresh = True

    def run(self, values, steps, step=STEP, read=True):
        """From the start; the seconds of the steps alone, and the last outputs."""
        if not self.fresh:
            self.raw.reset()
        self.fresh = False
        self.raw.setupExperiment(startTime=0.0)
        self.raw.enterInitializationMode()
        self.raw.setReal([self.references[n] for n in values], list(values.values()))
        self.raw.exitInitializationMode()
        begin, rows = clock(), []
        for k in range(steps):
            self.raw.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
            if read:
                rows.append(self.raw.getReal(self.outputs))
        return clock() - begin, rows

    def close(self):
        self.raw.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@functools.cache
def references(fmu):
    """Once for each FMU: masters that are not FMPy do not need FMPy's reading."""
    return {v.name: v.valueReference for v in fmpy.read_model_description(str(fmu)).modelVariables}


@functools.cache
def watched(fmu):
    description = fmpy.read_model_description(str(fmu))
    return {v.name: v.valueReference for v in description.modelVariables if v.causality == "output" and v.type == "Real"}


def with_fmpy(fmu, values, steps):
    fmpy.simulate_fmu(str(fmu), stop_time=steps * STEP, output_interval=STEP, start_values=values)


def with_libcosim(fmu, values, steps):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(str(fmu), "x"))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    for name, value in values.items():
        assert execution.real_initial_value(index, references(fmu)[name], value)
    outputs = list(watched(fmu).values())
    rows = []
    for _ in range(steps):
        assert execution.step()
        rows.append(observer.last_real_values(index, outputs))
    return rows


def with_ecos(fmu, values, steps):
    from ecospy.EcosSimulation import EcosSimulation
    from ecospy.EcosSimulationStructure import EcosSimulationStructure

    names = [f"x::{name}" for name in watched(fmu)]
    with EcosSimulationStructure() as structure:
        structure.add_model("x", str(fmu))
        structure.add_parameter_set("start", {f"x::{n}": v for n, v in values.items()})
        with EcosSimulation(STEP, structure=structure) as simulation:
            assert simulation.init(0, "start")
            rows = []
            for _ in range(steps):
                simulation.step()
                rows.append([simulation.get_real(name) for name in names])
            return rows


def system_with_libcosim(folder, steps):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(str(folder / SSD))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    places = []
    for name in WATCHED[folder.name]:
        component, variable = name.split(".", 1)
        index = execution.slave_index_from_instance_name(component)
        places.append((index, {v.name.decode(): v.reference for v in execution.slave_variables(index)}[variable]))
    for _ in range(steps):
        assert execution.step()
        [observer.last_real_values(index, [reference])[0] for index, reference in places]


def system_with_ecos(folder, steps):
    from ecospy.EcosSimulation import EcosSimulation

    with EcosSimulation(STEP, ssp_path=str(folder)) as simulation:
        assert simulation.init(0, "start")
        for _ in range(steps):
            simulation.step()
            [simulation.get_real(name.replace(".", "::", 1)) for name in WATCHED[folder.name]]


class Brush:
    """A plain brush model: bristles of a rigid belt that stick until the local pressure no longer holds them, with the
    memory of where each one stands. Vectorised over all bristles of all stripes, as one writes it in NumPy."""

    def __init__(self, stripes=6, bristles=30, length=0.12, load=4000.0, friction=1.2, stiffness=4e4):
        self.length, self.friction, self.stiffness = length, friction, stiffness
        self.place = np.tile((np.arange(bristles) + 0.5) / bristles * length, (stripes, 1))
        self.x, self.y = np.zeros_like(self.place), np.zeros_like(self.place)
        # parabolic along the contact, the load shared by all bristles
        self.peak = 1.5 * load / self.place.size

    def step(self, speed, slip, angle, time):
        self.place += speed * time
        new = self.place >= self.length
        self.place[new] -= self.length
        self.x[new] = self.y[new] = 0.0
        # tips stay on the road while roots move with the sliding speed
        self.x += slip * speed * time
        self.y += math.tan(angle) * speed * time
        share = self.place / self.length
        limit = self.friction * self.peak * 4.0 * share * (1.0 - share)
        force = self.stiffness * np.hypot(self.x, self.y)
        scale = np.minimum(1.0, limit / np.maximum(force, 1e-12))
        self.x *= scale
        self.y *= scale
        return self.stiffness * self.x.sum(), self.stiffness * self.y.sum()


def clock():
    """Seconds of processor time of this process with all threads, and of the processes that it has waited for; on a
    machine with other work the only time that says something."""
    if WALL:
        return time.perf_counter()
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


class Measured:
    """Seconds of each measurement in each turn."""

    def __init__(self):
        self.seconds, self.reasons = {}, {}

    def take(self, name, work):
        """Measures `work`, which gives seconds itself or is timed; one that fails is not tried again, and says why."""
        if name in self.reasons:
            return
        try:
            with quiet():
                begin = clock()
                own = work()
                taken = clock() - begin
        except Exception as error:
            self.reasons[name] = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}".strip(": ")
            return
        self.seconds.setdefault(name, []).append(own if isinstance(own, float) else taken)


def spread(values, scale, unit=None):
    low, middle, high = min(values) * scale, float(np.median(values)) * scale, max(values) * scale
    return f"{middle:.3g}{f' {unit}' if unit else ''} ({low:.3g} to {high:.3g})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("latsch", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=7)
    parser.add_argument("--reference-fmus", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--wall", action="store_true", help="elapsed time, for a machine without other work")
    options = parser.parse_args()
    if options.turns < 1:
        parser.error("--turns: a number from 1 on")
    global WALL
    WALL = options.wall
    with tempfile.TemporaryDirectory() as folder:
        table(options, Machine(options.latsch.resolve(), pathlib.Path(folder)))


def table(options, machine):
    measured = Measured()
    take = measured.take
    rows = []

    def row(what, peer, name, base, scale, unit):
        rows.append((what, peer, name, base, scale, unit))

    try:
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

        log_output_level(CosimLogLevel.ERROR)
    except Exception:
        # the measurements say what is the matter
        pass

    # ---- masters: one FMU, from the file to the outputs at every point
    masters = [("FMPy", with_fmpy, "FMPy"), ("libcosim", with_libcosim, "libcosimpy"), ("Ecos", with_ecos, "ecospy")]
    runs = [("brake-hydraulics", BRAKE, 10_000), ("ring-brush-flat-track", ROLLING, 1000)]
    for model, values, steps in runs:
        what = f"{steps} steps of 1 ms of `{model}.fmu`, file to outputs"
        base = (model, "latsch")
        row(what, "latsch simulate, a process that writes a CSV file", base, base, 1e3, "ms")
        for peer, _, package in masters:
            row(what, f"{version(package)}, in this process", (model, peer), base, 1e3, "ms")
    system_steps = 1000
    about = {"abs-stop": "examples/abs-stop, three FMUs"}
    about |= {car: f"examples/car-abs-stop with {car}.fmu in steps of {1e3 * CAR_STEP:g} ms, six FMUs" for car in CARS}
    for system, words in about.items():
        what = f"{system_steps} steps of 1 ms of {words}"
        base = (system, "latsch")
        row(what, "latsch cosimulate, a process that writes a CSV file", base, base, 1e3, "ms")
        row(what, f"{version('libcosimpy')}, 8 outputs read each step", (system, "libcosim"), base, 1e3, "ms")
        row(what, f"{version('ecospy')}, 8 outputs read each step", (system, "Ecos"), base, 1e3, "ms")

    # ---- foreign FMUs
    foreign = sorted(options.reference_fmus.glob("*.fmu")) if options.reference_fmus else []
    for fmu in foreign:
        base = (fmu.name, "latsch")
        what = f"1000 steps of 1 ms of Reference-FMUs' {fmu.name}, file to outputs"
        row(what, "latsch simulate", base, base, 1e3, "ms")
        row(what, version("FMPy"), (fmu.name, "FMPy"), base, 1e3, "ms")

    # ---- tires
    ring, magic = (Slave(machine.fmu(f"{tire}-flat-track")) for tire in ("ring-brush", "magic-formula"))
    what = "one tire step, 6 x 30 bristles with memory"
    base = ("bristles", "latsch")
    row(what, f"latsch ring-brush on the flat track, step of {ring.own_step * 1e3:g} ms, through FMI and FMPy's call, belt and rig included", base, base, 1e6, "us")
    row(what, f"a plain brush model in {version('numpy')}, no belt, no rig", ("bristles", "numpy"), base, 1e6, "us")
    what = "Magic Formula at combined slip"
    base = ("formula", "latsch")
    row(what, f"latsch magic-formula on the flat track, step of {magic.own_step * 1e3:g} ms: transient, moments and rig included", base, base, 1e6, "us")
    row(what, f"{version('commonroad-vehicle-models')}, steady forces only, plain Python", ("formula", "commonroad"), base, 1e6, "us")
    row(what, f"{version('pacejka')}, steady forces, cut off at the friction circle", ("formula", "pacejka"), base, 1e6, "us")

    # ---- identification
    corner = machine.fmu("magic-formula-corner")
    slave, fit_steps = Slave(corner), 500
    truth = {"brake_torque": 1200.0, "vehicle_mass": 520.0, "LKX": 0.9}
    names = list(watched(corner))
    seen = [names.index("vehicle_speed"), names.index("slip")]
    target = np.array(slave.run(truth, fit_steps)[1])[:, seen]
    what = f"one simulation of a fit, {fit_steps} steps of `magic-formula-corner.fmu`"
    base = ("fit", "latsch")
    row(what, "latsch simulate, a process for each (its own fit keeps instances and starts none)", base, base, 1e3, "ms")
    row(what, f"{version('scipy')} least_squares over {version('FMPy')}, the instance kept", ("fit", "kept"), base, 1e3, "ms")
    row(what, f"{version('scipy')} least_squares over FMPy's simulate_fmu", ("fit", "simulate_fmu"), base, 1e3, "ms")

    def fit_time(simulate):
        counted = []

        def residual(p):
            counted.append(1)
            found = simulate(dict(truth, vehicle_mass=1000.0 * p[0], LKX=p[1]))
            return ((found - target) * [1.0, 100.0]).ravel()

        begin = clock()
        found = scipy.optimize.least_squares(residual, [0.5, 1.0], diff_step=1e-4, max_nfev=20)
        taken = clock() - begin
        # what is measured has to work
        assert np.allclose(found.x, [0.52, 0.9], rtol=1e-3), found.x
        return taken / len(counted)

    def kept(values):
        return np.array(slave.run(values, fit_steps)[1])[:, seen]

    def fresh(values):
        outputs = ["vehicle_speed", "slip"]
        found = fmpy.simulate_fmu(str(corner), stop_time=fit_steps * STEP, output_interval=STEP, start_values=values, output=outputs)
        return np.array([found[name][1:] for name in outputs]).T

    def bristles():
        brush = Brush()
        begin = clock()
        for _ in range(500):
            brush.step(27.8, 0.03, 0.03, 1e-4)
        return (clock() - begin) / 500

    def commonroad():
        from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
        from vehiclemodels.utils import tire_model

        p = parameters_vehicle2().tire
        begin = clock()
        for _ in range(500):
            x0 = tire_model.formula_longitudinal(0.03, 0.0, 4000.0, p)
            y0, mu = tire_model.formula_lateral(0.03, 0.0, 4000.0, p)
            tire_model.formula_longitudinal_comb(0.03, 0.03, x0, p)
            tire_model.formula_lateral_comb(0.03, 0.03, 0.0, mu, 4000.0, y0, p)
        return (clock() - begin) / 500

    def pacejka():
        import pacejka as package

        tire = package.Tire("x", 1.0, cornering_stiffness_per_rad=8e4, longitudinal_stiffness=1e5, load_sensitivity_n=0.9, f_z0=4000.0)
        begin = clock()
        for _ in range(500):
            tire.calculate_forces(4000.0, 0.03, 0.03, alpha_unit="rad")
        return (clock() - begin) / 500

    for model, _, _ in runs:
        references(machine.fmu(model)), watched(machine.fmu(model))
    for _ in range(options.turns):
        for model, values, steps in runs:
            fmu = machine.fmu(model)
            take((model, "latsch"), lambda: machine.simulate(fmu, values, steps))
            for peer, work, _ in masters:
                take((model, peer), lambda: work(fmu, values, steps))
        for system in WATCHED:
            take((system, "latsch"), lambda: machine.cosimulate(system, system_steps))
            take((system, "libcosim"), lambda: system_with_libcosim(machine.folder / system, system_steps))
            take((system, "Ecos"), lambda: system_with_ecos(machine.folder / system, system_steps))
        for fmu in foreign:
            take((fmu.name, "latsch"), lambda: machine.simulate(fmu, {}, 1000))
            take((fmu.name, "FMPy"), lambda: with_fmpy(fmu, {}, 1000))
        take(("bristles", "latsch"), lambda: ring.run(ROLLING, 300, read=False)[0] / 300 / ring.own_steps)
        take(("bristles", "numpy"), bristles)
        take(("formula", "latsch"), lambda: magic.run(ROLLING, 300, read=False)[0] / 300 / magic.own_steps)
        take(("formula", "commonroad"), commonroad)
        take(("formula", "pacejka"), pacejka)
        take(("fit", "latsch"), lambda: machine.simulate(corner, truth, fit_steps))
        take(("fit", "kept"), lambda: fit_time(kept))
        take(("fit", "simulate_fmu"), lambda: fit_time(fresh))
    for open_slave in (ring, magic, slave):
        open_slave.close()

    kind = "elapsed" if WALL else "processor"
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores, {kind} time, median of {options.turns} turns (least to greatest).\n")
    print("| what | by | time | of latsch's | |\n|---|---|---|---|---|")
    last = None
    for what, peer, name, base, scale, unit in rows:
        shown, last = "" if what == last else what, what
        if name in measured.reasons:
            print(f"| {shown} | {peer} | not measured: {measured.reasons[name]} | | |")
            continue
        values = measured.seconds[name]
        ratios = [a / b for a, b in zip(values, measured.seconds.get(base, []))]
        if name == base or not ratios:
            print(f"| {shown} | {peer} | {spread(values, scale, unit)} | | |")
            continue
        faster = "**the peer is faster**" if np.median(ratios) < 1 else ""
        print(f"| {shown} | {peer} | {spread(values, scale, unit)} | {spread(ratios, 1)} | {faster} |")
    if not foreign:
        print("| Reference-FMUs | | not measured: no package brings them; --reference-fmus names a folder of them | | |")
    print("| Project Chrono's tires | | not measured: no package of Python's brings them | | |")


if __name__ == "__main__":
    main()
