#!/usr/bin/env python3
"""What others make of the real recordings that `latsch diagnose` is held against: same runs, same split.

    scripts/real-recordings DATA RUNS
    python -m venv VENV; VENV/bin/pip install -r benches/rivals-requirements.txt
    VENV/bin/python benches/rivals.py RUNS [SET ...]

Prints a Markdown table: root mean square of measured minus simulated over all check runs, in free run, by

- nominal: the model as it is given, start values;
- refit: its parameters by scipy's least squares, nothing else;
- SINDy: the refitted model plus terms that PySINDy finds in what it leaves (sequentially thresholded least squares,
  polynomials to the third degree in the columns named in the table; the threshold is the one of a list with the
  smallest free-run error on every third of the fit runs, the final coefficients are from all of them);
- NARX: sysidentpy's FROLS, polynomials to the third degree in the last two outputs and inputs, least squares; degree
  and number of terms are chosen as the threshold above (BIC, which judges one step ahead, chooses worse ones). It is
  started with the measured output of its first two samples.

A run that leaves ten times the measured range counts as diverged. Nobody is told what is missing.
"""

import itertools
import pathlib
import sys
import time
import tomllib
import warnings

import numpy as np
import pysindy
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lfilter, lfiltic
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS
from sysidentpy.parameter_estimation import LeastSquares

warnings.filterwarnings("ignore")
DIVERGED = float("inf")


class Run:
    def __init__(self, path):
        with open(path) as file:
            names = [cell.split(" [")[0] for cell in file.readline().strip().split(",")]
            values = np.loadtxt(file, delimiter=",").T
        self.name = path.stem
        self.columns = dict(zip(names, values))
        self.time = self.columns["time"]

    def __getitem__(self, name):
        return self.columns[name]


def rms(errors):
    errors = np.concatenate(errors)
    return float(np.sqrt(np.mean(errors**2))) if np.all(np.isfinite(errors)) else DIVERGED


class Oscillator:
    """m x'' + d x' + k x = F + F0, free run from rest; what is missing may depend on the state."""

    inputs, output, unit, scale = ["force"], "position", "mV", 1e3
    names = ["mass", "damping", "stiffness", "offset"]
    size = [1e-6, 1e-4, 0.1, 1e-3]
    columns = ["x", "v"]
    # NARX at the recorded rate: the conversion refined it
    every = 4

    @staticmethod
    def simulate(run, p):
        m, d, k, f0 = p
        dt = run.time[1] - run.time[0]
        b, a, _ = cont2discrete(([1.0], [m, d, k]), dt, method="foh")
        b = np.ravel(b)
        rest = (run["force"][0] + f0) / k
        start = lfiltic(b, a, [rest] * 2, [run["force"][0] + f0] * 2)
        return lfilter(b, a, run["force"] + f0, zi=start)[0]

    @staticmethod
    def features(run):
        return np.c_[run["position"], np.gradient(run["position"], run.time)]

    @staticmethod
    def discrepancy(run, p):
        m, d, k, f0 = p
        x, v = Oscillator.features(run).T
        return np.gradient(v, run.time) - (run["force"] + f0 - d * v - k * x) / m

    @staticmethod
    def corrected(run, p, terms):
        """Runge-Kutta at the runs' step, forces on straight lines; terms are ((powers), coefficient)."""
        m, d, k, f0 = map(float, p)
        dt = float(run.time[1] - run.time[0])
        force = run["force"].tolist()
        text = " + ".join(f"({c!r})*x**{i}*v**{j}" for (i, j), c in terms) or "0.0"
        a = eval(f"lambda x, v, u: (u + {f0!r} - {d!r}*v - {k!r}*x)/{m!r} + {text}")
        x, v, limit = (force[0] + f0) / k, 0.0, 10 * float(np.ptp(run["position"]))
        out = [x]
        for u0, u1 in itertools.pairwise(force):
            um = 0.5 * (u0 + u1)
            a1 = a(x, v, u0)
            v2 = v + 0.5 * dt * a1
            a2 = a(x + 0.5 * dt * v, v2, um)
            v3 = v + 0.5 * dt * a2
            a3 = a(x + 0.5 * dt * v2, v3, um)
            v4 = v + dt * a3
            a4 = a(x + dt * v3, v4, u1)
            x, v = x + dt / 6 * (v + 2 * v2 + 2 * v3 + v4), v + dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            if not abs(x) < limit:
                return np.full(len(force), np.nan)
            out.append(x)
        return np.array(out)


