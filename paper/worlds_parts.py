# SPDX-License-Identifier: BSD-3-Clause
"""The paper's part on whole scenes, beside other pipelines."""

from sheet import count, escape, listed, percent, read_right, times

# What tells one whole scene from another; the names of other pipelines; and one variant for all scenes.
SCENE = ["objects", "room", "step", "degrees", "moving"]
PIPELINES = {"fcl-world": "FCL", "fcl-world-moved": "FCL, moved", "bullet-world": "Bullet"}
FIXED = ["recommended", "obb deferred", "sphere deferred"]  # the first that the record has


def worlds_table(rows, one):
    """For each scene the best of ours and `one` variant, milliseconds a frame, and how many times as long as the best
    each peer takes."""
    rows = rows.assign(ms=rows.time_ns / 1e6 / (rows.frames - 1))  # of all frames but the first
    middle = rows.groupby(SCENE + ["peer", "variant"], sort=False, as_index=False).ms.median()
    for scene, group in middle.groupby(SCENE, sort=False):
        ours = group[group.peer == ""]
        best = ours.loc[ours.ms.idxmin()]
        theirs = group[group.peer != ""].set_index("peer").ms
        yield dict(zip(SCENE, scene)), best, ours[ours.variant == one].ms.min(), theirs


def write_worlds(paper):
    record = paper.record("worlds")
    paper.put_text(worldsMostObjects="0")
    if not record:
        return
    rows = read_right(record)
    paper.put_text(worldsMostObjects=f"{rows.objects.max():,}".replace(",", r"\,"))
    answers = rows[rows.peer == ""].groupby(SCENE).touching.first().sum()
    differing = rows[rows.peer != ""].groupby(["peer", *SCENE]).differing.first().groupby("peer").sum()
    peers = list(dict.fromkeys(rows[rows.peer != ""].peer))
    paper.put_text(
        worldsAgreement=f"Of {count(answers)} touching pairs, "
        + listed(f"{count(differing[peer])} differ in {PIPELINES.get(peer, peer)}" for peer in peers)
        + "."
    )
    one = next((name for name in FIXED if (rows.variant == name).any()), rows[rows.peer == ""].variant.iloc[0])
    paper.put_text(worldsFixed=escape(one))
    lines, gains = [], {peer: [] for peer in peers}
    # A frame in which nothing moves is an empty call.
    for scene, best, fixed, theirs in worlds_table(rows[(rows.room == rows.room.min()) & (rows.moving > 0)], one):
        ms = lambda v: f"{v:.3f}" if v < 1 else f"{v:.2f}" if v < 10 else f"{v:.0f}"
        lines.append(
            [
                str(scene["objects"]),
                f"{scene['degrees']:g}$^\\circ$",
                percent(scene["moving"], 0),
                escape(best.variant),
                ms(best.ms),
                ms(fixed),
                *(f"{times(theirs[p] / best.ms)}" if p in theirs else "--" for p in peers),
            ]
        )
        for peer in set(peers) & set(theirs.index):
            gains[peer].append(theirs[peer] / fixed)
    for peer in peers:
        paper.put_range(f"worlds{PIPELINES.get(peer, peer).title().replace(', ', '')}", gains[peer])
    paper.table(
        "worlds",
        "rrrlrr" + "r" * len(peers),
        ["bodies", "", "moving", "best of ours", "ms", "fixed", *(PIPELINES.get(p, p) for p in peers)],
        lines,
    )
    paper.have("worlds")
