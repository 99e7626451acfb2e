# SPDX-License-Identifier: BSD-3-Clause
"""Records as pandas frames.

    from bvlab_plots import records
    rows = records.read("experiments/record/hierarchies")
    rows.attrs["units"]["time_ns"]                     # "ns"
    rows.groupby(["query", "variant"]).time_ns.median()
"""

import gzip
import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd

from bvlab_plots import provenance, words
from bvlab_plots.looks import STYLES
from bvlab_plots.refused import Refused

# Where a table has no column `repetition`, the first column that is measured.
MEASURED_FROM = {"tightness": "nodes", "stability": "answers"}
WRONG = ["differing", "wrong", "outside"]  # counts of answers that should not be
CORRECTED = ["time_ns", "first_ns", "build_ns"]  # times of a run as a whole: of single frames nobody knows the share
OF_FRAMES = ["p99_ns", "worst_ns"]


def read(record, table="", needs=(), clock="wall"):
    """The rows of a record as a frame, one for each variant, scene, seed and repetition, in the order of its
    definition; of `table` "frames" or "disagreements", the rows of <name>.<table>.csv.

    Numbers are numbers (lengths as "0.03body", too, where all of a column are in the same unit), NaN where there
    is none; names are strings, "" where there is none. Added are: `peer`, the other library that a row is of, or
    "" for ours; `variant`, what distinguishes what was run, as "sphere deferred", "blocks" or a peer's name;
    later_ns and later_pairs, those of all frames but the first; and the columns of <name>.coherence.csv.

    Times are wall times, as the record has them, or, by `clock="processor"`, as figures have them, processor times where
    the record says how much longer the run took (`wall_per_processor`). They are NaN in rows that were measured beside other work (column `alone` "no") where their cell
    has others, and where nothing was timed.

    attrs: record (its folder), machine (machine.json), name and kind (of the study, "" for an experiment), definition
    (a dictionary), settings (the columns that say what was run), units (of each column: ns, B, radii, °, or ""), clock (of times), clock_of_frames (of single frames), unfinished (nothing, or "31 of
    216 rows"). Refused where it is no record, where a column that is needed is not there,
    and where answers of an experiment were not compared.
    """
    record = Path(record)
    definition = read_definition(record)
    name, kind = definition["name"], definition.get("kind", "")
    rows = read_table(record / (f"{name}.{table}.csv" if table else f"{name}.csv"), names_in(definition))
    if rows.empty:
        raise Refused(f"{name}.csv has no rows")
    attrs = dict(record=str(record), machine=provenance.machine_of(record), name=name, kind=kind, definition=definition,
                 unfinished=unfinished_of(record, definition, rows if not table else []))
    if table:
        settings = list(rows.columns[:list(rows.columns).index("frame")]) if "frame" in rows and table == "frames" else []
        units = {column: words.unit_of(column) for column in rows} if settings else {}
        if settings:
            rows = in_order(with_variants(rows.assign(peer="")), definition, settings)
        rows.attrs.update(attrs, settings=settings, units=units, clock="")
        return rows
    check_compared(rows, name, kind)
    settings = setting_columns(rows, kind)
    check_numbers(rows, name, [column for column in rows if column not in settings])
    rows, settings = with_peers(rows, definition, settings)
    rows = with_coherence(rows, record / f"{name}.coherence.csv", names_in(definition))
    rows = own_times(rows)
    if clock == "processor" and "wall_per_processor" in rows:
        corrected = rows.columns.intersection(CORRECTED)
        rows[corrected] = rows[corrected].div(pd.to_numeric(rows.wall_per_processor, errors="coerce").fillna(1), axis=0)
    if {"time_ns", "first_ns", "frames", "pairs"} <= set(rows):
        rows["later_ns"] = rows.time_ns - rows.first_ns
        rows["later_pairs"] = rows.pairs * (rows.frames - 1) / rows.frames
    units = {column: words.unit_of(column) for column in rows}
    for column in settings:
        rows[column], units[column] = as_lengths(rows[column], units[column])
    if kind == "worlds":
        units.update(step="radii", side="radii")
    rows = with_variants(rows)
    units.setdefault("variant", "")
    if missing := [column for column in needs if column not in rows]:
        raise Refused(f"{record}: has no {', '.join(missing)}: it is the record of something else")
    rows = in_order(rows, definition, settings)
    rows.attrs.update(attrs, settings=settings, units=units, clock=clock, clock_of_frames=clock_of_frames(record))
    return rows


