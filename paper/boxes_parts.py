# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on boxes."""

import boxes_fast
import column
import records
import style
from quotes import seeds
from sheet import escape, listed, part, percent, thousands, times
from words import number

# The six that were published.
PUBLISHED_METHODS = ["hybrid", "hash", "sweep1", "sweep2", "sweep3", "sweep4"]
MOVES = {"drift": "drift each their own way", "rigid": "move together", "breathe": "shrink and grow"}
FAST = ["boxes-fast", "boxes-triangles", "boxes-fast-large", "boxes-million"]


def write_boxes(paper):
    """The three published figures, at the largest sets."""
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
            columns.append((escape(set_name), most))
            for row in group[group.boxes == most].itertuples():
                cells[row.method, len(columns) - 1, row.coherent] = row.frame_ns / 1e6
                methods.append(row.method)
    lines = []
    for method in dict.fromkeys(methods):
        line = [escape(method)]
        for k in range(len(columns)):
            off, on = cells.get((method, k, "off")), cells.get((method, k, "on"))
            keeps = on is not None and method.startswith(("sweep", "blocks"))  # the others are what they are either way
            line.append(("--" if off is None else milliseconds(off)) + (f" ({milliseconds(on)})" if keeps else ""))
        lines.append(line)
    paper.table("boxes", "l" + "r" * len(columns), ["ms a frame"] + [f"{s}, {thousands(n)}" for s, n in columns], lines)
    paper.text("boxes-text", published_text(columns, cells))
    hybrid = [
        min((cells[m, k, "off"], m) for m in PUBLISHED_METHODS if (m, k, "off") in cells)[1] == "hybrid"
        for k in range(len(columns))
    ]
    paper.put_text(hybridBest=sum(hybrid), hybridSets=len(hybrid))
    saved = [
        1 - cells[m, k, "on"] / cells[m, k, "off"]
        for m in PUBLISHED_METHODS
        if m.startswith("sweep")
        for k in range(len(columns))
        if (m, k, "on") in cells and (m, k, "off") in cells
    ]
    if saved:
        paper.put_range("coherenceSaves", saved, lambda v: percent(v, 0))
    paper.have("boxes")


@part("boxes-motions")
def write_boxes_motions(paper, record):
    """What coherence saves each sweep under each of the second text's motions, at the largest sets."""
    rows = records.read(record)
    records.wrong_answers(rows)
    rows = rows[(rows.peer == "") & (rows.frame_ns > 0) & rows.method.str.startswith("sweep")]
    rows = rows[rows.boxes == rows.groupby("set").boxes.transform("max")]
    middle = rows.groupby(["motion", "set", "method", "coherent"], sort=False).frame_ns.median().unstack("coherent")
    saved = (1 - middle["on"] / middle["off"]).dropna()
    paper.text(
        "boxes-motions",
        listed(
            f"{percent(of.min(), 0)} to {percent(of.max(), 0)} where boxes {MOVES.get(motion, escape(motion))}"
            for motion, of in saved.groupby(level="motion", sort=False)
        ),
    )


@part("boxes-sorts")
def write_boxes_sorts(paper, record):
    """The same after a sort by comparison, in code without vector registers."""
    left = seeds.left_by_coherence(record)
    for name, program in (("Plain", "unoptimised"), ("Optimised", "optimised")):
        saved = 1 - left.loc[program].loc["comparison"]
        paper.put_range(f"sorted{name}", saved, lambda v: percent(v, 0))
        paper.put_percent(0, **{f"sorted{name}Middle": saved.median()})


def milliseconds(value):
    return f"{value:.2f}" if value < 1 else f"{value:.1f}" if value < 100 else f"{value:.0f}"


def published_text(columns, cells):
    names = [f"{s}, {thousands(n)}" for s, n in columns]
    best = {
        k: min((v, m) for (m, c, o), v in cells.items() if c == k and o == "off" and m in PUBLISHED_METHODS)
        for k in range(len(columns))
    }
    kept = {
        k: min(
            ((v, m) for (m, c, o), v in cells.items() if c == k and o == "on" and m.startswith("sweep")), default=None
        )
        for k in range(len(columns))
    }
    text = (
        "Of the published methods the fastest from scratch is "
        + listed(f"{escape(m)} ({names[k]})" for k, (v, m) in best.items())
        + "."
    )
    won = [
        f"{escape(kept[k][1])} on {names[k]}, in {100 * kept[k][0] / best[k][0]:.0f}\\,\\% of that time"
        for k in kept
        if kept[k] and kept[k][0] < best[k][0]
    ]
    # Only the sweeps make use of coherence.
    return text + (
        " With coherence it is beaten by " + listed(won) + "."
        if won
        else " With coherence no sweep is faster than that."
    )


