#!/usr/bin/env python3
"""How long `latsch identify` takes to find a tire, and a least-squares fit over the same FMU, from the same recordings and start.

    benches/identification.py LATSCH LATSCH_TRUTH [--tires 20] [--seed 7] [--budget 1800] [--jobs 1] [--output DIR]

LATSCH is the program, with its library beside it, LATSCH_TRUTH that of tests/truth, which draws the tires and drives them along the
programme of `latsch rig-program`. The rival is what an engineer would write: scipy's least_squares (trust region, bounds of the plan)
over FMPy's simulation of the exported FMU along the recorded inputs, residuals of all forces over their ranges, the zeros of the load
cell off the road taken off, the offsets of angles and height as unknowns beside the 15 parameters. It gets so many seconds for a
tire as --budget says, and counts with what it has then. Tires of which --output has a result are not done again. Runs in the virtual environment of scripts/bench (benches/peers-requirements.txt).
"""

import argparse
import concurrent.futures
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import time

import fmpy
import numpy as np
import scipy.optimize

PLAN = "ring-brush-flat-track"
STEP = 0.01
OUTPUTS = ["force_x", "force_y", "force_z", "moment_z"]
INPUTS = ["deflection", "path_speed", "slip", "slip_angle", "camber"]
# what the rig does not record and the FMU wants to be told
STILL = {"steer": 0.0, "friction_factor": 1.0, "load": 0.0}
# start of the model and bounds of the plan; static and sliding friction within what the plan admits on the whole
PARAMETERS = {
    "vertical_stiffness": (154e3, 8e4, 1e6),
    "vertical_stiffness_quadratic": (2.47e6, 1e5, 5e7),
    "sidewall_radial_stiffness": (4.67e6, 5e5, 2e7),
    "cross_section_radius": (0.675, 0.46, 5.0),
    "bristle_stiffness": (4e4, 1e3, 1e6),
    "sidewall_tilt_stiffness": (8e4, 5e3, 1e6),
    "stripe_length_factor": (0.75, 0.3, 1.5),
    "patch_compliance_twist": (1e-4, 0.0, 1e-3),
    "patch_compliance_y": (8e-7, 0.0, 2e-5),
    "friction_sliding_zero": (1.1, 0.3, 1.8),
    "friction_sliding_reference": (1.0, 0.3, 1.8),
    "patch_compliance_x": (3e-6, 1e-6, 5e-6),
    "friction_static_zero": (1.5, 0.3, 2.0),
    "friction_static_reference": (1.4, 0.3, 2.0),
    "sidewall_lateral_stiffness": (85e3, 2e4, 3e5),
}
# what no recording of this programme tells; as in scripts/prove-intervals
UNTOLD = {"sidewall_radial_stiffness", "sidewall_tilt_stiffness"}
NEAR = 0.3
# offsets of inputs that are looked for, and how large they may be
OFFSETS = {"slip_angle": 5e-3, "camber": 5e-3, "deflection": 5e-3}
CLOSE = 0.02


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("latsch", type=pathlib.Path)
    parser.add_argument("truth", type=pathlib.Path)
    parser.add_argument("--tires", type=int, default=20, metavar="N", help="[default: 20]")
    parser.add_argument("--seed", type=int, default=7, help="[default: 7]")
    parser.add_argument("--budget", type=float, default=1800.0, metavar="SECONDS", help="of the rival, for a tire [default: 1800]")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="tires at a time [default: 1]")
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("identification"), metavar="DIR")
    return parser.parse_args()


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(str(part) for part in command)}: {done.stderr.strip()}")
    return done.stdout


class OutOfTime(Exception):
    pass


