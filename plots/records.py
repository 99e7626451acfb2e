# SPDX-License-Identifier: BSD-3-Clause
"""Records as pandas frames, and what their variants are called."""

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd


def table(path):
    """The rows of one table: blanks are empty names, and NaN in columns of numbers."""
    rows = pd.read_csv(path, keep_default_na=False)
    for column in rows.columns[rows.dtypes == object]:
        text = rows[column]
        numbers = pd.to_numeric(text, errors="coerce")
        if (text != "").any() and numbers[text != ""].notna().all():
            rows[column] = numbers
    return rows


def definition(record):
    """The definition that stands in a record, as a dictionary."""
    return tomllib.loads((Path(record) / "definition.toml").read_text())


def box_peers(record):
    """The methods of a record of boxes that are other libraries'."""
    peers = definition(record).get("parameters", {}).get("peers", [])
    return [peers] if isinstance(peers, str) else list(peers)


def variant_names(rows):
    """For each row "volume strategy", the part alone of which there is more than one, or the peer."""
    peer = rows.peer if "peer" in rows else pd.Series("", rows.index)
    ours = rows[peer == ""]
    parts = [rows[part] for part in ("volume", "strategy") if ours[part].nunique() > 1]
    named = parts[0] if len(parts) == 1 else rows.volume + " " + rows.strategy
    return pd.Series(np.where(peer == "", named, peer), rows.index)


def say_left_out(names, why):
    """Nothing is left out in silence."""
    names = sorted(set(map(str, names)))
    if names:
        print(f"left out, {why}: {', '.join(names)}")
