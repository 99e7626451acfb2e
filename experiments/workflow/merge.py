# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a sweep as one record: their rows, part by part, which is the order of a run as a whole.

The one place where tables are put together: every table that parts have, whatever it is called."""

import csv
import json
import os
import shutil
import tempfile

PROGRAM = ["bvlab", "commit", "changes", "compiler", "flags", "libraries"]  # what the counts may depend on
NODE = ["processor", "cores", "memory", "system", "kernel"]


class Unmergeable(Exception):
    """Why there is no record, in one line."""


def header_of(file, path):
    """The line of the columns, or lines: a name may hold a line break, in quotes."""
    header = file.readline()
    while header.count(b'"') % 2:
        more = file.readline()
        if not more:
            break
        header += more
    if not header.endswith(b"\n"):
        raise Unmergeable(f"{path}: has no columns")
    return header


def tables_of(parts, name):
    """The files of tables in the parts; the one that says that all is there is the last."""
    found = {path.name for part in parts for path in part.glob("*.csv")}
    return sorted(found - {f"{name}.csv"}) + [f"{name}.csv"]


def rows_of(path):
    with open(path, newline="", encoding="utf-8", errors="surrogateescape") as file:
        return sum(1 for _ in csv.reader(file)) - 1


def written_whole(path, write):
    """The file appears when `write(file)` is through, or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        try:
            write(file)
            file.flush()
            os.fsync(file.fileno())
            os.fchmod(file.fileno(), 0o644)
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise


def merge_table(record, name, parts, rows):
    """Where `rows` is a number, that of a table that has to be there."""
    paths = [path for part in parts if (path := part / name).is_file()]
    found = sum(map(rows_of, paths)) if rows is not None else None
    if found != rows:
        raise Unmergeable(f"{name}: the parts hold {found} rows, not {rows}")

    def write(file):
        header = None
        for path in paths:
            with open(path, "rb") as part:
                own = header_of(part, path)
                if header not in (None, own):
                    raise Unmergeable(f"{path}: has other columns than the parts before it")
                if header is None:
                    file.write(own)
                shutil.copyfileobj(part, file)
            header = own
    written_whole(record / name, write)


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
        written_whole(record / file, lambda out, content=content: out.write(content))
    for table in tables_of(parts, name):
        merge_table(record, table, parts, rows if table == f"{name}.csv" else None)
