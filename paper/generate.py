#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, tables and figures of the paper, from records.

usage: generate.py RECORDS OUT

Of every experiment the latest record is taken that is in RECORDS. OUT gets numbers.tex, tables/, figures/,
and have/<name>.tex for every experiment of which there is a record.
"""

import subprocess
import sys
from pathlib import Path


PLOTS = Path(__file__).resolve().parent.parent / "plots"
sys.path.insert(0, str(PLOTS))
import law  # noqa: E402
import nine_bunnies  # noqa: E402
import records  # noqa: E402


def latest(records, name):
    """The newest record that holds the experiment's table, or nothing."""
    def age(folder):
        date, _, number = folder.name.partition(".")
        return date, int(number) if number.isdigit() else 0
    found = [f for f in Path(records).iterdir() if (f / f"{name}.csv").is_file()]
    return max(found, key=age) if found else None


class Paper:
    def __init__(self, records, out):
        self.records, self.out = records, Path(out)
        self.numbers = {}
        for folder in ("tables", "figures", "have"):
            (self.out / folder).mkdir(parents=True, exist_ok=True)

    def record(self, name):
        found = latest(self.records, name)
        if found:
            print(f"{name}: {found}")
        else:
            print(f"{name}: no record")
        return found

    def have(self, name):
        (self.out / "have" / f"{name}.tex").write_text("% there is a record\n")

    def table(self, name, alignment, header, rows):
        lines = [r"\begin{tabular}{" + alignment + "}", r"\toprule", " & ".join(header) + r" \\", r"\midrule"]
        lines += [" & ".join(row) + r" \\" for row in rows]
        lines += [r"\bottomrule", r"\end{tabular}", ""]
        (self.out / "tables" / f"{name}.tex").write_text("\n".join(lines))

    def plot(self, record, script="draw"):
        """The figures that the record's definition declares, or those of a script."""
        subprocess.run([sys.executable, str(PLOTS / script), str(record), "--out", str(self.out / "figures")],
                       check=True, stdout=subprocess.DEVNULL)

    def write_numbers(self):
        text = "".join(f"\\newcommand{{\\{name}}}{{{value}}}\n" for name, value in self.numbers.items())
        (self.out / "numbers.tex").write_text(text)


# The seed's six.
PUBLISHED_METHODS = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]


def percent(value, digits=1):
    return f"{100 * value:.{digits}f}\\,\\%"


def escape(text):
    return str(text).replace("_", r"\_").replace("%", r"\%")


def write_nine_bunnies(paper):
    published = nine_bunnies.PUBLISHED.mean()
    for name, column in (("publishedList", "separation-list"), ("publishedDeferred", "deferred")):
        paper.numbers[name] = f"{published['recursive'] / published[column]:.2f}"
    record = paper.record("nine-bunnies")
    if not record:
        return
    runs = nine_bunnies.read(record)
    (reading, density), average = nine_bunnies.nearest_reading(runs)
    tests = nine_bunnies.speedups(runs, "n_v").groupby(level=["reading", "density"], sort=False).mean()
    nearest = average.loc[(reading, density)]
    paper.numbers.update(
        nearestReading=escape(reading), nearestDensity=escape(density),
        nearestList=f"{nearest['separation-list']:.2f}", nearestDeferred=f"{nearest['deferred']:.2f}",
        testsLeast=f"{tests.min().min():.2f}", testsMost=f"{tests.max().max():.2f}",
        bunniesRuns=str(runs.seed.nunique()))
    rows = []
    for (r, d), row in average.iterrows():
        saved = tests.loc[(r, d)]
        rows.append([escape(r), escape(d), f"{saved['separation-list']:.2f}", f"{row['separation-list']:.2f}",
                     f"{saved['deferred']:.2f}", f"{row['deferred']:.2f}"])
    paper.table("nine-bunnies", "llrrrr", ["what moves in a step", "density", "list: $N_v$", "time",
                                           "deferred: $N_v$", "time"], rows)
    paper.plot(record, "nine_bunnies.py")
    paper.have("nine-bunnies")