def write_boxes_fast(paper):
    """blocks beside the best peer, cold beside cold and warm beside warm."""
    found = [record for record in map(paper.record, FAST) if record]
    if not found:
        return
    rows = boxes_fast.read(found)
    rows = rows[(rows.peer != "") | (rows.method == "blocks")]
    keys = ["set", "count", "motion", "peer", "method", "coherent"]
    middle = rows.groupby(keys, sort=False, as_index=False).agg(
        first=("first_ns", "median"), later=("frame_ns", "median"), pairs=("overlaps", "median")
    )
    names = list(dict.fromkeys(rows[rows.peer != ""].method))
    lines, found = [], {}
    for (count, name), group in middle.groupby(["count", "set"], sort=False):
        drift = group[group.motion == "drift"]
        cells = {"cold": cold(drift), "warm": warm(drift)}
        cells.update({motion: kept(group[group.motion == motion]) for motion in ("drift", "still", "teleport")})
        for what, value in cells.items():
            if value:
                found.setdefault(what, []).append(value)
        pairs = drift.pairs.iloc[0] if len(drift) else 0
        lines.append(
            [escape(name), thousands(count), thousands(pairs), *(times(v) if v else "--" for v in cells.values())]
        )
    paper.table("boxes-fast", "lrrrrrrr", ["set", "boxes", "pairs", "cold", "warm", r"drift", "still", "telep."], lines)
    for what, values in found.items():
        paper.put_range(f"boxes{what.title()}", values)
    paper.put_text(boxesPeers=listed(map(escape, names)))
    paper.numbers["boxesStillCaveat"] = (
        ""
        if any("dbvt" in n for n in names)
        else (
            "Bullet's dynamic tree, the best peer where nothing moves, is not among them, so that the column says too "
            "much: see below."
        )
    )
    paper.have("boxes-fast")


def cold(rows):
    """First frames: of the best peer over ours."""
    ours = rows[(rows.peer == "") & (rows.coherent == "off")]["first"]
    theirs = rows[rows.peer != ""]["first"]
    return theirs.min() / ours.min() if len(ours) and len(theirs) else None


def warm(rows):
    """From scratch in every frame: only of what keeps nothing."""
    ours = rows[(rows.peer == "") & (rows.coherent == "off")].later
    theirs = rows[rows.method.str.startswith("cgal")].later
    return theirs.min() / ours.min() if len(ours) and len(theirs) else None


def kept(rows):
    """Frames after the first, each side keeping what it can."""
    ours = rows[(rows.peer == "") & (rows.coherent == "on")].later
    theirs = rows[rows.peer != ""].later
    return theirs.min() / ours.min() if len(ours) and len(theirs) else None


@part("boxes-peers")
def write_boxes_peers(paper, record):
    """Every method and peer: who misses pairs, and who is best where nothing moves."""
    rows = records.read(record)
    wrong = records.wrong_answers(rows)
    paper.put_text(
        boxesMissing=listed(map(escape, sorted(set(rows[wrong].method)))),
        boxesPeersCount=thousands(rows["count"].max()),
    )
    still = rows[~wrong & (rows.motion == "still")]
    middle = still.groupby(["set", "peer", "method", "coherent"], as_index=False).frame_ns.median()
    ratios, best = [], []
    for _, group in middle.groupby("set", sort=False):
        peers = group[group.peer != ""]
        peer = peers.loc[peers.frame_ns.idxmin()]
        ours = group[(group.method == "blocks") & (group.coherent == "on")].frame_ns.min()
        ratios.append(peer.frame_ns / ours)
        best.append(peer.method)
    paper.put_range("stillBest", ratios)
    paper.put_text(
        stillBestPeers=listed(f"{escape(m)} ({best.count(m)} of {len(best)} sets)" for m in dict.fromkeys(best))
    )


@part("boxes-displacement")
def write_boxes_displacement(paper, record):
    rows = records.read(record)
    write_beaten(paper, rows)
    rows = rows[rows.method == "blocks"]
    middle = rows.groupby(["set", "displacement", "coherent"]).frame_ns.median().unstack("coherent")
    ratio = (middle["on"] / middle["off"]).unstack("displacement")
    far = [ratio[c].max() for c in ratio if c >= 0.3]
    paper.put_range("startingOver", [ratio[c].min() for c in ratio if c >= 0.3] + far, "{:.2f}".format)
    worst = ratio.stack().idxmax()
    paper.put_text(startingOverWorst=f"{escape(worst[0])} at a displacement of {100 * worst[1]:.0f}\\,\\%")
    paper.put("startingOverMost", ratio.max().max(), f"{ratio.max().max():.2f}")
    if paper.out:
        draw_displacement(ratio, paper.figures())


def write_beaten(paper, rows):
    """Where another method is faster than blocks by more than a tenth."""
    best = rows[rows.differing == 0].groupby(["set", "displacement", "method"]).frame_ns.min().unstack("method")
    others = best.drop(columns="blocks")
    beaten = [
        f"{escape(others.loc[cell].idxmin())} on {escape(cell[0])} at {number(cell[1])} "
        f"({times(best.blocks[cell] / others.loc[cell].min())})"
        for cell in best.index
        if others.loc[cell].min() < 0.9 * best.blocks[cell]
    ]
    paper.text(
        "boxes-beaten",
        f"It is beaten by more than a tenth in {len(beaten)} of {len(best)} cells: "
        + listed(beaten)
        + ", where the number is how many times as fast that is."
        if beaten
        else f"No method or peer beats it by a tenth in any of the {len(best)} cells.",
    )


def draw_displacement(ratio, out):
    figure, (axis,) = column.panels(1, 1.6)
    column.lines(axis, ratio.T, style.looks(ratio.index))
    axis.axhline(1, color="black", linewidth=0.6)
    axis.set(xlabel="displacement a frame, of a box's size", ylabel="time kept / from scratch")
    column.log_axis(axis, ratio.to_numpy().ravel())
    return column.finish(figure, [axis], out, "boxes-displacement")
