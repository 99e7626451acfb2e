# SPDX-License-Identifier: BSD-3-Clause
"""Small records for tests: rows cut from those in the repository, with names added that nobody has heard of."""

import shutil
import sys
import tomllib
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parents[2]
PLOTS = ROOT / "plots"
sys.path.insert(0, str(PLOTS))
from bvlab_plots import records  # noqa: E402

STRATEGIES = ["unheard-of-strategy", "deferred:4", "deferred:8"]
COUNTS = ["n_u", "n_v", "n_p", "front"]


def committed(name):
    """The folder of the latest record whose definition has this name."""
    def age(folder):
        return [int(part) if part.isdigit() else 0 for part in folder.name.replace("-", ".").split(".")]
    found = [d.parent for d in (ROOT / "experiments" / "record").glob("*/definition.toml")
             if tomllib.loads(d.read_text())["name"] == name]
    if not found:
        raise LookupError(f"no record of {name}")
    return max(found, key=age)


def cut(rows, keep):
    """Some values of some columns (the first ones where a number is given), and the first repetition."""
    for column, values in {**keep, "repetition": 1}.items():
        if column in rows:
            values = list(dict.fromkeys(rows[column]))[:values] if isinstance(values, int) else values
            rows = rows[rows[column].isin(values)]
    return rows


def stranger(column):
    return f"unheard-of-{column}"


def add(rows, column, like, name):
    """Rows like those of one name, under another."""
    copies = rows[rows[column] == like].copy()
    copies[column] = name
    # Labels that say the same: "recursive" of "sphere recursive".
    for label in {"variant"} & set(rows.columns) - {column}:
        copies[label] = copies[label].str.replace(like, name, regex=False)
    return pd.concat([rows, copies])


def add_peer(rows, like):
    """A peer counts nothing and has neither volume nor strategy."""
    if (rows.peer != "").any():
        return add(rows, "peer", next(peer for peer in rows.peer if peer), stranger("peer"))
    copies = rows[(rows[list(like)] == pd.Series(like)).all(axis=1)].copy()
    copies["peer"] = stranger("peer")
    for column in ("volume", "strategy", *COUNTS):
        if column in copies:
            copies[column] = "" if column not in COUNTS else float("nan")
    return pd.concat([rows, copies])


def small_record(name, folder, keep, strangers, peer_like=None, change=None):
    """A small copy of a record: `keep` says how many values of a column, `strangers` which column gets a new
    name beside which old one (or several new ones), `change(file, rows)` whatever else."""
    source, folder = committed(name), Path(folder)
    folder.mkdir(parents=True)
    for path in source.iterdir():
        if path.is_file() and ".csv" not in path.suffixes:
            shutil.copy(path, folder)
    for path in (Path(str(path).removesuffix(".gz")) for path in source.glob("*.csv*")):
        rows = cut(records.read_table(path), keep)
        for column, like in strangers.items():
            if column in rows:
                like, names = like if isinstance(like, tuple) else (like, [stranger(column)])
                for new in names:
                    rows = add(rows, column, like, new)
        if peer_like and "peer" in rows and "time_ns" in rows:
            rows = add_peer(rows, peer_like)
        rows = change(path.name, rows) if change else rows
        rows.to_csv(folder / path.name, index=False)
    return folder


def names_added(strangers, peer_like):
    """What must be seen in the figures of such a record."""
    names = [name for column, like in strangers.items()
             for name in (like[1] if isinstance(like, tuple) else [stranger(column)])]
    return names + ([stranger("peer")] if peer_like else [])


OWN = """
name = "own"
[[axis]]
name = "degrees"
values = [0.1, 1, 10]
[[axis]]
name = "volume"
values = ["sphere", "obb"]
[[axis]]
name = "strategy"
values = ["recursive", "deferred"]
"""


def own_record(folder, more="", change=None):
    """A record made here: 1000 ns a degree and a tenth more each repetition, boxes twice as long, deferred a quarter
    less, of ten pairs; `change` changes its rows, `more` stands behind its definition."""
    record = Path(folder) / "own-record"
    record.mkdir()
    (record / "definition.toml").write_text(OWN + more)
    cells = [(d, v, s, r) for r in range(3) for s in ("recursive", "deferred") for v in ("sphere", "obb")
             for d in (0.1, 1, 10)]
    rows = pd.DataFrame(cells, columns=["degrees", "volume", "strategy", "repetition"])
    rows.insert(3, "leaf_size", 1)
    rows.insert(4, "peer", "")
    factor = rows.volume.map({"sphere": 1, "obb": 2}) * rows.strategy.map({"recursive": 1, "deferred": 0.75})
    rows["time_ns"] = 1000 * rows.degrees * (1 + 0.1 * rows.repetition) * factor
    rows = rows.assign(pairs=10, differing=0, n_v=100 * factor)
    rows = change(rows) if change else rows
    rows.sample(frac=1, random_state=1).to_csv(record / "own.csv", index=False)
    return record
