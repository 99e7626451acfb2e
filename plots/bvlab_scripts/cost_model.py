# SPDX-License-Identifier: BSD-3-Clause
"""The cost model T = N_u C_u + N_v C_v + N_p C_p: predicted from unit costs against measured.

usage: plots/script cost-model RECORD [--out FOLDER]

RECORD holds cost-model.csv and unit-costs.json (bench_unit_costs --benchmark_format=json).
"""

from pathlib import Path

from bvlab_plots import charts, records, stacks, style, unit_costs
from bvlab_plots.arguments import record_arguments
from bvlab_plots.figures import Figure
from bvlab_plots.points import points_of
from bvlab_plots.refused import Refused


def read(record):
    """The rows with the terms of T in ns and their sum, predicted_ns; unit costs of volumes and of triangles."""
    rows = records.right(record)
    if not (Path(record) / "unit-costs.json").is_file():
        raise Refused(f"{record}: has no unit-costs.json: it is the record of something else")
    costs, triangle = unit_costs.measured(Path(record) / "unit-costs.json")
    records.say_left_out(rows[rows.peer != ""].peer, "which count nothing")
    records.say_left_out(set(rows[rows.peer == ""].volume) - set(costs), "whose unit costs are not in unit-costs.json")
    attrs, rows = rows.attrs, rows[rows.volume.isin(costs)]
    rows.attrs.update(attrs, folder=record)
    rows, _ = stacks.with_terms(rows)
    rows["predicted_ns"] = rows[list(stacks.TERMS)].sum(axis=1)
    rows.attrs["units"]["predicted_ns"] = "ns"
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


def main():
    arguments = record_arguments(__doc__)
    print(draw_errors(read(arguments.record)[0], arguments.out))
