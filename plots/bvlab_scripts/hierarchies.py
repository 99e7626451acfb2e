# SPDX-License-Identifier: BSD-3-Clause
"""The best of ours beside the best of the peers in each cell, and the tests that each variant makes, as tables.

usage: plots/script hierarchies RECORD

Times are those of all frames but the first, which builds what the others use again. The figures are declared in the
record's definition: plots/draw.
"""

import argparse

import pandas as pd

from bvlab_plots import records
from bvlab_plots.refused import Refused

PLACES = ["query", "polygons", "density", "motion"]  # what may tell one trace from another


def read(record):
    """The median time a pair of each variant in each cell, where its answers are right; and the rows."""
    rows = records.read(record, needs=["later_ns", "later_pairs"])
    wrong = records.wrong_answers(rows)
    records.say_left_out(rows[wrong].variant, "where their answers differ")
    rows = rows[~wrong].assign(us=rows.later_ns / rows.later_pairs / 1e3)
    places = [place for place in PLACES if place in rows and rows[place].nunique() > 1]
    if not places or not (rows.peer != "").any():
        raise Refused(f"{record}: has no peers, or none of {', '.join(PLACES)} that varies: it is the record of something else")
    middle = rows.groupby(places + ["peer", "strategy", "variant"], sort=False, as_index=False).us.median()
    return rows, middle, places


def best(middle, places):
    """One row a cell: the best of ours, of ours without coherence, and of the peers, and how many times as fast."""
    def of(part, name):
        part = part.loc[part.groupby(places, sort=False).us.idxmin()]
        return part.set_index(places)[["variant", "us"]].add_prefix(name + " ")
    ours = middle[middle.peer == ""]
    table = pd.concat([of(ours[ours.strategy == "recursive"], "recursive"), of(ours, "best"),
                       of(middle[middle.peer != ""], "peer")], axis=1)
    for name in ("recursive", "best"):
        table[f"{name}: times faster"] = table["peer us"] / table[f"{name} us"]
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    rows, middle, places = read(parser.parse_args().record)
    with pd.option_context("display.width", 250, "display.max_columns", 40, "display.max_rows", 500):
        print("Best of ours against best of the peers, microseconds a pair and frame:")
        print(best(middle, places).round(2).to_string())
        print("\nTests a pair and frame, mean over scenes and motions:")
        tests = rows.assign(n_v=rows.n_v / rows.pairs, n_p=rows.n_p / rows.pairs)
        print(tests.pivot_table(index="variant", columns=places[:2], values=["n_v", "n_p"], sort=False).round(1)
              .to_string())

