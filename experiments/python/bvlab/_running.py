# SPDX-License-Identifier: BSD-3-Clause
"""Experiments: definitions in, records out."""

from __future__ import annotations

import json
import os
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path

from ._bvlab import run_text


def run(definition: dict | str | os.PathLike, record: str | os.PathLike | None = None, *, counts: bool = False,
        threads: int = 0, progress: Callable[[int, int], object] | bool | None = None) -> Path:
    """Runs an experiment or a study into a record, or goes on with a broken one, as `bvlab run`.

    definition  a TOML file, or a dict of what would stand in it: name, parameters, axis, figure ...; see
                bvlab.parameters() and experiments/definitions/README.md
    record      folder of the record; a new one, experiments/record/<date>.<n>, where not given
    counts      time nothing: counts and answers, by all threads
    threads     of what is not timed; 0 for all cores
    progress    None or True: a bar, on a terminal or in a notebook, after two seconds; False: nothing; or a function
                that is called with the parts that are done and all of them

    Gives the record's folder, for bvlab.record and bvlab.figures. Ctrl-C ends it after the part at work.
    ValueError: the line that the program would print.
    """
    if record is not None and (not os.fspath(record) or "\0" in os.fspath(record)):
        raise ValueError(f"record: {os.fspath(record)!r} is no path of a folder")
    if isinstance(definition, dict):
        text = toml_of(definition)
        name = str(Path(record) / "definition.toml") if record is not None else "definition.toml"
    else:
        name = os.fspath(definition)
        try:
            text = Path(name).read_text()
        except (OSError, UnicodeDecodeError) as fault:
            raise ValueError(f"{name}: {getattr(fault, 'strerror', None) or fault}") from None
    show: Bar | Callable[[int, int], object] | None
    if progress is None or isinstance(progress, bool):
        show = None if progress is False else Bar()
    else:
        show = progress
    try:
        # As bytes: a path may have some that are no text.
        folder = b"" if record is None else os.fsencode(record)
        return Path(run_text(text, os.fsencode(name), folder, counts, threads, show))
    finally:
        if isinstance(show, Bar):
            show.close()


class Bar:
    """On a terminal or in a notebook, once the work has taken two seconds."""

    def __init__(self):
        self.start, self.handle, self.shown = time.monotonic(), None, False

    def __call__(self, done, of):
        seconds = time.monotonic() - self.start
        if seconds < 2:
            return
        filled = 40 * done // of if of else 40
        left = f", {seconds / done * (of - done):.0f} s left" if done else ""
        text = f"[{'=' * filled}{' ' * (40 - filled)}] {done} of {of}{left}"
        if self._in_notebook():
            self._update(text)
        elif sys.stderr.isatty():
            print(f"\r{text} \x1b[K", end="", file=sys.stderr, flush=True)
            self.shown = True

    def close(self):
        if self.shown:
            print(file=sys.stderr)

    @staticmethod
    def _in_notebook():
        shell = sys.modules.get("IPython") and sys.modules["IPython"].get_ipython()
        return bool(shell) and hasattr(shell, "kernel")

    def _update(self, text):
        from IPython.display import display
        shown = {"text/plain": text}
        if self.handle is None:
            self.handle = display(shown, raw=True, display_id=True)
        else:
            self.handle.update(shown, raw=True)


def toml_of(table):
    """What tomllib.loads gives back as that dict."""
    lines = []
    _write(table, [], lines)
    return "\n".join(lines) + "\n"


def _write(table, path, lines):
    def is_tables(value):
        return isinstance(value, (list, tuple)) and value and all(isinstance(each, dict) for each in value)

    for key, value in table.items():
        if not isinstance(value, dict) and not is_tables(value):
            lines.append(f"{_key(key)} = {_value(value, [*path, key])}")
    for key, value in table.items():
        name = ".".join(map(_key, [*path, key]))
        if isinstance(value, dict):
            lines += ["", f"[{name}]"]
            _write(value, [*path, key], lines)
        elif is_tables(value):
            for each in value:
                lines += ["", f"[[{name}]]"]
                _write(each, [*path, key], lines)


def _key(key):
    if not isinstance(key, str):
        raise ValueError(f"definition: a key must be a string, not {key!r}")
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _string(key)


def _string(text):
    text.encode()  # a ValueError for what is no Unicode, such as half a surrogate pair
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value, path):
    if value is None:
        raise ValueError(f"definition: {'.'.join(map(str, path))}: None is no value; leave it out")
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, bool):
        return json.dumps(value)
    if hasattr(value, "tolist") and type(plain := value.tolist()) is not type(value):  # NumPy's
        return _value(plain, path)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, os.PathLike):
        return _string(os.fspath(value))
    if isinstance(value, (list, tuple, range)):
        return f"[{', '.join(_value(each, path) for each in value)}]"
    raise ValueError(f"definition: {'.'.join(map(str, path))}: {type(value).__name__} is no value of TOML")