def write_boxes(paper):
    columns, cells, methods = [], {}, []
    for figure in (3, 4, 5):
        record = paper.record(f"boxes-figure-{figure}")
        if not record:
            return
        rows = records.read(record)
        records.wrong_answers(rows)
        # A static method is what it is either way; some took too long for a second frame.
        rows = rows.assign(coherent=rows.coherent.where(rows.peer == "", "off"))[rows.frame_ns > 0]
        rows = rows.groupby(["set", "boxes", "method", "coherent"], sort=False, as_index=False).frame_ns.median()
        for set_name, group in rows.groupby("set", sort=False):
            # The largest number of boxes that most methods have kept up to.
            counts = group.groupby("boxes").method.nunique()
            most = counts[counts >= 0.75 * counts.max()].index.max()
            columns.append(f"{escape(set_name)}, {most}")
            for row in group[group.boxes == most].itertuples():
                cells[row.method, len(columns) - 1, row.coherent] = row.frame_ns / 1e6
                methods.append(row.method)
        paper.plot(record)
    lines = []
    for method in dict.fromkeys(methods):
        line = [escape(method)]
        for k in range(len(columns)):
            off, on = cells.get((method, k, "off")), cells.get((method, k, "on"))
            line.append((f"{off:.1f}" if off is not None else "--") + (f" ({on:.1f})" if on is not None else ""))
        lines.append(line)
    paper.table("boxes", "l" + "r" * len(columns), ["method"] + columns, lines)
    best = {k: min((v, m) for (m, c, o), v in cells.items() if c == k and o == "off" and m in PUBLISHED_METHODS)
            for k in range(len(columns))}
    kept = {k: min(((v, m) for (m, c, o), v in cells.items() if c == k and o == "on" and m.startswith("sweep")),
                   default=None) for k in range(len(columns))}
    text = "Of the published methods the fastest from scratch is " + ", ".join(
        f"{escape(m)} ({columns[k]})" for k, (v, m) in best.items()) + "."
    won = [f"{escape(kept[k][1])} on {columns[k]}, in {100 * kept[k][0] / best[k][0]:.0f}\\,\\% of that time" for k in kept
           if kept[k] and kept[k][0] < best[k][0]]
    # Only the sweeps make use of coherence.
    text += (" With coherence it is beaten by " + " and by ".join(won) + ".") if won else (
        " With coherence no sweep is faster than that.")
    (paper.out / "tables" / "boxes-text.tex").write_text(text + "\n")
    paper.have("boxes")


def write_coherence(paper):
    record = paper.record("coherence")
    if not record:
        return
    rows = law.read(record)
    kappa = law.fit_kappa(rows)
    errors = law.errors(rows, kappa)
    constant = law.constant_errors(rows)
    lists = rows[rows.strategy.isin(law.LISTS)]
    best = lists.loc[lists.tests_saved.idxmax()]
    left_out = errors.get("left out", (float("nan"), float("nan"), 0))
    paper.numbers.update(
        lawKappa=f"{kappa:.2f}", lawCells=str(len(lists)), lawErrorFitted=percent(errors["fitted"][0]),
        lawErrorLeftOut=percent(left_out[0]))
    text = (f"Fitted on {' and '.join(law.FITTED_MESHES)} when all bodies move or one does, "
            f"$\\kappa = {kappa:.2f}$. The law is off by {percent(errors['fitted'][0])} (median; 95\\,\\% of cells within "
            f"{percent(errors['fitted'][1])}) on the {errors['fitted'][2]} cells fitted")
    if left_out[2]:
        unseen = lists[~law.fitted(lists)]
        others = [m for m in dict.fromkeys(unseen.mesh) if m not in law.FITTED_MESHES]
        text += (f", and by {percent(left_out[0])} (within {percent(left_out[1])}) on the {left_out[2]} cells left out of the fit"
                 + (f", other shapes ({', '.join(map(escape, others))}) among them" if others else ""))
    text += (f". The talk's constants, taken for every motion, are off by {percent(constant[0])} (within "
             f"{percent(constant[1])}). The largest speedup of either list is {best.tests_saved:.2f}, with {escape(best.volume)} and the "
             f"{escape(best.mesh)} at a survival of {best.survival:.3f} and a stillness of {best.stillness:.3f}.\n")
    margins = law.fit_margins(rows) if (rows.strategy == "margins").any() else None
    if margins:
        off = law.margins_errors(rows, margins)
        text += (f"\nMargins are another matter: what they leave to do has no floor at one half. It is "
                 f"${margins[0]:.2f}\\,m^{{{margins[1]:.2f}}}$ of the recursion's tests, for a motion of $m$ leaf sizes a frame "
                 f"(Figure~\\ref{{marginsfigure}}), to within a factor of "
                 + " and ".join(f"{v:.2f} ({k})" for k, v in off.items()) + ".\n")
    (paper.out / "tables" / "coherence-text.tex").write_text(text)
    crossings = []
    for query, strategy in ((q, s) for q in dict.fromkeys(rows["query"]) for s in law.strategies_of(rows)):
        of_query = rows[rows["query"] == query]
        line = [escape(query), escape(strategy)]
        for what in ("tests_saved", "time_saved"):
            at, wrong, won = law.crossing(of_query, strategy, what)
            line += ["--" if won > 0.99 else f"{at:.2f}", percent(won, 0)]
        group = of_query[of_query.strategy == strategy]
        line += [f"{group.time_saved.median():.2f}", f"{group.time_saved.min():.2f}", f"{group.time_saved.max():.1f}"]
        crossings.append(line)
    paper.table("coherence-crossing", "llrrrrrrr",
                ["query", "strategy", "tests: below", "wins", "time: below", "wins", "speedup: median", "least", "most"],
                crossings)
    ranks = law.rank_correlations(rows)
    paper.table("coherence-measures", "lrrrrr",
                ["strategy", "survival", "stillness", "growth", "motion in leaves", "in gaps"],
                [[escape(s)] + [f"{v:.2f}" for v in line] for s, line in zip(ranks.index, ranks.values)])
    paper.plot(record, "coherence.py")
    paper.have("coherence")
    if (rows.strategy == "margins").any():
        paper.have("margins")


