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
import coherence_parts as coherence  # noqa: E402
import exactness_parts as exactness  # noqa: E402
import hierarchies_parts as hierarchies  # noqa: E402
import machine_part as machine  # noqa: E402
import worlds_parts as worlds  # noqa: E402
from sheet import Paper  # noqa: E402

# The law is fitted in one part and tried on others.
PARTS = (machine.write_machine, coherence.write_nine_bunnies, coherence.write_talk, coherence.write_coherence, coherence.write_best_rebuilds, coherence.write_winners,
         coherence.write_workloads, coherence.write_sweep, hierarchies.write_tightness, hierarchies.write_fits,
         hierarchies.write_posing, hierarchies.write_cost_model, hierarchies.write_hierarchies, hierarchies.write_narrow_phase,
         hierarchies.write_tori, hierarchies.write_peers_cgal, hierarchies.write_closest_features, exactness.write_triangles, exactness.write_stability,
         exactness.write_precision, exactness.write_distance_error, exactness.write_budget, boxes.write_boxes, boxes.write_boxes_motions,
         boxes.write_boxes_fast, boxes.write_boxes_peers, boxes.write_boxes_displacement, worlds.write_worlds)


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
