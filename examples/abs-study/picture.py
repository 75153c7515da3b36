#!/usr/bin/env python3
"""The picture of the study stopping-distance.toml: distance over friction, and what the thresholds do to it.

    examples/abs-study/picture.py stopping-distance.parquet picture.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyarrow.parquet


def main(table, picture):
    rows = [row for row in pyarrow.parquet.read_table(table).to_pylist() if row["status"] == "ok"]
    column = {name: np.array([row[name] for row in rows]) for name in ("friction", "distance [m]", "abs.slip_dump", "abs.slip_dump_always")}
    friction, distance = column["friction"], column["distance [m]"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")

    values = np.unique(friction)
    of = [distance[friction == f] for f in values]
    left.fill_between(values, [d.min() for d in of], [d.max() for d in of], color="tab:blue", alpha=0.3, label="least to greatest")
    left.plot(values, [np.median(d) for d in of], "o-", color="tab:blue", label="median of the thresholds")
    left.set(xlabel="friction factor", ylabel="stopping distance [m]", title=f"{len(rows)} stops from 100 km/h")
    left.grid(alpha=0.3)
    left.legend()

    # each pair of thresholds against the best one of the same friction, in the mean over the frictions
    best = {f: d.min() for f, d in zip(values, of)}
    pairs = {}
    for f, d, *pair in zip(friction, distance, column["abs.slip_dump"], column["abs.slip_dump_always"]):
        pairs.setdefault(tuple(pair), []).append(100 * (d / best[f] - 1))
    x, y = np.array(list(pairs)).T
    points = right.scatter(x, y, c=[np.mean(p) for p in pairs.values()], cmap="viridis", s=45)
    right.set(xlabel="slip_dump", ylabel="slip_dump_always", title="longer than the best thresholds")
    figure.colorbar(points, ax=right, label="mean over all frictions [%]")
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
