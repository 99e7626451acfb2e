# SPDX-License-Identifier: BSD-3-Clause
"""The large sweep: which strategy and volume win where, and by how much."""

from bvlab_plots import records
from quoting import Interval, claim, quotes

MOTION = ["step", "degrees", "persistence"]
TIE = 1.1  # times this near to each other are the same


def fastest(record):
    """One row a setting: the fastest volume and strategy, what recursive spheres take over it, and `adaptive`."""
    rows = records.read(record)
    records.wrong_answers(rows)
    setting = [c for c in rows.attrs["settings"] if c not in ("volume", "strategy", "variant")]
    rows = rows.groupby([*setting, "volume", "strategy"], as_index=False).time_ns.median()
    best = rows.loc[rows.groupby(setting).time_ns.idxmin()].set_index(setting)
    base = rows[(rows.volume == "sphere") & (rows.strategy == "recursive")].set_index(setting).time_ns
    adaptive = rows[rows.strategy == "adaptive"].groupby(setting).time_ns.min()
    return best.assign(gain=base / best.time_ns, adaptive=adaptive / best.time_ns).reset_index()


def most_often(values):
    """The two that are there most often, and how often: "margins 61 %, adaptive 30 %"."""
    shares = values.value_counts(normalize=True).head(2)
    return ", ".join(f"{name} {100 * share:.0f} %" for name, share in shares.items())


@quotes("sweep")
def sweep_table(record):
    best = fastest(record)
    return {"rows": [[f"{step:g}, {degrees:g}", "persisting" if persistence else "random", most_often(group.strategy),
                      most_often(group.volume), f"{group.gain.median():.1f}", f"{group.adaptive.median():.2f}"]
                     for (step, degrees, persistence), group in best.groupby(MOTION)]}


@quotes("sweep")
def sweep_adaptive(record):
    best = fastest(record)
    wins = (best.strategy == "adaptive").groupby([best[name] for name in MOTION]).mean()
    claim(best.seed.nunique() == 2 and len(best) == len(best[["seed", *MOTION, "mesh", "polygons", "side", "freedoms"]].drop_duplicates()), "a setting has all volumes, and one seed")
    boxes = (best.volume == "obb").groupby(best.mesh).mean()
    claim((boxes > 0.5).all(), "oriented boxes win most settings of every mesh")
    claim(all(group.strategy.value_counts().idxmax() == "adaptive" for _, group in best.groupby(MOTION)),
          "adaptive wins more settings than any other strategy, for every kind of motion")
    return {"settings": len(best), "near": 100 * (best.adaptive < TIE).mean(), "wins": Interval(100 * wins), "boxes": Interval(100 * boxes),
            "icosphere": 100 * boxes["icosphere"], "half": (wins <= 0.5).sum(), "kinds": len(wins)}