def clock_of_frames(record):
    """The clock by which single frames were timed: "processor" where machine.json says so (the run had
    experiments/processor_time.c) and no part of the record was made by another, else "wall"."""
    machine = provenance.machine_of(record)
    changed = any("clock" in part for part in machine.get("later", []))
    return "processor" if machine.get("clock") == "processor" and not changed else "wall"


def times_of_frames(text):
    """The columns named in an expression that are times of single frames."""
    return [name for name in dict.fromkeys(re.findall(r"\b\w+_ns\b", text)) if name in OF_FRAMES]


def unfinished_of(record, definition, rows):
    """How many rows or parts there are, of how many, where a run is under way or was broken off: "31 of 216 rows"; said
    where they are read."""
    path = Path(record) / "unfinished.json"
    if not path.is_file():
        return None
    try:
        said = json.loads(path.read_text())
        what, done, wanted = said["what"], int(said["done"]), int(said["all"])
    except (OSError, ValueError, KeyError, TypeError):
        raise Refused(f"{path}: does not say how much of the record is missing") from None
    text = f"{len(rows) if what == 'rows' and len(rows) else done} of {wanted} {what}"
    if len(rows):
        print(f"unfinished: {text} of {definition['name']}")
    return text


def check_compared(rows, name, kind):
    """An experiment's answers are compared with the reference: a table that does not say so is none of bvlab's."""
    if not kind and "differing" not in rows:
        raise Refused(f"{name}.csv has no column differing: nobody compared its answers")
    column = next((column for column in WRONG if column in rows), None)
    blank = pd.to_numeric(rows[column], errors="coerce").isna() if column else pd.Series(False, rows.index)
    if blank.any():
        raise Refused(f"{name}.csv: {column} is empty in {blank.sum()} of {len(rows)} rows: nobody compared their answers")


def check_numbers(rows, name, measured):
    """What was measured is a number, or blank where nothing was: times always, other columns where most are."""
    for column in measured:
        text = rows[column].astype(str).where(rows[column].notna(), "")
        numbers = pd.to_numeric(rows[column], errors="coerce")
        wrong = (text != "") & ~np.isfinite(numbers)
        if wrong.any() and (words.is_time(column) or wrong.sum() < (text != "").sum() / 2):
            row = int(np.flatnonzero(wrong)[0])
            raise Refused(f"{name}.csv: row {row + 1}: {column}: {text.iloc[row]!r} is no number")


def read_toml(path):
    try:
        definition = tomllib.loads(Path(path).read_bytes().decode("utf-8-sig"))
        definition["name"]
    except KeyError:
        raise Refused(f"{path}: has no name") from None
    except (OSError, ValueError) as fault:
        raise Refused(f"{path}: {fault}".replace("\n", " ")) from None
    for key in ("axis", "figure"):
        tables = definition.get(key, [])
        if not isinstance(tables, list) or not all(isinstance(each, dict) for each in tables):
            raise Refused(f"{path}: {key} is no list of tables: it is written as [[{key}]]")
    if not isinstance(definition.get("parameters", {}), dict):
        raise Refused(f"{path}: parameters is no table")
    return definition


def read_definition(record):
    """The definition in a record, as a dictionary."""
    if not (Path(record) / "definition.toml").is_file():
        raise Refused(f"{record}: no record: it has no definition.toml")
    return read_toml(Path(record) / "definition.toml")


