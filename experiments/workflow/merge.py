# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a sweep as one record: their rows, part by part, which is the order of a run as a whole.

The one place where tables are put together: every table that parts have, whatever it is called."""

import json
import os
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


def rows_in(data, quoted):
    """The line breaks that end a row; whether the data end inside quotes."""
    rows = 0
    for i, piece in enumerate(data.split(b'"')):
        rows += piece.count(b"\n") if bool(i % 2) == quoted else 0
    return rows, quoted ^ bool(data.count(b'"') % 2)


def field_text(field):
    """As bvlab writes it: in quotes where it holds a comma, quotes or a line break of any kind."""
    text = str(field)
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n\r') else text


def lines_of(rows):
    return "".join(",".join(map(field_text, row)) + "\n" for row in rows)


def tables_of(parts, name):
    """The files of tables in the parts; the one that says that all is there is the last."""
    found = {path.name for part in parts for path in part.glob("*.csv")}
    return sorted(found - {f"{name}.csv"}) + [f"{name}.csv"]


def append(path, header, out):
    """The rows of one file, behind those of others, and how many they are."""
    with open(path, "rb") as file:
        own = header_of(file, path)
        if header not in (None, own):
            raise Unmergeable(f"{path}: has other columns than the parts before it")
        if header is None:
            out.write(own)
        rows, quoted = 0, False
        while data := file.read(1 << 20):
            more, quoted = rows_in(data, quoted)
            rows += more
            out.write(data)
    return own, rows


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
    paths = [path for part in parts if (path := part / name).is_file()]

    def write(file):
        header, found = None, 0
        for path in paths:
            header, more = append(path, header, file)
            found += more
        if rows is not None and found != rows:
            raise Unmergeable(f"{name}: the parts hold {found} rows, not {rows}")

    if paths or rows is not None:
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
