# SPDX-License-Identifier: BSD-3-Clause
"""README.md, the pages of experiments/ and the paper say what the records say, and a number that no record gives is found."""

import re
import sys
import unittest
from unittest import mock

from repository import ROOT

import quotes  # noqa: F401
import quoting
from quoting import Interval, Page, written

sys.path.insert(0, str(ROOT / "paper"))
import generate  # noqa: E402


class Pages(unittest.TestCase):
    """Numbers are computed once in this process, whatever page says them."""

    def test_pages_say_what_the_records_say(self):
        for page in quoting.pages():
            with self.subTest(page.name):
                should = page.written()
                self.assertEqual(page.faults, [])
                self.assertEqual((ROOT / page.name).read_text(), should, "plots/quote --write makes the page")

    def test_every_number_is_a_records(self):
        for page in quoting.pages():
            with self.subTest(page.name):
                self.assertEqual([f"line {line}: {around}" for line, _, around in page.uncovered()], [])

    def test_the_paper_says_what_the_records_say(self):
        paper = generate.text()
        paper.written()
        self.assertEqual(paper.faults, [])

    def test_every_number_that_is_computed_is_said(self):
        texts = "".join(page.template for page in quoting.pages()) + quoting.PAPER.read_text()
        said = {match[1] for match in quoting.PLACE.finditer(texts)}
        self.assertEqual(sorted(set(quoting.FUNCTIONS) - said), [])

    def test_links_lead_somewhere(self):
        for page in quoting.pages():
            for address in re.findall(r"\]\((?!https?:|#)([^)#]+)", page.written()):
                with self.subTest(f"{page.name}: {address}"):
                    self.assertTrue(((ROOT / page.name).parent / address).exists())

    def test_the_readme_is_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text().splitlines()), 80)


class Templates(unittest.TestCase):
    def page(self, template, values=None, untrue=()):
        with mock.patch.dict(quoting.FUNCTIONS, {"of": lambda records: (values or {}, list(untrue))}):
            page = Page("page", template)
            return page.written(), page.faults

    def test_places_are_filled_in(self):
        text, faults = self.page("It takes <<of.ratio:.1f>> times as long as <<of.name>>.", {"ratio": Interval([2, 3]), "name": "a list"})
        self.assertEqual((text, faults), ("It takes 2.0 to 3.0 times as long as a list.", []))

    def test_a_table(self):
        text, _ = self.page("| a | b |\n|---|---|\n<<of.rows>>\n", {"rows": [["5", ""], ["6", "7"]]})
        self.assertEqual(text, "| a | b |\n|---|---|\n| 5 | |\n| 6 | 7 |\n")

    def test_a_sentence_that_is_no_longer_so(self):
        text, faults = self.page("Lists win <<of.n:d>> times.", {"n": 3}, ["lists win"])
        self.assertEqual(text, "Lists win 3 times.")
        self.assertIn("lists win", faults[0])

    def test_a_place_that_cannot_be_filled_in(self):
        for template in ("<<of.other:d>>", "<<nobody.n:d>>"):
            text, faults = self.page(template, {"n": 3})
            self.assertEqual(text, template)
            self.assertEqual(len(faults), 1)

    def test_numbers_without_a_record(self):
        page = Page("page", "<<of.n:d>> of 10k boxes, 1.5 times in sweep1 and `float 32`, 26-DOPs [of](4/5.png) H<sub>2</sub>, "
                            "414 400 answers, <<20 frames|what the definition sets>>")
        self.assertEqual([number for _, number, _ in page.uncovered()], ["10k", "1.5", "414 400"])
        self.assertIn(", 20 frames", page.written())

    def test_how_values_are_written(self):
        self.assertEqual(written(Interval([1.04, 1.01]), ".1f"), "1.0")
        self.assertEqual(written([1, 2, 3.44], ".1f"), "1.0, 2.0 and 3.4")
        self.assertEqual(written(119.9, ".2g"), "120")
        self.assertEqual(written(0.0456, ".2g"), "0.046")
        self.assertEqual(written(414400, "d"), "414 400")
        self.assertEqual(written(3440831, "s"), "3.4M")
        self.assertEqual(written("spheres", ""), "spheres")


if __name__ == "__main__":
    unittest.main()
