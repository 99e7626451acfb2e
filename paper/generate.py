#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, tables and figures of the paper, from records.

usage: generate.py RECORDS OUT

RECORDS has a folder for each experiment, of its name; one that is absent leaves its part out. OUT gets numbers.tex,
tables/, figures/, and have/<name>.tex for every experiment of which there is a record.

    import generate
    generate.numbers_of("experiments/record")        # {"publishedList": 1.40, ...}: the numbers, nothing written
    generate.texts_of("experiments/record")          # the same as they stand in the paper, as LaTeX
"""

import sys
from pathlib import Path

import matplotlib

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "plots")]
import boxes_parts as boxes  # noqa: E402
import bunnies_parts as bunnies  # noqa: E402
import exactness_parts as exactness  # noqa: E402
import law_parts as law  # noqa: E402
import libraries_parts as libraries  # noqa: E402
import machine_part as machine  # noqa: E402
import strategies_parts as strategies  # noqa: E402
import volumes_parts as volumes  # noqa: E402
import worlds_parts as worlds  # noqa: E402
from sheet import Paper  # noqa: E402

# The law is fitted in one part and tried on others.
PARTS = (
    machine.write_machine,
    bunnies.write_nine_bunnies,
    bunnies.write_talk,
    bunnies.write_talk_scalar,
    law.write_coherence,
    strategies.write_best_rebuilds,
    strategies.write_winners,
    strategies.write_workloads,
    law.write_sweep,
    law.write_law_unseen,
    law.write_law_bullet,
    law.write_predict,
    volumes.write_tightness,
    volumes.write_fits,
    volumes.write_posing,
    volumes.write_cost_model,
    libraries.write_hierarchies,
    libraries.write_narrow_phase,
    libraries.write_tournament,
    libraries.write_tori,
    libraries.write_peers_cgal,
    libraries.write_closest_features,
    exactness.write_triangles,
    exactness.write_stability,
    exactness.write_precision,
    exactness.write_distance_error,
    exactness.write_budget,
    boxes.write_boxes,
    boxes.write_boxes_motions,
    boxes.write_boxes_sorts,
    boxes.write_boxes_fast,
    boxes.write_boxes_peers,
    boxes.write_boxes_displacement,
    worlds.write_worlds,
)


def filled(records, out=None):
    paper = Paper(records, out)
    with matplotlib.rc_context():  # letters of print are for the paper's figures alone
        for part in PARTS:
            part(paper)
    return paper


def numbers_of(records):
    """Every number of the paper, by the name of its macro."""
    return filled(records).values


def texts_of(records):
    return filled(records).numbers


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: generate.py RECORDS OUT")
    filled(*sys.argv[1:]).write_numbers()


if __name__ == "__main__":
    main()
