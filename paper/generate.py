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
import boxes_time  # noqa: E402
import coherence  # noqa: E402
import nine_bunnies  # noqa: E402
import worlds  # noqa: E402


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

    def plot(self, script, *arguments):
        subprocess.run([sys.executable, str(PLOTS / script), *map(str, arguments), "--out",
                        str(self.out / "figures")], check=True, stdout=subprocess.DEVNULL)

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
    paper.plot("nine_bunnies.py", record)
    paper.have("nine-bunnies")


def write_boxes(paper):
    columns, cells, methods = [], {}, []
    for figure in (3, 4, 5):
        record = paper.record(f"boxes-figure-{figure}")
        if not record:
            return
        rows = boxes_time.read(record)[1]
        if "changes" in rows:
            rows = rows[rows.changes == "off"]
        for set_name, group in rows.groupby("set", sort=False):
            # The largest number of boxes that most methods have kept up to.
            counts = group.groupby("boxes").method.nunique()
            most = counts[counts >= 0.75 * counts.max()].index.max()
            columns.append(f"{escape(set_name)}, {most}")
            for row in group[group.boxes == most].itertuples():
                cells[row.method, len(columns) - 1, row.coherent] = row.time / 1e6
                methods.append(row.method)
        paper.plot("boxes_time.py", record)
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
    rows = coherence.read(record)
    kappa = coherence.fit_kappa(rows)
    errors = coherence.errors(rows, kappa)
    constant = coherence.constant_errors(rows)
    lists = rows[rows.strategy.isin(coherence.LISTS)]
    best = lists.loc[lists.tests_saved.idxmax()]
    left_out = errors.get("left out", (float("nan"), float("nan"), 0))
    paper.numbers.update(
        lawKappa=f"{kappa:.2f}", lawCells=str(len(lists)), lawErrorFitted=percent(errors["fitted"][0]),
        lawErrorLeftOut=percent(left_out[0]))
    text = (f"Fitted on {' and '.join(coherence.FITTED_MESHES)} when all bodies move or one does, "
            f"$\\kappa = {kappa:.2f}$. The law is off by {percent(errors['fitted'][0])} (median; 95\\,\\% of cells within "
            f"{percent(errors['fitted'][1])}) on the {errors['fitted'][2]} cells fitted")
    if left_out[2]:
        unseen = lists[~coherence.fitted(lists)]
        others = [m for m in dict.fromkeys(unseen.mesh) if m not in coherence.FITTED_MESHES]
        text += (f", and by {percent(left_out[0])} (within {percent(left_out[1])}) on the {left_out[2]} cells left out of the fit"
                 + (f", other shapes ({', '.join(map(escape, others))}) among them" if others else ""))
    text += (f". The talk's constants, taken for every motion, are off by {percent(constant[0])} (within "
             f"{percent(constant[1])}). The largest speedup of either list is {best.tests_saved:.2f}, with {escape(best.volume)} and the "
             f"{escape(best.mesh)} at a survival of {best.survival:.3f} and a stillness of {best.stillness:.3f}.\n")
    law = coherence.fit_margins(rows) if (rows.strategy == "margins").any() else None
    if law:
        off = coherence.margins_errors(rows, law)
        text += (f"\nMargins are another matter: what they leave to do has no floor at one half. It is "
                 f"${law[0]:.2f}\\,m^{{{law[1]:.2f}}}$ of the recursion's tests, for a motion of $m$ leaf sizes a frame "
                 f"(Figure~\\ref{{marginsfigure}}), to within a factor of "
                 + " and ".join(f"{v:.2f} ({k})" for k, v in off.items()) + ".\n")
    (paper.out / "tables" / "coherence-text.tex").write_text(text)
    crossings = []
    for query, strategy in ((q, s) for q in dict.fromkeys(rows["query"]) for s in coherence.strategies_of(rows)):
        of_query = rows[rows["query"] == query]
        line = [escape(query), escape(strategy)]
        for what in ("tests_saved", "time_saved"):
            at, wrong, won = coherence.crossing(of_query, strategy, what)
            line += ["--" if won > 0.99 else f"{at:.2f}", percent(won, 0)]
        group = of_query[of_query.strategy == strategy]
        line += [f"{group.time_saved.median():.2f}", f"{group.time_saved.min():.2f}", f"{group.time_saved.max():.1f}"]
        crossings.append(line)
    paper.table("coherence-crossing", "llrrrrrrr",
                ["query", "strategy", "tests: below", "wins", "time: below", "wins", "speedup: median", "least", "most"],
                crossings)
    ranks = coherence.rank_correlations(rows)
    paper.table("coherence-measures", "lrrrrr",
                ["strategy", "survival", "stillness", "growth", "motion in leaves", "in gaps"],
                [[escape(s)] + [f"{v:.2f}" for v in line] for s, line in zip(ranks.index, ranks.values)])
    paper.plot("coherence.py", record)
    paper.have("coherence")
    if (rows.strategy == "margins").any():
        paper.have("margins")


def write_winners(paper):
    for name in ("winners-motion", "winners-scene"):
        record = paper.record(name)
        if record:
            paper.plot("winner_maps.py", record)
            paper.have(name)


def write_workloads(paper):
    record = paper.record("workloads")
    if not record:
        return
    rows = coherence.read(record)
    lines = [[escape(r.workload), escape(r.volume), escape(r.strategy), f"{r.survival:.2f}", f"{r.tests_saved:.2f}",
              f"{r.time_saved:.2f}"] for r in rows.itertuples() if r.strategy != "recursive"]
    paper.table("workloads", "lllrrr", ["workload", "volume", "strategy", "survival", "$N_v$", "time"], lines)
    paper.have("workloads")


def write_worlds(paper):
    record = paper.record("worlds")
    paper.numbers["worldsMostObjects"] = "0"
    if not record:
        return
    rows = worlds.read(record)
    table = worlds.ratios(rows)
    paper.numbers["worldsMostObjects"] = str(table.objects.max())
    answers = rows[rows.peer == ""].groupby(worlds.SCENE).touching.first().sum()
    differing = rows[rows.peer != ""].groupby("peer").differing.sum()
    paper.numbers["worldsAgreement"] = "Of " + f"{answers:.0f} touching pairs, " + " and ".join(
        f"{count} differ in {worlds.PEERS[peer]}" for peer, count in differing.items()) + "."
    densest = table[table.room == table.room.min()]
    lines = [[str(r.objects), f"{r.step:g}, {r.degrees:g}", "none" if r.moving == 0 else percent(r.moving, 0), escape(r.best),
              f"{r.ms:.3f}" if r.ms < 10 else f"{r.ms:.1f}", f"{r.FCL:.1f}", f"{r.Bullet:.1f}"]
             for r in densest.itertuples()]
    paper.table("worlds", "rlrlrrr", ["bodies", "step: radii, degrees", "moving", "best of ours", "ms", "FCL", "Bullet"],
                lines)
    paper.plot("worlds.py", record)
    paper.have("worlds")


def main():
    records, out = sys.argv[1:3]
    paper = Paper(records, out)
    for part in (write_nine_bunnies, write_boxes, write_coherence, write_winners, write_workloads, write_worlds):
        part(paper)
    paper.write_numbers()


if __name__ == "__main__":
    main()