class Rival:
    """Least squares over simulations of the FMU."""

    def __init__(self, fmu, recordings, budget):
        self.unpacked = fmpy.extract(str(fmu))
        self.description = fmpy.read_model_description(self.unpacked)
        self.instance = fmpy.instantiate_fmu(self.unpacked, self.description, "CoSimulation")
        self.runs = [self.read(file) for file in sorted(recordings.glob("*.csv"))]
        zeros = {name: np.mean(self.runs[0][name]) for name in OUTPUTS}
        for recorded in self.runs:
            for name in OUTPUTS:
                recorded[name] -= zeros[name]
        self.ranges = {
            name: max(r[name].max() for r in self.runs) - min(r[name].min() for r in self.runs) for name in OUTPUTS
        }
        self.end = time.monotonic() + budget
        self.best, self.least, self.simulations = None, np.inf, 0

    def read(self, file):
        with open(file, encoding="utf-8") as lines:
            rows = csv.reader(lines)
            names = [name.split(" [")[0] for name in next(rows)]
            values = np.array([[float(cell) for cell in row] for row in rows])
        # what moves within 10 ms is lost on an eye that looks every 10 ms; means keep the noise low
        every = round(STEP / (values[1, 0] - values[0, 0]))
        count = len(values) // every
        values = values[: count * every].reshape(count, every, -1).mean(axis=1)
        return {name: values[:, k].copy() for k, name in enumerate(names)}

    def residuals(self, x):
        if time.monotonic() > self.end:
            raise OutOfTime
        names = list(PARAMETERS)
        start = {name: x[k] * PARAMETERS[name][0] for k, name in enumerate(names)}
        # the model refuses bristles that stick less than they slide
        for pressure in ("zero", "reference"):
            static, sliding = f"friction_static_{pressure}", f"friction_sliding_{pressure}"
            start[static] = max(start[static], start[sliding])
        start["command_actuators"] = False
        offsets = {name: x[len(names) + k] * size for k, (name, size) in enumerate(OFFSETS.items())}
        parts = []
        for recorded in self.runs:
            columns = [(name, float) for name in ("time", *INPUTS, *STILL)]
            inputs = np.zeros(len(recorded["time"]), dtype=columns)
            for name, value in STILL.items():
                inputs[name] = value
            inputs["time"] = recorded["time"] - recorded["time"][0]
            for name in INPUTS:
                inputs[name] = recorded[name] - offsets.get(name, 0.0)
            # dragged sideways by an angle that is off
            inputs["slip_angle"] = np.clip(inputs["slip_angle"], -np.pi / 2, np.pi / 2)
            start.update({name: inputs[name][0] for name in INPUTS})
            self.simulations += 1
            try:
                self.instance.reset()
                result = fmpy.simulate_fmu(
                    self.unpacked, model_description=self.description, fmu_instance=self.instance, start_values=start,
                    input=inputs, output=OUTPUTS, stop_time=inputs["time"][-1], output_interval=STEP,
                )  # fmt: skip
            except fmpy.fmi1.FMICallException:
                # no tire of the model's: as bad as no tire at all
                return np.concatenate([r[name] / self.ranges[name] for r in self.runs for name in OUTPUTS])
            for name in OUTPUTS:
                simulated = np.interp(inputs["time"], result["time"], result[name])
                parts.append((simulated - recorded[name]) / self.ranges[name])
        all_parts = np.concatenate(parts)
        cost = float(all_parts @ all_parts)
        if cost < self.least:
            self.best, self.least = x.copy(), cost
        return all_parts

    def fit(self):
        bounds = [[limits[k] / limits[0] for limits in PARAMETERS.values()] for k in (1, 2)]
        low, high = ([*bounds[0], *[-1.0] * len(OFFSETS)], [*bounds[1], *[1.0] * len(OFFSETS)])
        start = [1.0] * len(PARAMETERS) + [0.0] * len(OFFSETS)
        try:
            scipy.optimize.least_squares(self.residuals, start, bounds=(low, high), x_scale="jac", diff_step=1e-3)
            finished = True
        except OutOfTime:
            finished = False
        found = dict(zip(PARAMETERS, self.best, strict=False))
        return {name: share * PARAMETERS[name][0] for name, share in found.items()}, finished


