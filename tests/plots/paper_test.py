# SPDX-License-Identifier: BSD-3-Clause
"""The paper's text: it can be filled in, nothing measured is typed in, and what it cites is known."""

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
import quoting  # noqa: E402

KEY = re.compile(r"\b[a-z]+(?:19|20)\d\d[a-z]+\b")


class PaperText(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        template = "\n".join(re.sub(r"(?<!\\)%.*", "", line) for line in quoting.PAPER.read_text().splitlines())
        cls.text = template[template.index(r"\begin{document}"):]

    def test_numbers_come_from_functions(self):
        places = {match[1] for match in quoting.PLACE.finditer(self.text)}
        self.assertGreater(len(places), 15)
        self.assertEqual(places - set(quoting.FUNCTIONS), set())

    def test_abstract_is_short(self):
        abstract = self.text[self.text.index(r"\begin{abstract}") + 16:self.text.index(r"\end{abstract}")]
        self.assertLessEqual(len(abstract.split()), 210)

    def test_no_time_is_typed_in(self):
        self.assertEqual(re.findall(r"\d(?:\\,|~| )?(?:ns|ms|\$?\\mu)\b", self.text), [])

    def test_symbols_are_listed(self):
        self.assertIn(r"\label{symbols}", self.text)
        self.assertGreaterEqual(self.text.count(r"\begin{equation}"), 6)

    def test_references(self):
        known = set(re.findall(r"^@\w+\{([^,]+),", (PAPER / "references.bib").read_text(), re.M))
        cited = {key for keys in re.findall(r"\\cite\{([^}]*)\}", self.text) for key in keys.split(",")}
        self.assertEqual(cited - known, set())
        named = {key for folder in ("hierarchies", "traversal", "broadphase") for path in (ROOT / folder).rglob("*.hpp")
                 for key in KEY.findall(path.read_text())}
        self.assertEqual(named - known, set())

    def test_what_is_referred_to_is_there(self):
        labels = set(re.findall(r"\\label\{(\w+)\}", self.text))
        self.assertEqual(set(re.findall(r"\\ref\{(\w+)\}", self.text)) - labels, set())
        drawn = set(re.findall(r'out, "([\w-]+)"\)', (PAPER / "drawings.py").read_text())) | {"worth"}
        self.assertEqual(set(re.findall(r"\\(?:columnwide|includegraphics\[[^]]*\])\{([\w-]+)\}", self.text)) - drawn, set())


class AsLatex(unittest.TestCase):
    def test_marks(self):
        self.assertEqual(generate.latex("`a_b` 5 %, 414 400"), r"\emph{a\_b} 5 \%, 414\,400")

    def test_a_record_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            paper = generate.text(Path(folder))
            paper.written()
        self.assertTrue(any("there is no record of it" in fault for fault in paper.faults))


if __name__ == "__main__":
    unittest.main()