class Static:
    """Models without a state: the terms are added to the output."""

    every = 1

    @classmethod
    def discrepancy(cls, run, p):
        return run[cls.output] - cls.simulate(run, p)

    @classmethod
    def corrected(cls, run, p, terms):
        columns = cls.features(run).T
        out = cls.simulate(run, p)
        for powers, c in terms:
            out = out + c * np.prod([x**n for x, n in zip(columns, powers)], axis=0)
        return out


class Cylinder(Static):
    inputs, output, unit, scale = ["pressure", "velocity", "position"], "force", "N", 1.0
    names, size = ["area"], [1e-4]
    columns = ["p", "v", "x"]

    @staticmethod
    def simulate(run, p):
        return run["pressure"] * p[0]

    @staticmethod
    def features(run):
        return np.c_[run["pressure"], run["velocity"], run["position"]]


class Belt(Static):
    inputs, output, unit, scale = ["belt_speed"], "pitch_moment", "N.m", 1.0
    names, size = ["moment"], [1.0]
    columns = ["v", "dv/dt"]

    @staticmethod
    def simulate(run, p):
        return np.full(len(run.time), p[0])

    @staticmethod
    def features(run):
        return np.c_[run["belt_speed"], np.gradient(run["belt_speed"], run.time)]


class FineBelt(Belt):
    every = 4


SETS = {
    "silverbox": Oscillator,
    "pneumatic-cylinder-o-ring": Cylinder,
    "pneumatic-cylinder-napn": Cylinder,
    "pneumatic-cylinder-x-ring": Cylinder,
    "instrumented-belt": FineBelt,
    "instrumented-belt-unfiltered": Belt,
}


def thirds(runs):
    """Two of three runs to learn from, every third to choose settings by: all operating conditions are in both."""
    judge = runs[1::3]
    return [r for r in runs if r not in judge], judge


def refit(model, start, runs):
    size = np.array(model.size)

    def residual(z):
        return np.concatenate([(model.simulate(r, z * size) - r[model.output])[:: model.every] for r in runs])

    return least_squares(residual, start / size).x * size


def sindy(model, p, fit):
    """Terms in units of the columns, and how they were found."""
    train, judge = thirds(fit)
    scales = np.abs(np.concatenate([model.features(r) for r in fit])).max(axis=0)
    size = np.std(np.concatenate([model.discrepancy(r, p) for r in fit]))

    def find(runs, threshold):
        library = pysindy.PolynomialLibrary(degree=3)
        found = pysindy.SINDy(optimizer=pysindy.STLSQ(threshold=threshold, alpha=1e-6), feature_library=library)
        x = [(model.features(r) / scales)[:: model.every] for r in runs]
        # the discrepancy is the first column's derivative, the others are none
        y = [
            np.c_[model.discrepancy(r, p) / size, np.zeros((len(r.time), len(scales) - 1))][:: model.every] for r in runs
        ]
        found.fit(x, t=1.0, x_dot=y)
        coefficients = found.coefficients()[0]
        powers = library.powers_
        return [
            (tuple(int(n) for n in n_s), float(c * size / np.prod(scales**n_s)))
            for n_s, c in zip(powers, coefficients)
            if c != 0
        ], [float(c) for c in coefficients if c != 0]

    best = (DIVERGED, None)
    for threshold in [0.01, 0.03, 0.1, 0.3, 1.0]:
        terms, _ = find(train, threshold)
        error = rms([model.corrected(r, p, terms) - r[model.output] for r in judge])
        if error < best[0]:
            best = (error, threshold)
    if best[1] is None:
        return [], "every threshold diverges"
    terms, sizes = find(fit, best[1])
    order = np.argsort(-np.abs(sizes))
    names = ["·".join(f"{c}^{n}" if n > 1 else c for c, n in zip(model.columns, terms[i][0]) if n) or "1" for i in order]
    signs = ["-" if terms[i][1] < 0 else "+" for i in order]
    return terms, f"{len(terms)} terms (threshold {best[1]}): " + " ".join(s + n for s, n in zip(signs, names[:6]))


