# SPDX-License-Identifier: BSD-3-Clause
"""The cost model T = N_u C_u + N_v C_v + N_p C_p: predicted from unit costs against measured, and
where the time goes.

usage: plots/script cost-model RECORD [--out FOLDER]

RECORD holds cost-model.csv and unit-costs.json (bench_unit_costs --benchmark_format=json).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from bvlab_plots import charts, records, style, unit_costs
from bvlab_plots.arguments import record_arguments
from bvlab_plots.figures import Figure
from bvlab_plots.points import points_of
from bvlab_plots.refused import Refused
from bvlab_plots.stacks import TERMS

def read(record):
    """The rows with the terms of T in ns and their sum, predicted_ns; unit costs of volumes and of triangles."""
    rows = records.read(record)
    records.wrong_answers(rows)
    if not (Path(record) / "unit-costs.json").is_file():
        raise Refused(f"{record}: has no unit-costs.json: it is the record of something else")
    costs, triangle = unit_costs.measured(Path(record) / "unit-costs.json")
    records.say_left_out(rows[rows.peer != ""].peer, "which count nothing")
    attrs, rows = rows.attrs, rows[rows.peer == ""]
    records.say_left_out(set(rows.volume) - set(costs), "whose unit costs are not in unit-costs.json")
    rows = rows[rows.volume.isin(costs)].copy()
    rows["posing_ns"] = rows.n_u * rows.volume.map(lambda v: costs[v]["pose"])
    rows["volumes_ns"] = rows.n_v * rows.volume.map(lambda v: costs[v]["batched"])
    rows["triangles_ns"] = rows.n_p * triangle
    rows["predicted_ns"] = rows[list(TERMS)].sum(axis=1)
    rows.attrs.update(attrs, units={**attrs["units"], **{name: "ns" for name in [*TERMS, "predicted_ns"]}})
    return rows, costs, triangle


def draw_errors(rows, out):
    """What the model says over what was measured: medians over strategies and motions, with quartiles."""
    figure = Figure(name="cost-model-error", x="volume", y="predicted_ns / time_ns", series="density",
                    panels="query", log="none", y_label="predicted / measured time",
                    pool="strategy, motion")
    drawing = charts.draw(figure, points_of(rows, figure))
    for axis in drawing.get_axes():
        axis.axhline(1, color="#8f8f8f", linewidth=0.8, zorder=1)
        axis.set_ylim(0, 1.05 * max(1, axis.get_ylim()[1]))
    return style.save(drawing, out, figure.name)


def draw_split(rows, out):
    """One strategy and motion, where pairs cost more than to be looked at."""
    part = rows[(rows.strategy == "recursive") & (rows.motion == rows.motion.iloc[0]) & (rows.density != "sparse")]
    part = part.groupby(["query", "density", "volume"], sort=False, as_index=False).median(numeric_only=True)
    panels = list(dict.fromkeys(zip(part["query"], part.density)))
    figure, axes = plt.subplots(1, len(panels), figsize=(1.8 * len(panels), 3.0), squeeze=False)
    for axis, (query, density) in zip(axes[0], panels):
        group = part[(part["query"] == query) & (part.density == density)]
        bottom = np.zeros(len(group))
        for column, (label, colour, _) in TERMS.items():
            height = (group[column] / group.pairs / 1e3).to_numpy()
            axis.bar(group.volume, height, bottom=bottom, color=colour, label=label)
            bottom += height
        axis.plot(group.volume, group.time_ns / group.pairs / 1e3, "x", color="#b0413e", label="measured")
        axis.set_title(f"{query}, {density}")
        axis.tick_params(axis="x", rotation=90)
    axes[0, 0].set_ylabel("time per pair (µs)")
    figure.tight_layout()
    style.legend_below(figure, *axes[0, 0].get_legend_handles_labels())
    return style.save(figure, out, "cost-model-split")


def print_tables(rows, costs, triangle):
    table = pd.DataFrame({v: {"place": c["place"], "C_u": c["pose"], "C_v batched": c["batched"],
                              "C_v alone": c["alone"]} for v, c in costs.items()}).T
    print("Unit costs, ns:")
    print(table.round(1).to_string())
    print(f"C_p, batched: {triangle:.1f} ns")
    ratio = rows.predicted_ns / rows.time_ns
    print("Predicted / measured, median by density and strategy:")
    print(ratio.groupby([rows.density, rows.strategy], sort=False).median().unstack().round(2).to_string())
    print("Predicted / measured, quantiles over all:", ratio.quantile([0, 0.05, 0.5, 0.95, 1]).round(2).to_dict())
    busy = rows[rows.density != "sparse"]
    loop = (busy.time_ns - busy.predicted_ns) / busy.n_v
    print("What is left over, ns a test of volumes (dense and interlocked):")
    print(loop.groupby(busy.volume, sort=False).describe()[["25%", "50%", "75%"]].round(1).to_string())


def main():
    arguments = record_arguments(__doc__)
    rows, costs, triangle = read(arguments.record)
    print_tables(rows, costs, triangle)
    print(draw_errors(rows, arguments.out))
    print(draw_split(rows, arguments.out))

