# SPDX-License-Identifier: BSD-3-Clause
"""The paper's text against its numbers: all that it names is made, nothing measured is typed in."""

import contextlib
import io
import math
import re
import sys
import tempfile
import unittest
from pathlib import Path

from drawing import PLOTS

ROOT = PLOTS.parent
PAPER = ROOT / "paper"
sys.path.insert(0, str(PAPER))
import generate  # noqa: E402
import sheet  # noqa: E402

RECORDS = ROOT / "experiments" / "record"
KEY = re.compile(r"\b[a-z]+(?:19|20)\d\d[a-z]+\b")


def quietly(function, *arguments):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return function(*arguments)


def group_at(text, start):
    """The end of the braces that open at `start`, and what is in them."""
    depth = 0
    for place in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[place], 0)
        if depth == 0:
            return place + 1, text[start + 1 : place]
    raise ValueError("braces that do not close")


def with_what_is_there(text, there):
    """The text without the parts of absent records."""
    while found := re.search(r"\\(withrecord|ifrecord|recordelse)(?=\{)", text):
        end, name = group_at(text, found.end())
        end, body = group_at(text, end)
        end, other = group_at(text, end) if found[1] == "recordelse" else (end, "")
        text = text[: found.start()] + (body if name in there else other) + text[end:]
    return text


class PaperText(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            paper = quietly(generate.filled, RECORDS, folder)
            cls.there = {path.stem for path in (Path(folder) / "have").iterdir()}
            cls.tables = {path.stem for path in (Path(folder) / "tables").iterdir()}
        cls.numbers, cls.values = paper.numbers, paper.values
        text = "\n".join(re.sub(r"(?<!\\)%.*", "", line) for line in (PAPER / "main.tex").read_text().splitlines())
        cls.text = with_what_is_there(text[text.index(r"\begin{document}") :], cls.there)

    def test_macros_are_made(self):
        used = set(re.findall(r"\\([a-z]+[A-Z][A-Za-z]*)", self.text))
        self.assertGreater(len(used), 50)
        self.assertEqual(used - set(self.numbers), set())

    def test_tables_are_made(self):
        used = set(re.findall(r"\\input\{tables/([\w-]+)\}|\\columntable\{([\w-]+)\}", self.text))
        self.assertEqual({a or b for a, b in used} - self.tables, set())

    def test_numbers_are_numbers(self):
        for name, value in self.values.items():
            if isinstance(value, float):
                self.assertTrue(math.isfinite(value), name)
        self.assertNotIn("nan", " ".join(map(str, self.numbers.values())))

    def test_abstract_is_short(self):
        abstract = self.text[self.text.index(r"\begin{abstract}") + 16 : self.text.index(r"\end{abstract}")]
        words = re.sub(r"\\([A-Za-z]+)(\{\})?", lambda m: self.numbers.get(m[1], ""), abstract)
        words = re.sub(r"[\\{}]|,(?=%)", "", words)
        self.assertLessEqual(len(words.split()), 200)

    def test_no_time_is_typed_in(self):
        self.assertEqual(re.findall(r"\d(?:\\,|~| )?(?:ns|ms|\$?\\mu)\b", self.text), [])

    def test_references(self):
        known = set(re.findall(r"^@\w+\{([^,]+),", (PAPER / "references.bib").read_text(), re.M))
        cited = {key for keys in re.findall(r"\\cite\{([^}]*)\}", self.text) for key in keys.split(",")}
        self.assertEqual(cited - known, set())
        named = {
            key
            for folder in ("hierarchies", "traversal", "broadphase")
            for path in (ROOT / folder).rglob("*.hpp")
            for key in KEY.findall(path.read_text())
        }
        self.assertEqual(named - known, set())


class WithoutRecords(unittest.TestCase):
    def test_published_numbers_remain(self):
        with tempfile.TemporaryDirectory() as folder:
            values = quietly(generate.numbers_of, folder)
        self.assertAlmostEqual(values["publishedList"], 1583.8 / 1127.5, 3)
        self.assertAlmostEqual(values["publishedDeferred"], 1583.8 / 860.5, 3)
        self.assertNotIn("lawKappa", values)

    def test_a_record_is_found_by_its_name(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "tori").mkdir()
            self.assertIsNone(sheet.latest(folder, "tori"))
            (Path(folder) / "tori" / "tori.csv").write_text("")
            self.assertEqual(sheet.latest(folder, "tori"), Path(folder) / "tori")


if __name__ == "__main__":
    unittest.main()
