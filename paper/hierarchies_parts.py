# SPDX-License-Identifier: BSD-3-Clause
"""The paper's parts on volumes, fits and hierarchies, beside other libraries."""

import numpy as np

import column
import cost_model
import records
import style
from sheet import duration, escape, listed, medians, percent, read_right, times

BASE_BUILD = "top-down-principal"  # along the principal axis, at the mean
VOLUMES = ["sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "rss", "shell"]


def write_tightness(paper):
    record = paper.record("tightness")
    if not record:
        return
    rows = records.read(record)
    mesh = max(dict.fromkeys(rows.mesh), key=lambda m: (m.startswith("bunny"), rows[rows.mesh == m].level.max()))
    rows = rows[rows.mesh == mesh].drop_duplicates(["volume", "fit", "level"])
    published = rows[rows.fit == "published"]
    root = published[published.level == 0].set_index("volume")["mean"]
    deepest = published[published.level == published.level.max()].set_index("volume")["mean"]
    paper.put_text(tightnessMesh=escape(mesh.replace(":", ", ")) + " polygons", tightnessRootBest=escape(root.idxmin()),
                   tightnessLeafBest=escape(deepest.idxmin()))
    two = "{:.2f}".format
    for name, value in (("tightnessRootLeast", root.min()), ("tightnessLeafLeast", deepest.min()),
                        ("tightnessRootSphere", root["sphere"]), ("tightnessLeafSphere", deepest["sphere"])):
        paper.put(name, value, two(value))
    if paper.out:
        draw_tightness(rows, paper.figures())
    paper.have("tightness")


def draw_tightness(rows, out):
    looks = style.looks(VOLUMES)
    figure, (axis,) = column.panels(1, 2.0)
    for volume in [v for v in VOLUMES if v in set(rows.volume)]:
        of = rows[(rows.volume == volume) & (rows.fit == "published")].sort_values("level")
        axis.plot(of.level, of["mean"], label=volume, **style.point_style(looks[volume]))
        tight = rows[(rows.volume == volume) & (rows.fit == "tight")].sort_values("level")
        if len(tight) and not np.allclose(tight["mean"], of["mean"][:len(tight)], rtol=1e-3):
            axis.plot(tight.level, tight["mean"], linewidth=0.7, **dict(style.point_style(looks[volume]), linestyle=":", markerfacecolor="white"))
    axis.set(xlabel="level of the tree (the root is 0)", ylabel="distance left out / diameter", ylim=(0, None))
    return column.finish(figure, [axis], out, "tightness")


def write_fits(paper):
    """Volume tests of each build and fit over those of the plainest, medians over sizes and queries."""
    record = paper.record("fits")
    if not record:
        return
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
        lines.append(line + ([f"{middle[volume, 'tight', b]:.2f}" for b in (BASE_BUILD, "bottom-up")]
                             + [f"{price[volume, 'tight']:.1f}"] if fitted else ["--", "--", "--"]))
    short = {"top-down-mean": "mean", "top-down-median": "med.", "top-down-middle": "mid.",
             "top-down-surface-area": "SAH", "bottom-up": "b.-up"}
    paper.table("fits", "l" + "r" * len(builds) + "rrr", [""] + [short.get(b, b) for b in builds] + ["princ.", "b.-up", "price"], lines,
                [r" & \multicolumn{%d}{c}{published fit} & \multicolumn{3}{c@{}}{tight fit} \\" % len(builds)])
    tight = [middle[v, "tight", "bottom-up"] for v in ("obb", "rss", "shell") if (v, "tight", "bottom-up") in middle]
    paper.put_range("fitsTight", tight, "{:.2f}".format)
    paper.put_range("fitsArea", [middle[v, "published", "top-down-surface-area"] for v in set(rows.volume)], "{:.2f}".format)
    paper.put_range("fitsBottomUp", [middle[v, "published", "bottom-up"] for v in set(rows.volume)], "{:.2f}".format)
    paper.have("fits")


def write_posing(paper):
    record = paper.record("posing")
    if not record:
        return
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
    paper.have("posing")


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
        lines.append([escape(volume)] + [f"{cost[c]:.1f}" for c in ("pose", "batched", "alone")]
                     + [f"{near.ratio.median():.2f}", f"{near.left.median():.0f}", percent(fits[-1], 0)])
    paper.table("cost-model", "lrrrrrr", ["", "$C_u$", "$C_v$", "alone", "pred.", "rest", "fit"], lines)
    paper.put_text(costTriangle=f"{triangle:.1f}")
    paper.put("costSphere", costs["sphere"]["batched"], f"{costs['sphere']['batched']:.1f}")
    paper.put_range("costPredicted", [ratio.quantile(0.05), ratio.quantile(0.95)], "{:.2f}".format)
    paper.put("costPredictedLow", ratio.quantile(0.25), f"{ratio.quantile(0.25):.2f}")
    paper.put("costPredictedHigh", ratio.quantile(0.75), f"{ratio.quantile(0.75):.2f}")
    paper.put_range("costFit", fits, lambda v: percent(v, 0))
    middle = busy.groupby("volume").left.median()
    paper.put_range("costRest", middle, "{:.0f}".format)
    paper.have("cost-model")


# Beside other libraries ----------------------------------------------------------------------------------------------


def fixed_for(query):
    """One variant for a query, whatever the motion and density."""
    return "rss recursive-both" if query == "distance" else "obb recursive-both"


def write_hierarchies(paper):
    record = paper.record("hierarchies")
    if not record:
        return
    rows = read_right(record)
    rows = rows[~rows.wrong_answer].assign(a_pair=rows.later_ns / rows.later_pairs, all_frames=rows.time_ns / rows.pairs)
    cell = ["work", "motion", "density"]
    middle = rows.groupby([*cell, "query", "polygons", "variant", "peer"], sort=False, as_index=False)[["a_pair", "all_frames"]].median()
    densities = list(dict.fromkeys(middle.density))
    table, gains = {}, []
    for key, group in middle.groupby([*cell, "query"], sort=False):
        ours, peers = group[group.peer == ""], group[group.peer != ""]
        best, first = ours.loc[ours.a_pair.idxmin()], peers.all_frames.min() / ours.all_frames.min()
        fixed = ours[ours.variant == fixed_for(key[3])].a_pair.min()
        gain = dict(work=key[0], motion=key[1], density=key[2], query=key[3], fixed=peers.a_pair.min() / fixed,
                    best=peers.a_pair.min() / best.a_pair, all_frames=first, variant=best.variant)
        gains.append(gain)
        table.setdefault(key[:2], {})[key[2]] = gain
    lines = [[escape(work), {"5 degrees": "fast", "a tenth of a degree": "slow"}.get(motion, escape(motion))]
             + [times(of[d][what]) for what in ("fixed", "best") for d in densities] for (work, motion), of in table.items()]
    paper.table("hierarchies", "ll" + "r" * 2 * len(densities), ["query, polygons", ""] + [d[:5] + "." if len(d) > 6 else d for d in densities] * 2, lines,
                [r" & & \multicolumn{%d}{c}{one configuration} & \multicolumn{%d}{c@{}}{best of %d} \\"
                 % (len(densities), len(densities), middle[middle.peer == ""].variant.nunique())])
    paper.put_range("librariesFixed", [g["fixed"] for g in gains])
    paper.put_range("librariesBest", [g["best"] for g in gains])
    largest = max((g for g in gains if g["query"] == "distance"), key=lambda g: g["best"])
    paper.put_times(firstLater=largest["best"], firstAll=largest["all_frames"])
    of_cell = rows[rows.peer == ""].groupby([*cell, "variant"]).time_ns
    apart = of_cell.max() / of_cell.min() - 1
    paper.put_percent(0, repetitionsApart=apart.median(), repetitionsTail=apart.quantile(0.95))
    slow = [g for g in gains if g["motion"] != gains[0]["motion"]]
    paper.shell_best = sum(g["variant"].startswith("shell") for g in gains)
    paper.put_text(slowCells=len(slow), slowMargins=sum(g["variant"].endswith("margins") for g in slow))
    paper.put_text(librariesRepetitions=rows.repetition.nunique(), librariesLosses=sum(g["fixed"] < 1 for g in gains),
                   librariesCells=len(gains),
                   shellBest=paper.shell_best)
    sparse = middle[(middle.density == "sparse") & (middle["query"] == "contacts")].groupby("work").a_pair.min()
    paper.put("librariesSparse", sparse.max(), duration(sparse.max()))
    paper.have("hierarchies")


def write_narrow_phase(paper):
    """Whatever methods the record has, by work and size."""
    record = paper.record("narrow-phase")
    if not record:
        return
    rows = read_right(record)
    name = "method" if "method" in rows else "variant"
    rows = rows[~rows.wrong_answer].assign(a_pair=rows.later_ns / rows.later_pairs)
    methods = list(dict.fromkeys(rows[name]))
    middle = rows.groupby(["work", "polygons", name], sort=False).a_pair.median()
    lines, ratios = [], []
    for work, polygons in dict.fromkeys(zip(rows.work, rows.polygons)):
        of = {m: middle.get((work, polygons, m), np.nan) for m in methods}
        lines.append([escape(work), str(polygons)] + ["--" if np.isnan(of[m]) else f"{of[m] / 1e3:.2f}" for m in methods])
        if "recommended" in of:
            peers = [v for m, v in of.items() if (rows[rows[name] == m].peer != "").any() and not np.isnan(v)]
            ratios += [min(peers) / of["recommended"]] if peers else []
    paper.table("narrow-phase", "lr" + "r" * len(methods), ["work", "polygons"] + [escape(m) for m in methods], lines)
    if ratios:
        paper.text("narrow-phase-text", f"The best peer takes {times(min(ratios))} to {times(max(ratios))} times as long as the "
                   f"recommended configuration, which is one for all rows and was fixed before. Ours is ahead in {sum(r > 1 for r in ratios)} of {len(ratios)} rows.")
    else:
        paper.text("narrow-phase-text", "")
    paper.have("narrow-phase")


def write_peers_cgal(paper):
    record = paper.record("peers-cgal")
    if not record:
        return
    rows = read_right(record)
    rows = rows.assign(a_pair=rows.time_ns / rows.pairs)
    middle = rows.groupby(["motion", "density", "variant"]).a_pair.median().unstack("variant")
    ours = [name for name in middle if "recursive" in name]
    if ours and "cgal" in middle:
        paper.put_range("cgalRigid", (middle["cgal"] / middle[ours[0]]).dropna())
        paper.put_text(cgalBeside=escape(ours[0]))
        paper.have("peers-cgal")


def write_tori(paper):
    record = paper.record("tori")
    if not record:
        return
    rows = read_right(record)
    rows = rows[~rows.wrong_answer].assign(a_frame=rows.time_ns / rows.frames)
    middle = rows.groupby(["query", "variant", "peer", "strategy"], sort=False, as_index=False)[["a_frame", "n_v", "frames"]].median()
    parts, lost, kept = [], [], 0
    for query, group in middle.groupby("query", sort=False):
        ours, peers = group[group.peer == ""], group[group.peer != ""]
        best, other = ours.loc[ours.a_frame.idxmin()], peers.loc[peers.a_frame.idxmin()]
        parts.append(f"{escape(query)} {duration(best.a_frame)} a frame ({escape(best.variant)}), {escape(other.variant)} {duration(other.a_frame)}")
        for volume in dict.fromkeys(v.split(" ")[0] for v in ours.variant):
            of = ours[ours.variant.str.startswith(volume + " ")]
            front = of[of.strategy.isin(["separation-list", "deferred", "margins"])].a_frame.min()
            kept += 1
            lost += [f"{escape(volume)} ({escape(query)})"] if front < of[of.strategy.str.startswith("recursive")].a_frame.min() else []
    paper.text("tori", "; ".join(parts) + f". Keeping a front loses there in {kept - len(lost)} of {kept} pairs of volume and query"
               + (f"; it wins with {listed(lost)}" if lost else "") + ".")
    paper.have("tori")


def microseconds(value):
    return f"{value:.0f}" if value >= 9.5 else f"{value:.1f}"


def write_closest_features(paper):
    record = paper.record("closest-features")
    if not record:
        return
    rows = records.read(record)
    rows = rows.assign(a_pair=rows.time_ns / rows.pairs)
    middle = medians(rows, ["mesh", "motion", "variant"], "a_pair")
    meshes = list(dict.fromkeys(middle.mesh))
    lines = []
    for variant in dict.fromkeys(middle.variant):
        line = [escape(variant)]
        for mesh in meshes:
            of = middle[(middle.variant == variant) & (middle.mesh == mesh)].a_pair / 1e3
            line.append(f"{microseconds(of.min())}--{microseconds(of.max())}" if len(of) else "--")
        lines.append(line)
    paper.table("closest-features", "l" + "r" * len(meshes), [r"$\mu$s a pair"] + [escape(m.replace(":", " ")) for m in meshes], lines)
    wrong = rows[(rows.peer != "") & (rows.differing > 0)].groupby("peer")[["differing", "pairs"]].sum()
    paper.text("closest-features-text", " ".join(
        f"Of {escape(peer)}'s distances {percent(of.differing / of.pairs)} are off by more than the tolerance of the comparison."
        for peer, of in wrong.iterrows() if of.differing / of.pairs > 5e-4))
    paper.have("closest-features")


