# SPDX-License-Identifier: BSD-3-Clause
"""Unit costs C_u, C_v, C_p of T = N_u C_u + N_v C_v + N_p C_p, in ns: measured, or fitted to a record."""

import json
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from bvlab_plots.refused import Refused
from bvlab_plots.words import span

COUNTS = ["n_u", "n_v", "n_p"]
LEAST = 6  # rows, of a fit of three numbers


def measured(path):
    """Of unit-costs.json (bench_unit_costs --benchmark_format=json). Nanoseconds per volume: to place a body, pose a
    volume, test a pair; and to test triangles."""
    costs, triangles = {}, {}
    for entry in json.loads(Path(path).read_text())["benchmarks"]:
        what, name, *rest = entry["name"].split("/")
        ns = entry["ns"]
        if what == "triangles":
            triangles[(name, rest[0])] = ns
        elif what == "test":
            costs.setdefault(name, {}).setdefault(("test", int(rest[0])), []).append(ns)
        elif what in ("place", "pose"):
            costs.setdefault(name, {})[what] = ns
    for of_volume in costs.values():
        widest = max(key[1] for key in of_volume if isinstance(key, tuple))
        of_volume["batched"] = np.mean(of_volume[("test", widest)])
        of_volume["alone"] = np.mean(of_volume[("test", 1)])
    return costs, triangles[("exact", "apart")]


def fitted(rows):
    """{volume: (C_u, C_v, C_p)}, and the share of the times' variance that they leave: the unit costs, none below zero,
    that least squares of relative errors find in the rows of each volume."""
    found, left, whole = {}, 0.0, 0.0
    for volume, part in rows.groupby("volume", sort=False):
        known = part[part[[*COUNTS, "time_ns"]].notna().all(axis=1) & (part.time_ns > 0)]
        if len(known) < LEAST:
            raise Refused(f"unit costs of {volume}: {len(known)} rows are too few to fit three, {LEAST} are needed; or put "
                          "unit-costs.json of bench_unit_costs beside the record")
        relative = known[COUNTS].to_numpy(float) / known.time_ns.to_numpy(float)[:, None]
        found[volume], _ = nnls(relative, np.ones(len(known)))
        if found[volume][1] <= 0 and known.n_v.any():
            raise Refused(f"unit costs of {volume}: by the fit volume tests would be free (C_v = 0): put unit-costs.json of "
                          "bench_unit_costs beside the record")
        said = known[COUNTS].to_numpy(float) @ found[volume]
        left += float(((known.time_ns - said) ** 2).sum())
        whole += float(((known.time_ns - known.time_ns.mean()) ** 2).sum())
    return found, 1 - left / whole if whole else 1.0


def of_record(folder, rows):
    """{volume: (C_u, C_v, C_p)} for each volume of the rows, and where they are from, in words."""
    path = Path(folder) / "unit-costs.json" if folder else None
    if path and path.is_file():
        costs, triangle = measured(path)
        if missing := [volume for volume in dict.fromkeys(rows.volume) if volume not in costs]:
            raise Refused(f"{path}: has no unit costs of {', '.join(missing)}")
        return {v: (costs[v]["pose"], costs[v]["batched"], triangle) for v in dict.fromkeys(rows.volume)}, \
            "unit costs measured by bench_unit_costs"
    found, share = fitted(rows)
    each = ((name, [costs[i] for costs in found.values()]) for i, name in enumerate(("$C_u$", "$C_v$", "$C_p$")))
    ranges = ", ".join(f"{name} {span(f'{min(costs):.3g}', f'{max(costs):.3g}')}" for name, costs in each)
    return found, f"unit costs fitted to the rows of this record, each volume by itself ({ranges} ns; R² {share:.2f})"