def names_in(definition):
    """The axes whose values are names, though they may look like numbers: several of them are one number, as "1", "1.0"
    and "01" are, or are truth values to pandas."""
    names = set()
    for axis in definition.get("axis", []):
        values = [str(value.get("name")) for value in axis.get("value", []) if isinstance(value, dict)]
        values = values or list(map(str, axis.get("values", [])))
        numbers = pd.to_numeric(pd.Series(values, dtype=object), errors="coerce")
        if (numbers.notna().all() and numbers.nunique() < len(values)) or {"true", "false"} & set(map(str.lower, values)):
            names.add(axis.get("name"))
    return names


def table_at(path):
    """The file of a table: large ones of the repository are compressed."""
    path, packed = Path(path), Path(f"{path}.gz")
    return packed if packed.is_file() and not path.is_file() else path


def read_table(path, names=()):
    """Blanks are empty names, and NaN in columns of numbers; `names` are columns of which all is a name."""
    path = table_at(path)
    try:
        if not ends(path):
            raise Refused(f"{path}: is cut off: its last line has no end")
        rows = pd.read_csv(path, keep_default_na=False, encoding="utf-8-sig", dtype=dict.fromkeys(names, str))
    except (OSError, ValueError, UnicodeDecodeError) as fault:
        raise Refused(f"{path}: {fault}".replace("\n", " ")) from None
    for column in rows.columns[rows.dtypes == object].difference(list(names), sort=False):
        text = rows[column]
        numbers = pd.to_numeric(text, errors="coerce")
        if (text != "").any() and numbers[text != ""].notna().all():
            rows[column] = numbers
    return rows


def ends(path):
    """Whether the last line has an end, outside of quotes."""
    with (gzip.open if path.suffix == ".gz" else open)(path, "rb") as file:
        quotes, last = 0, b"\n"
        while data := file.read(1 << 20):
            quotes, last = quotes + data.count(b'"'), data[-1:]
    return last in b"\r\n" and quotes % 2 == 0


def setting_columns(rows, kind):
    columns = list(rows.columns)
    measured = "repetition" if "repetition" in columns else MEASURED_FROM.get(kind)
    if measured in columns:
        return columns[:columns.index(measured)]
    return [column for column in columns if rows[column].dtype == object]


def with_peers(rows, definition, settings):
    """The same column `peer` for every kind, and nothing in settings that a peer does not have."""
    if "peer" in rows:  # which has neither a volume nor a strategy of ours, whatever an older record says
        ours = rows.columns.intersection(["volume", "tree", "fan_out", "frame", "kernel", "strategy"])
        rows[ours] = rows[ours].where(rows.peer == "", "")
        return rows, settings
    named = [definition.get("parameters", {}).get(key, []) for key in ("peers", "peers_if_built")]
    peers = [peer for each in named for peer in ([each] if isinstance(each, str) else each)]
    if "source" in rows:
        own = {"bvlab", "batched", "one by one"}
        rows["peer"] = ["" if s in own else rows.test[i] if s == "peer" else s for i, s in rows.source.items()]
    elif "method" in rows:
        rows["peer"] = rows.method.where(rows.method.isin(peers), "")
        for mode in {"coherent", "changes"} & set(rows):
            rows[mode] = rows[mode].where((rows.peer == "") | (rows[mode] == "told"), "")
    else:
        rows["peer"] = ""
    return rows, settings + ["peer"]


def with_coherence(rows, path, names):
    if table_at(path).is_file():
        coherence = read_table(path, names)
        shared = [column for column in coherence if column in rows]
        rows = rows.merge(coherence, how="left", on=shared)
    if {"kept", "entries"} <= set(rows):
        rows["survival"] = rows.kept / rows.entries.where(rows.entries > 0)
    return rows


