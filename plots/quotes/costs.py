# SPDX-License-Identifier: BSD-3-Clause
"""The cost model, and time against error."""

import numpy as np

from bvlab_plots import records
from bvlab_scripts import cost_model
from quoting import Interval, claim, quotes

COUNTS = ["n_u", "n_v", "n_p"]


def fitted(rows):
    """By volume, three constants fitted to its rows, and their median error as a share of the time."""
    def fit(part):
        terms = part[COUNTS].to_numpy(float) / part.time_ns.to_numpy()[:, None]
        constants = np.linalg.lstsq(terms, np.ones(len(part)), rcond=None)[0]
        return constants, np.median(np.abs(terms @ constants - 1))
    return {volume: fit(part) for volume, part in rows.groupby("volume")}


@quotes("cost-model")
def cost(record):
    rows, costs, triangle = cost_model.read(record)
    share = rows.predicted_ns / rows.time_ns
    pose = {volume: cost["pose"] for volume, cost in costs.items()}
    batched = {volume: cost["batched"] for volume, cost in costs.items()}
    claim(min(pose, key=pose.get) == min(batched, key=batched.get) == "sphere", "spheres cost least")
    claim(max(pose, key=pose.get) == "kdop26", "26-DOPs cost most to pose")
    claim(max(batched, key=batched.get) == "shell", "shells cost most to test")
    claim(share.quantile(0.9) < 0.9, "the model predicts too little in nine of ten cells")
    busy = rows[rows.density != "sparse"]
    near, everywhere = fitted(busy), fitted(rows)
    claim(all((constants[:2] > 0).all() for constants, _ in near.values()), "where bodies are near each other all fitted costs of volumes are positive")
    near_negative, negative = (sum(constants[2] < 0 for constants, _ in fits.values()) for fits in (near, everywhere))
    left = ((busy.time_ns - busy.predicted_ns) / busy.n_v).groupby(busy.volume)
    claim(all(batched[volume] < middle for volume, middle in left.median().items() if volume != "shell"),
          "C_v is less than the engine around it for all volumes but the shell")
    return {"pose_least": pose["sphere"], "pose_most": pose["kdop26"], "test_least": batched["sphere"],
            "test_most": batched["shell"], "alone": Interval(cost["alone"] for cost in costs.values()),
            "triangle": triangle, "inner": Interval(share.quantile([0.05, 0.95])), "median": share.median(),
            "most": share.max(), "fitted": Interval(100 * error for _, error in near.values()),
            "fitted_all": Interval(100 * error for _, error in everywhere.values()), "near_negative": int(near_negative), "negative": int(negative), "volumes": len(everywhere),
            "left": Interval(left.median()), "quartiles": Interval([left.quantile(0.25).min(), left.quantile(0.75).max()])}


@quotes("distance-error")
def distance_error(record):
    rows = records.right(record)
    time = rows.groupby(["mesh", "relative_error", "volume"]).time_ns.median()
    saved = time.xs(0, level="relative_error") / time.xs(0.1, level="relative_error")
    small, large = time[time.index.get_level_values("relative_error") <= 0.01], time[time.index.get_level_values("relative_error") >= 0.3]
    best = small.groupby(["mesh", "relative_error"]).min()
    for mesh, volume in (("bunny", "rss"), ("knot", "shell")):
        claim((small.xs(volume, level="volume")[mesh] < 1.1 * best[mesh]).all(),
              f"up to a hundredth {volume} is fastest on the {mesh}")
    claim((large.xs("sphere", level="volume") < 1.1 * large.groupby(["mesh", "relative_error"]).min()).all(),
          "from 0.3 on it is spheres")
    claim((rows.largest_error <= rows.relative_error * (1 + 1e-9) + 1e-12).all(), "the error seen stays below that promised")
    return {"saved": Interval(saved)}
