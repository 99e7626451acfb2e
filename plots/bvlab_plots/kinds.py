# SPDX-License-Identifier: BSD-3-Clause
"""The kinds of figures: what each makes of rows, and how it draws that."""

from bvlab_plots import charts, distributions, maps, points, records, scatters, stacks

POINTS = {"ecdf": distributions.values_of, "box": distributions.values_of, "stacked": stacks.points_of}
DRAWN = {"map": maps.draw, "scatter": scatters.draw, "ecdf": distributions.draw, "box": distributions.draw,
         "stacked": stacks.draw, "table": None}


class Rows:
    """A record's rows as figures want them: by which clock, of which table; each is read once."""

    def __init__(self, record):
        self.record, self.known = record, {}

    def of(self, figure):
        # Where frames were timed by the wall clock nobody knows the processor's share: beside them means are of the same clock.
        of_frames = records.times_of_frames(f"{figure.y} {figure.value}")
        clock = "wall" if of_frames and records.clock_of_frames(self.record) == "wall" else "processor"
        key = figure.table, figure.clock or clock
        if key not in self.known:
            self.known[key] = records.read(self.record, key[0], clock=key[1])
            self.known[key].attrs["folder"] = str(self.record)
        return self.known[key]


def points_of(rows, figure):
    return POINTS.get(figure.kind, points.points_of)(rows, figure)


def drawing_of(figure, found):
    """A matplotlib figure; of a table none."""
    draw = DRAWN.get(figure.kind, charts.draw)
    return draw(figure, found) if draw else None