def write_winners(paper):
    for name in ("winners-motion", "winners-scene"):
        record = paper.record(name)
        if record:
            paper.plot(record)
            paper.have(name)


def write_workloads(paper):
    record = paper.record("workloads")
    if not record:
        return
    rows = law.read(record)
    lines = [[escape(r.workload), escape(r.volume), escape(r.strategy), f"{r.survival:.2f}", f"{r.tests_saved:.2f}",
              f"{r.time_saved:.2f}"] for r in rows.itertuples() if r.strategy != "recursive"]
    paper.table("workloads", "lllrrr", ["workload", "volume", "strategy", "survival", "$N_v$", "time"], lines)
    paper.have("workloads")


# What tells one whole scene from another; the names of other pipelines.
SCENE = ["objects", "room", "step", "degrees", "moving"]
PIPELINES = {"fcl-world": "FCL", "bullet-world": "Bullet"}


def worlds_table(rows):
    """For each scene the best of ours, its milliseconds a frame, and how many times as long each peer takes."""
    rows = rows.assign(ms=rows.time_ns / 1e6 / (rows.frames - 1))  # of all frames but the first
    middle = rows.groupby(SCENE + ["peer", "variant"], sort=False, as_index=False).ms.median()
    for scene, group in middle.groupby(SCENE, sort=False):
        ours = group[group.peer == ""]
        best = ours.loc[ours.ms.idxmin()]
        theirs = group[group.peer != ""].set_index("peer").ms / best.ms
        yield dict(zip(SCENE, scene)), best, theirs


def write_worlds(paper):
    record = paper.record("worlds")
    paper.numbers["worldsMostObjects"] = "0"
    if not record:
        return
    rows = records.read(record)
    wrong = records.wrong_answers(rows)
    paper.numbers["worldsMostObjects"] = str(rows.objects.max())
    answers = rows[rows.peer == ""].groupby(SCENE).touching.first().sum()
    differing = rows[wrong | (rows.peer != "")].groupby(["peer", *SCENE]).differing.first().groupby("peer").sum()
    peers = list(dict.fromkeys(rows[rows.peer != ""].peer))
    paper.numbers["worldsAgreement"] = "Of " + f"{answers:.0f} touching pairs, " + " and ".join(
        f"{differing[peer]} differ in {PIPELINES.get(peer, peer)}" for peer in peers) + "."
    lines = [[str(scene["objects"]), f"{scene['step']:g}, {scene['degrees']:g}",
              "none" if scene["moving"] == 0 else percent(scene["moving"], 0), escape(best.variant),
              f"{best.ms:.3f}" if best.ms < 10 else f"{best.ms:.1f}",
              *(f"{theirs.get(peer, float('nan')):.1f}" for peer in peers)]
             for scene, best, theirs in worlds_table(rows[rows.room == rows.room.min()])]
    paper.table("worlds", "rlrlr" + "r" * len(peers), ["bodies", "step: radii, degrees", "moving", "best of ours", "ms",
                                                      *(PIPELINES.get(peer, peer) for peer in peers)], lines)
    paper.plot(record)
    paper.have("worlds")


def main():
    records, out = sys.argv[1:3]
    paper = Paper(records, out)
    for part in (write_nine_bunnies, write_boxes, write_coherence, write_winners, write_workloads, write_worlds):
        part(paper)
    paper.write_numbers()


if __name__ == "__main__":
    main()