def own_times(rows):
    """Times of rows that had their node to themselves, where their cell has any; where it has none they stay, which
    is said, since a busy machine is better seen than hidden. A record from before rows said so is taken at its word."""
    times = [column for column in rows if words.is_time(column)]
    rows[times] = rows[times].apply(pd.to_numeric, errors="coerce")  # blank in all rows, where nothing was timed
    beside = rows.alone == "no" if "alone" in rows else pd.Series(False, rows.index)
    if not beside.any():
        return rows
    cell = list(rows.columns[: list(rows.columns).index("repetition")]) if "repetition" in rows else []
    quiet = ~beside & rows[times].notna().any(axis=1)
    quiet_in_cell = quiet.groupby([rows[c].astype(str) for c in cell]).transform("any") if cell else quiet | quiet.any()
    left_out = beside & quiet_in_cell
    if left_out.any():
        print(f"left out: times of {left_out.sum()} of {len(rows)} rows, which were measured beside other work")
        rows[times] = rows[times].mask(left_out)
    if kept := (beside & ~left_out).sum():
        print(f"beside other work: times of {kept} of {len(rows)} rows, of cells in which none was measured alone")
    return rows


def as_lengths(column, unit):
    """"0.03body" as 0.03 in radii, where all are written so."""
    if column.dtype == object:
        for suffix, name in words.LENGTHS.items():
            numbers = pd.to_numeric(column.str.removesuffix(suffix), errors="coerce")
            if column.str.endswith(suffix).all() and numbers.notna().all():
                return numbers.astype(float), name
    return column, unit


def with_variants(rows):
    """With a column `variant`, that of the table if it has one."""
    return rows if "variant" in rows else rows.assign(variant=variant_names(rows).where(rows.peer == "", rows.peer))


def variant_names(rows):
    """For each row of ours what was run: "volume strategy", the part alone of which there is more than one, or the
    configuration that chose both."""
    for column in ("method", "test", "policy"):
        if column in rows:
            return rows[column]
    ours = rows[rows.peer == ""]
    parts = [part for part in ("volume", "strategy") if part in rows]
    several = [part for part in parts if ours[part].nunique() > 1] or parts[-1:]
    named = rows[several].agg(" ".join, axis=1) if several else pd.Series("", rows.index)
    return named.where(rows.configuration == "", rows.configuration) if "configuration" in rows else named


def in_order(rows, definition, settings):
    """Rows are run in random order: here as the definition's lists have them."""
    names = [str(name) for axis in definition.get("axis", []) for name in
             ([value["name"] for value in axis.get("value", [])] or axis.get("values", []))]
    names += [str(name) for value in definition.get("parameters", {}).values() for name in (value if isinstance(value, list) else [value])]
    place = {name: i for i, name in enumerate(names)}
    # Names that the definition leaves open: as in STYLES, and then in the order in which they come first.
    found = [name for column in settings if rows[column].dtype == object for name in dict.fromkeys(rows[column])]
    place = {**{name: len(place) + i for i, name in enumerate(dict.fromkeys([*STYLES, *found]))}, **place}
    for column in reversed(settings):
        named = rows[column].dtype == object
        rows = rows.sort_values(column, key=lambda c, named=named: c.map(place) if named else c, kind="stable")
    return rows.sort_values("peer", key=lambda c: c != "", kind="stable").reset_index(drop=True)


def wrong_of(rows):
    """Which rows hold answers that differ from the reference."""
    return rows[rows.columns.intersection(WRONG)].fillna(0).ne(0).any(axis=1)


def wrong_answers(rows):
    """Which rows hold answers that differ from the reference; refused where one of ours does."""
    wrong = wrong_of(rows)
    names = list(dict.fromkeys(rows[wrong & (rows.peer == "")].variant))
    if names:
        raise Refused(f"answers of {', '.join(names)} differ from the reference")
    return wrong


def right(record, **options):
    """As `read`; refused where an answer of ours differs from the reference."""
    rows = read(record, **options)
    wrong_answers(rows)
    return rows


def say_left_out(names, why):
    """Nothing is left out in silence."""
    names = sorted(set(map(str, names)))
    if names:
        print(f"left out, {why}: {', '.join(names)}")
