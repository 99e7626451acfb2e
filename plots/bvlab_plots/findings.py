# SPDX-License-Identifier: BSD-3-Clause
"""What a record says, in a sentence that is computed from its rows, so that it cannot get out of date."""

from bvlab_plots import figures, records
from bvlab_plots.expression import Expression
from bvlab_plots.refused import Refused

MANY = 1.005  # ratios nearer to 1 than this are called the same


def sentence_of(rows):
    """The variant of ours that is best in most settings, by the record's first measure, and how it compares
    with the best of the others. Nothing for a record of one variant."""
    try:
        measure = Expression(figures.default_value(rows), rows)
        frame = rows.assign(measured=measure.of(rows))
    except Refused:
        return ""
    if measure.text.startswith("false"):
        who = frame[[c for c in ("variant", "precision") if c in frame]].astype(str).agg(" ".join, axis=1).str.strip()
        return text_of_counts(frame.measured.groupby(who).sum(), measure.label())
    wrong = records.wrong_of(frame)
    frame = frame[frame.measured.notna() & (frame.measured > 0) & ~wrong]
    parts = {"variant", "volume", "strategy", "method", "test", "policy", "peer", "source", "coherent", "changes",
             "precision", "threads", "seed", "repetition"}
    # What a peer's row leaves blank is a matter of the variant too.
    cell = [c for c in rows.attrs["settings"] if c not in parts and not blank_for_peers(frame, c)]
    if frame.variant.nunique() < 2:
        return ""
    frame = frame.assign(cell=frame[cell].astype(str).agg(" ".join, axis=1) if cell else "")
    table = frame.pivot_table(index="cell", columns="variant", values="measured", aggfunc="median")
    return text_of(table, set(frame[frame.peer != ""].variant), measure.label())


def blank_for_peers(frame, column):
    peers = frame[frame.peer != ""]
    return not peers.empty and peers[column].astype(str).isin(["", "nan"]).all()


def text_of_counts(counts, measure):
    none = counts[counts == 0]
    return f"{len(none)} of {len(counts)} variants have no {measure}; {counts.idxmax()} has the most, {counts.max():,.0f}."


def text_of(table, peers, measure):
    ours = table[[name for name in table if name not in peers]]
    if ours.empty or ours.isna().all(axis=None):
        return ""
    best = ours.dropna(how="all").idxmin(axis=1).value_counts()
    cells = int(best.sum())
    first = f"{best.index[0]} has the least {measure}"
    if cells > 1:
        first += f" in {best.iloc[0]} of {cells} settings" if best.iloc[0] < cells else f" in all {cells} settings"
    if len(best) > 1:
        first += f", {best.index[1]} in {best.iloc[1]}"
    theirs = table[[name for name in table if name in peers]]
    both = table[ours.notna().any(axis=1) & theirs.notna().any(axis=1)]
    if both.empty:
        return first + "."
    ratios = both[theirs.columns].min(axis=1) / both[ours.columns].min(axis=1)
    return f"{first}; {beside(ratios)}."


def beside(ratios):
    middle, least, most = ratios.median(), ratios.min(), ratios.max()
    if 1 / MANY < middle < MANY:
        return "the best peer's is on a par with our best"
    slower = f"the best peer's is {times(middle)} times our best"
    return slower if len(ratios) == 1 else f"{slower} (median over settings; {times(least)} to {times(most)})"


def times(ratio):
    return f"{ratio:,.0f}" if ratio >= 10 else f"{ratio:.2g}"
