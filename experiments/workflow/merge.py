# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a sweep as one record: their rows, part by part, which is the order of a run as a whole.

The one place where tables are put together: every table that parts have, whatever it is called."""

import csv
import json
import os
import tempfile

PROGRAM = ["bvlab", "commit", "changes", "compiler", "flags", "libraries"]  # what the counts may depend on
NODE = ["processor", "cores", "memory", "system", "kernel"]


class Unmergeable(Exception):
    """Why there is no record, in one line."""


def tables_of(parts, name):
    """The files of tables in the parts; the one that says that all is there is the last."""
    found = {path.name for part in parts for path in part.glob("*.csv")}
    return sorted(found - {f"{name}.csv"}) + [f"{name}.csv"]


def read(path):
    """Of a table the line of its columns (lines: a name may hold a break, in quotes), those of its rows, and how many rows."""
    with open(path, newline="", encoding="utf-8", errors="surrogateescape") as file:
        lines = file.readlines()
    reader = csv.reader(lines)
    next(reader, None)
    header = "".join(lines[:reader.line_num])
    if not header.endswith("\n"):
        raise Unmergeable(f"{path}: has no columns")
    return header, "".join(lines[reader.line_num:]), sum(1 for _ in reader)


def written_whole(path, content):
    """The file appears with all of its bytes, or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        try:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
            os.fchmod(file.fileno(), 0o644)
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise


def merge_table(record, name, parts, rows):
    """Where `rows` is a number, that of a table that has to be there."""
    tables = {path: read(path) for part in parts if (path := part / name).is_file()}
    found = sum(count for _, _, count in tables.values())
    if rows not in (None, found):
        raise Unmergeable(f"{name}: the parts hold {found} rows, not {rows}")
    columns = next(iter(tables.values()))[0]
    for path, (header, _, _) in tables.items():
        if header != columns:
            raise Unmergeable(f"{path}: has other columns than the parts before it")
    text = columns + "".join(of_rows for _, of_rows, _ in tables.values())
    written_whole(record / name, text.encode("utf-8", errors="surrogateescape"))


def merged_machine(parts):
    """What built the program, which must be one; and each node that began a part."""
    machines = [json.loads((part / "machine.json").read_text()) for part in parts]
    first = machines[0]
    for part, machine in zip(parts, machines):
        for key in PROGRAM:
            if machine.get(key) != first.get(key):
                raise Unmergeable(f"{part}: was run by another program than {parts[0]} ({key}: {machine.get(key)}, "
                                  f"not {first.get(key)}); remove one of them, and it is run again")
    nodes = {machine["node"]: {key: machine[key] for key in NODE} for machine in machines}
    return first if len(nodes) == 1 else first | {"nodes": nodes}


def merge(record, name, count, rows, command):
    """Makes the record of <record>/parts/1 ... count, which hold that number of rows; the table with them appears last."""
    parts = [record / "parts" / str(i) for i in range(1, count + 1)]
    machine = json.dumps(merged_machine(parts), indent=2) + "\n"
    definition = (record / "parts" / "definition.toml").read_bytes()
    for file, content in (("machine.json", machine.encode()), ("definition.toml", definition),
                          ("command.txt", command.encode())):
        written_whole(record / file, content)
    for table in tables_of(parts, name):
        merge_table(record, table, parts, rows if table == f"{name}.csv" else None)
