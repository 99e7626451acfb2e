# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on volumes, builds and fits, posing and the cost function."""

import column
import cost_model
import numpy as np
import records
import style
from sheet import escape, part, percent, read_right


BASE_BUILD = "top-down-principal"  # along the principal axis, at the mean
VOLUMES = ["sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "rss", "shell"]


@part("tightness")
def write_tightness(paper, record):
    rows = records.read(record)
    mesh = max(dict.fromkeys(rows.mesh), key=lambda m: (m.startswith("bunny"), rows[rows.mesh == m].level.max()))
    rows = rows[rows.mesh == mesh].drop_duplicates(["volume", "fit", "level"])
    published = rows[rows.fit == "published"]
    root = published[published.level == 0].set_index("volume")["mean"]
    deepest = published[published.level == published.level.max()].set_index("volume")["mean"]
    paper.put_text(
        tightnessMesh=escape(mesh.replace(":", ", ")) + " polygons",
        tightnessRootBest=escape(root.idxmin()),
        tightnessLeafBest=escape(deepest.idxmin()),
    )
    two = "{:.2f}".format
    for name, value in (
        ("tightnessRootLeast", root.min()),
        ("tightnessLeafLeast", deepest.min()),
        ("tightnessRootSphere", root["sphere"]),
        ("tightnessLeafSphere", deepest["sphere"]),
    ):
        paper.put(name, value, two(value))
    if paper.out:
        draw_tightness(rows, paper.figures())


def draw_tightness(rows, out):
    looks = style.looks(VOLUMES)
    figure, (axis,) = column.panels(1, 2.0)
    for volume in [v for v in VOLUMES if v in set(rows.volume)]:
        of = rows[(rows.volume == volume) & (rows.fit == "published")].sort_values("level")
        axis.plot(of.level, of["mean"], label=volume, **style.point_style(looks[volume]))
        tight = rows[(rows.volume == volume) & (rows.fit == "tight")].sort_values("level")
        if len(tight) and not np.allclose(tight["mean"], of["mean"][: len(tight)], rtol=1e-3):
            axis.plot(
                tight.level,
                tight["mean"],
                linewidth=0.7,
                **dict(style.point_style(looks[volume]), linestyle=":", markerfacecolor="white"),
            )
    axis.set(xlabel="level of the tree (the root is 0)", ylabel="distance left out / diameter", ylim=(0, None))
    return column.finish(figure, [axis], out, "tightness")


@part("fits")
def write_fits(paper, record):
    """Volume tests of each build and fit over those of the plainest, medians over sizes and queries."""
    rows = read_right(record)
    cell = ["polygons", "query", "volume"]
    base = rows[(rows.build == BASE_BUILD) & (rows.fit == "published")].groupby(cell)[["n_v", "build_ns"]].first()
    rows = rows.join(base, on=cell, rsuffix="_base")
    rows["ratio"], rows["price"] = rows.n_v / rows.n_v_base, rows.build_ns / rows.build_ns_base
    middle = rows.groupby(["volume", "fit", "build"]).ratio.median()
    price = rows[rows.build == BASE_BUILD].groupby(["volume", "fit"]).price.median()
    builds = [b for b in dict.fromkeys(rows.build) if b != BASE_BUILD]
    lines = []
    for volume in [v for v in VOLUMES if v in set(rows.volume)]:
        line = [escape(volume)] + [f"{middle[volume, 'published', b]:.2f}" for b in builds]
        fitted = abs(middle[volume, "tight", BASE_BUILD] - 1) > 1e-6
        lines.append(
            line
            + (
                [f"{middle[volume, 'tight', b]:.2f}" for b in (BASE_BUILD, "bottom-up")]
                + [f"{price[volume, 'tight']:.1f}"]
                if fitted
                else ["--", "--", "--"]
            )
        )
    short = {
        "top-down-mean": "mean",
        "top-down-median": "med.",
        "top-down-middle": "mid.",
        "top-down-surface-area": "SAH",
        "bottom-up": "b.-up",
    }
    paper.table(
        "fits",
        "l" + "r" * len(builds) + "rrr",
        [""] + [short.get(b, b) for b in builds] + ["princ.", "b.-up", "price"],
        lines,
        [r" & \multicolumn{%d}{c}{published fit} & \multicolumn{3}{c@{}}{tight fit} \\" % len(builds)],
    )
    tight = [middle[v, "tight", "bottom-up"] for v in ("obb", "rss", "shell") if (v, "tight", "bottom-up") in middle]
    paper.put_range("fitsTight", tight, "{:.2f}".format)
    paper.put_range(
        "fitsArea", [middle[v, "published", "top-down-surface-area"] for v in set(rows.volume)], "{:.2f}".format
    )
    paper.put_range("fitsBottomUp", [middle[v, "published", "bottom-up"] for v in set(rows.volume)], "{:.2f}".format)


@part("posing")
def write_posing(paper, record):
    rows = records.read(record)
    keys = ["side", "k", "query"]
    asked = rows[rows["query"] != "roots"].groupby([*keys, "policy"])[["n_v", "time_ns"]].median().unstack("policy")
    saved = 1 - asked["n_v", "corners"] / asked["n_v", "realigned"]
    paper.put_range("posingSaved", saved, lambda v: percent(max(v, 0), 0))
    paper.put_range("posingTime", asked["time_ns", "corners"] / asked["time_ns", "realigned"])
    roots = rows[(rows["query"] == "roots") & (rows.side == 4)].groupby("policy")
    shares = (rows.dismissed / rows.pairs)[(rows["query"] == "roots") & (rows.side == 4)]
    for policy, group in roots:
        paper.put_range(f"posing{policy.title()}", shares[group.index], lambda v: percent(v, 0))


def write_cost_model(paper):
    record = paper.record("cost-model")
    if not record or not (record / "unit-costs.json").is_file():
        return
    rows, costs, triangle = cost_model.read(record)
    ratio = rows.predicted_ns / rows.time_ns
    rows["ratio"], rows["left"] = ratio, (rows.time_ns - rows.predicted_ns) / rows.n_v
    busy = rows[rows.density != "sparse"]
    lines, fits = [], []
    for volume in [v for v in VOLUMES if v in set(rows.volume)]:
        near = busy[busy.volume == volume]
        terms = near[["n_u", "n_v", "n_p"]].to_numpy() / near.time_ns.to_numpy()[:, None]
        fitted, *_ = np.linalg.lstsq(terms, np.ones(len(near)), rcond=None)
        fits.append(np.median(np.abs(terms @ fitted - 1)))
        cost = costs[volume]
        lines.append(
            [escape(volume)]
            + [f"{cost[c]:.1f}" for c in ("pose", "batched", "alone")]
            + [f"{near.ratio.median():.2f}", f"{near.left.median():.0f}", percent(fits[-1], 0)]
        )
    paper.table("cost-model", "lrrrrrr", ["", "$C_u$", "$C_v$", "alone", "pred.", "rest", "fit"], lines)
    paper.put("costTriangle", triangle, f"{triangle:.1f}")
    paper.put("costSphere", costs["sphere"]["batched"], f"{costs['sphere']['batched']:.1f}")
    paper.put_range("costPredicted", [ratio.quantile(0.05), ratio.quantile(0.95)], "{:.2f}".format)
    paper.put("costPredictedLow", ratio.quantile(0.25), f"{ratio.quantile(0.25):.2f}")
    paper.put("costPredictedHigh", ratio.quantile(0.75), f"{ratio.quantile(0.75):.2f}")
    paper.put_range("costFit", fits, lambda v: percent(v, 0))
    middle = busy.groupby("volume").left.median()
    paper.put_range("costRest", middle, "{:.0f}".format)
    paper.have("cost-model")