def one(number, options, programme, fmu):
    folder = options.output / f"{number:03d}"
    if (folder / "result.json").exists():
        return number, json.loads((folder / "result.json").read_text())
    run(options.truth, "rig", number, "--seed", options.seed, "--programme", programme, "--output", folder)
    truth = json.loads((folder / "truth.json").read_text())["parameters"]
    within = [word for name in UNTOLD for word in ("--within", f"{name}={NEAR}")]
    begun = time.monotonic()
    told = run(
        options.latsch, "identify", PLAN, "--recordings", folder / "recordings", "--output", folder / "tire.toml", "--format", "json", *within
    )
    own = time.monotonic() - begun
    rows = {row["name"]: row for row in json.loads(told)["parameters"]}
    begun = time.monotonic()
    rival = Rival(fmu, folder / "recordings", options.budget)
    fitted, finished = rival.fit()
    other = time.monotonic() - begun
    shutil.rmtree(folder / "recordings")
    result = {"truth": truth, "latsch": rows, "rival": fitted, "seconds": [own, other], "finished": finished,
              "simulations": rival.simulations}  # fmt: skip
    (folder / "result.json").write_text(json.dumps(result))
    return number, result


def main():
    options = arguments()
    options.output.mkdir(parents=True, exist_ok=True)
    programme, fmu = options.output / "programme", options.output / "tire.fmu"
    run(options.latsch, "rig-program", PLAN, "--output", programme)
    run(options.latsch, "export", PLAN, "--output", fmu)
    results = []
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for future in concurrent.futures.as_completed(
            [pool.submit(one, n, options, programme, fmu) for n in range(1, options.tires + 1)]
        ):
            number, result = future.result()
            print(f"tire {number}: {result['seconds'][0]:.1f} s and {result['seconds'][1]:.0f} s", file=sys.stderr, flush=True)
            results.append(result)
    print("| parameter | latsch within 2 % | its interval says so, and is wrong | rival within 2 % | error, median: latsch | rival |")
    print("|---|---|---|---|---|---|")
    for name in PARAMETERS:
        if name in UNTOLD:
            continue
        own = [abs(r["latsch"][name]["value"] / r["truth"][name] - 1) for r in results]
        other = [abs(r["rival"][name] / r["truth"][name] - 1) for r in results]
        # an interval of 2 % that the truth is three times as far away from
        wrong = 0
        for r, error in zip(results, own, strict=True):
            half = r["latsch"][name]["half_width"]
            wrong += half is not None and half < CLOSE * abs(r["truth"][name]) and error * r["truth"][name] > 3 * half
        print(
            f"| `{name}` | {sum(e < CLOSE for e in own)} of {len(results)} | {wrong} | {sum(e < CLOSE for e in other)} | "
            f"{100 * np.median(own):.1f} % | {100 * np.median(other):.1f} % |"
        )
    told = [name for name in PARAMETERS if name not in UNTOLD]
    close = [
        [sum(abs(of(r, name) / r["truth"][name] - 1) < CLOSE for name in told) for r in results]
        for of in (lambda r, name: r["latsch"][name]["value"], lambda r, name: r["rival"][name])
    ]
    print(f"\nof {len(told)} parameters of a tire within 2 %, median: latsch {np.median(close[0]):.0f}, rival {np.median(close[1]):.0f}")
    seconds = np.array([r["seconds"] for r in results])
    ratios = seconds[:, 1] / seconds[:, 0]
    done = sum(r["finished"] for r in results)
    print(
        f"\nlatsch {np.median(seconds[:, 0]):.1f} s, rival {np.median(seconds[:, 1]):.0f} s ({done} of {len(results)} came to an end in "
        f"{options.budget:.0f} s); ratio {np.median(ratios):.0f}, from {ratios.min():.0f} to {ratios.max():.0f}"
    )


if __name__ == "__main__":
    main()