def narx(model, fit, check):
    def columns(run):
        x = np.c_[tuple(run[name] for name in model.inputs)][:: model.every]
        return x, run[model.output][:: model.every].reshape(-1, 1)

    lags, inputs = 2, len(model.inputs)
    scales = np.abs(np.concatenate([columns(r)[0] for r in fit])).max(axis=0)
    size = np.abs(np.concatenate([columns(r)[1] for r in fit])).max()

    def learn(runs, degree, terms):
        found = FROLS(
            order_selection=False,
            n_terms=terms,
            ylag=lags,
            xlag=[list(range(1, lags + 1))] * inputs if inputs > 1 else lags,
            estimator=LeastSquares(),
            basis_function=Polynomial(degree=degree),
        )
        x, y = (np.concatenate(part) for part in zip(*map(columns, runs)))
        found.fit(X=x / scales, y=y / size)
        return found

    def errors(found, runs):
        out = []
        for run in runs:
            x, y = columns(run)
            with np.errstate(all="ignore"):
                simulated = found.predict(X=x / scales, y=y[:lags] / size) * size
            bad = not np.all(np.abs(simulated) < 10 * np.ptp(y) + np.abs(y).max())
            out.append(np.full(len(y), np.nan) if bad else np.ravel(simulated - y))
        return out

    train, judge = thirds(fit)
    best = (DIVERGED, None)
    for degree, terms in [(1, 4), (2, 4), (2, 8), (2, 14), (3, 4), (3, 8), (3, 16)]:
        error = rms(errors(learn(train, degree, terms), judge))
        if error < best[0]:
            best = (error, (degree, terms))
    if best[1] is None:
        return [np.full(1, np.nan) for _ in check], "every degree and number of terms diverges"
    found = learn(fit, *best[1])
    return errors(found, check), f"{best[1][1]} lagged products of degree {best[1][0]}, none with a name"


def main():
    folder = pathlib.Path(sys.argv[1])
    print("| recordings | channel | method | check error | settings, what it names | s |")
    print("|---|---|---|---|---|---|")
    for name in sys.argv[2:] or SETS:
        model = SETS[name]
        given = tomllib.loads((folder / name / "parameters.toml").read_text())["parameters"]
        start = np.array([given[n] for n in model.names])
        uses = tomllib.loads((folder / name / "runs.toml").read_text())["runs"]
        fit, check = ([Run(folder / name / n) for n, use in uses.items() if use == u] for u in ("fit", "check"))

        def row(method, errors, text, begun):
            error = rms(errors)
            shown = "diverged" if error == DIVERGED else f"{model.scale * error:.3g} {model.unit}"
            parts = {}
            if name == "silverbox":
                parts = {"arrow": ["arrow"]}
            if name.startswith("instrumented-belt"):
                parts = {g: [r.name for r in check if r.name.startswith(g)] for g in ("fast", "slow")}
            for part, runs in parts.items():
                of_part = rms([e for e, r in zip(errors, check) if r.name in runs])
                shown += f"; {part} " + ("diverged" if of_part == DIVERGED else f"{model.scale * of_part:.3g}")
            print(f"| {name} | {model.output} | {method} | {shown} | {text} | {time.time() - begun:.0f} |", flush=True)

        begun = time.time()
        row("nominal", [model.simulate(r, start) - r[model.output] for r in check], "–", begun)
        begun = time.time()
        p = refit(model, start, fit)
        values = ", ".join(f"{n} {v:.4g}" for n, v in zip(model.names, p))
        row("refit (scipy)", [model.simulate(r, p) - r[model.output] for r in check], f"parameters only: {values}", begun)
        begun = time.time()
        terms, text = sindy(model, p, fit)
        row("SINDy on what is left", [model.corrected(r, p, terms) - r[model.output] for r in check], text, begun)
        begun = time.time()
        row("NARX (FROLS)", *narx(model, fit, check), begun)


main()
