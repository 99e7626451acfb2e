# SPDX-License-Identifier: BSD-3-Clause
"""The paper's part on nine bunnies, under every reading of the talk."""

import nine_bunnies
from quotes import seeds
from sheet import escape, listed, medians, part, read_right


PART_LABEL = {"one body": "one", "all bodies": "all", "one freedom": "one", "all freedoms": "all"}


def write_nine_bunnies(paper):
    published = nine_bunnies.PUBLISHED.mean()
    for name, variant in (("publishedList", "separation-list"), ("publishedDeferred", "deferred")):
        paper.put(
            name, published["recursive"] / published[variant], f"{published['recursive'] / published[variant]:.2f}"
        )
    record = paper.record("nine-bunnies")
    if not record:
        return
    runs = nine_bunnies.read(record)
    (reading, density), time = nine_bunnies.nearest_reading(runs)
    tests = nine_bunnies.speedups(runs, "n_v").groupby(level=["reading", "density"], sort=False).mean()
    paper.put_text(
        nearestReading=escape(reading),
        nearestDensity=escape(density),
        bunniesRuns=runs.seed.nunique(),
        bunniesFrames=f"{runs.frames.max():.0f}",
    )
    nearest = time.loc[(reading, density)]
    two = "{:.2f}".format
    paper.put("nearestList", nearest["separation-list"], two(nearest["separation-list"]))
    paper.put("nearestDeferred", nearest["deferred"], two(nearest["deferred"]))
    paper.put_range("tests", [tests[c].min() for c in tests] + [tests[c].max() for c in tests], two)
    free = tests[["rejecting" not in r for r, _ in tests.index]]
    one, every = (free[[r.startswith(who) for r, _ in free.index]] for who in ("one body", "all bodies"))
    for who, of in (("oneBody", one), ("allBodies", every)):
        paper.put_range(f"{who}List", of["separation-list"], two)
        paper.put_range(f"{who}Deferred", of["deferred"], two)
    reached = [
        key
        for key, of in time.iterrows()
        if of["separation-list"] >= paper.values["publishedList"]
        and of["deferred"] >= paper.values["publishedDeferred"]
    ]
    paper.put_text(
        bunniesInTime=f"{len(reached)} of {len(time)} readings reach both" if reached else "no reading reaches both"
    )
    rows = []
    for (r, d), saved in tests.iterrows():
        parts = r.split(", ")
        line = [PART_LABEL.get(part, escape(part)) for part in parts[:2]] + [
            "yes" if len(parts) > 2 else "no",
            escape(d),
        ]
        of_time = time.loc[(r, d)]
        rows.append(line + [two(v) for name in ("separation-list", "deferred") for v in (saved[name], of_time[name])])
    paper.table(
        "nine-bunnies",
        "llllrrrr",
        ["bodies", "freed.", "rej.", "density", "$N_v$", "time", "$N_v$", "time"],
        rows,
        [
            r"\multicolumn{4}{@{}l}{what moves in a step} & \multicolumn{2}{c}{list} "
            r"& \multicolumn{2}{c@{}}{deferred} \\"
        ],
    )
    paper.have("nine-bunnies")


@part("talk")
def write_talk(paper, record):
    """The talk's tree, as near as it describes it, beside Quinlan's division: what each reading saves."""
    rows = read_right(record)
    middle = medians(rows, ["build", "reading", "density", "seed", "strategy"], ["n_v", "time_ns"])
    two = "{:.2f}".format
    saved = {}
    for what in ("n_v", "time_ns"):
        wide = middle.pivot_table(
            index=["build", "reading", "density", "seed"], columns="strategy", values=what, sort=False
        )
        saved[what] = wide[["recursive"]].to_numpy() / wide[nine_bunnies.LISTS]
    of = {what: table.groupby(level=["build", "reading"], sort=False).mean() for what, table in saved.items()}
    builds = list(dict.fromkeys(rows.build))
    lines = []
    for reading in dict.fromkeys(rows.reading):
        parts = reading.split(", ")
        line = [PART_LABEL.get(part, escape(part)) for part in parts[:2]] + ["yes" if len(parts) > 2 else "no"]
        lines.append(
            line
            + [
                two(of[what].loc[(build, reading), name])
                for build in builds
                for name in nine_bunnies.LISTS
                for what in ("n_v", "time_ns")
            ]
        )
    heads = (
        " & ".join([r"\multicolumn{3}{@{}l}{}"] + [rf"\multicolumn{{4}}{{c}}{{{escape(b)}}}" for b in builds]) + r" \\"
    )
    kinds = (
        " & ".join(
            [r"\multicolumn{3}{@{}l}{moves}"]
            + [r"\multicolumn{2}{c}{list} & \multicolumn{2}{c}{deferred}"] * len(builds)
        )
        + r" \\"
    )
    paper.table(
        "talk",
        "lll" + "r" * 4 * len(builds),
        ["bodies", "freed.", "rej."] + ["$N_v$", "time"] * 2 * len(builds),
        lines,
        [heads, kinds],
    )
    paper.put_text(talkSeeds=rows.seed.nunique(), talkBuilds=listed(f"\\emph{{{escape(b)}}}" for b in builds))
    for what, name in (("n_v", "Tests"), ("time_ns", "Time")):
        paper.put_range(f"talk{name}List", of[what]["separation-list"], two)
        paper.put_range(f"talk{name}Deferred", of[what]["deferred"], two)
    paper.text("talk-prices", prices_text(rows, paper.values))
    paper.put_text(talkInTime=reach_text(of["time_ns"], paper.values))


@part("talk-scalar")
def write_talk_scalar(paper, record):
    """The talk in scalar code: where one body moves, and what a pair of triangles costs in tests of spheres."""
    found = seeds.talk_scalar(record)
    for program, prefix in (("Plain", "plain_"), ("Optimised", "")):
        for name in ("list", "deferred"):
            interval = found[prefix + name]
            paper.put_range(f"scalar{program}{name.title()}", [interval.least, interval.most], "{:.2f}".format)
    paper.put_text(scalarPlainPrice=f"{found['plain']:.0f}", scalarOptimisedPrice=f"{found['optimised']:.0f}")


def reach_text(speedups, published):
    """In how many lines both lists are as fast as was published."""
    both = (speedups["separation-list"] >= published["publishedList"]) & (
        speedups["deferred"] >= published["publishedDeferred"]
    )
    return f"{both.sum()} of {len(both)} pairs of tree and reading reach both published ratios"


def prices_text(rows, published):
    """Speedups by cost where a pair of triangles costs as much as so many tests of volumes, as in scalar code."""
    parts = []
    for price in (2, 10):
        ratio = nine_bunnies.saved_by_cost(rows, price).groupby(level=["build", "reading"]).mean()
        ranges = " and ".join(f"{ratio[name].min():.2f} to {ratio[name].max():.2f}" for name in nine_bunnies.LISTS)
        parts.append(f"at {price} tests {ranges}, so that {reach_text(ratio, published)}")
    return "; ".join(parts)
