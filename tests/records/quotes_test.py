# SPDX-License-Identifier: BSD-3-Clause
"""What README.md and experiments/results.md say is what the records say, and a number that is not is found."""

import subprocess
import sys
import unittest
from unittest import mock

from repository import PLOTS

import quotes  # noqa: F401
import quoting
from quoting import Interval, Page, Quote, written


class Pages(unittest.TestCase):
    def test_pages_say_what_the_records_say(self):
        done = subprocess.run([sys.executable, "-B", PLOTS / "quote", "--check"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{done.stdout}{done.stderr}\nplots/quote --write puts the numbers there")

    def test_every_number_is_a_records(self):
        for name in quoting.PAGES:
            with self.subTest(name):
                page = Page(name)
                self.assertEqual([f"line {line}: {around}" for line, _, around in page.uncovered()], [])
                self.assertEqual(page.faults, [])

    def test_a_changed_number_is_found_and_mended(self):
        """One quote after the other, so that none looks at less than it says."""
        for name in quoting.PAGES:
            right = Page(name)
            for start, end in right.known:
                digits = [i for i in range(start, end) if right.text[i].isdigit()]
                if not digits:
                    continue
                i = digits[-1]
                wrong = f"{right.text[:i]}{(int(right.text[i]) + 1) % 10}{right.text[i + 1:]}"
                with self.subTest(f"{name}: {right.text[start:end][:60]}"):
                    page = Page(name, wrong)
                    self.assertTrue(page.differences() or page.faults)
                    if not page.faults:
                        self.assertEqual(page.rewritten(), right.text)


class Quotes(unittest.TestCase):
    def page(self, stands, *said):
        """Of quotes that are a text and values."""
        listed = [Quote("page", text, lambda values=values, untrue=untrue: (values, untrue))
                  for text, values, *untrue in said]
        with mock.patch.object(quoting, "QUOTES", listed):
            return Page("page", stands)

    def test_line_breaks_stay(self):
        page = self.page("It takes 1.5 to\n1.6 times as\nlong.\n", ("takes {ratio:.1f} times as long", {"ratio": Interval([2, 3])}))
        self.assertEqual(page.rewritten(), "It takes 2.0 to 3.0 times as\nlong.\n")

    def test_a_table_is_written_whole(self):
        page = self.page("Text.\n\n| a | b |\n|---|---|\n| 1 | 2 |\n| 3 | 4 |\n\nMore.\n", ("| a | b |", {"rows": [["5", ""]]}))
        self.assertEqual(page.rewritten(), "Text.\n\n| a | b |\n|---|---|\n| 5 | |\n\nMore.\n")

    def test_a_sentence_that_is_no_longer_so(self):
        page = self.page("Lists win 2 times.", ("Lists win {n:d} times", {"n": 3}, "lists win"))
        self.assertEqual(page.faults, ["page: no longer so: lists win"])
        self.assertEqual(page.rewritten(), "Lists win 3 times.")

    def test_a_sentence_that_is_not_there_or_twice(self):
        for text in ("", "2 wins, 2 wins"):
            self.assertIn("not once", self.page(text, ("{n:d} wins", {"n": 2})).faults[0])

    def test_numbers_without_a_record(self):
        page = self.page("3 of 10k boxes, 1.5 times in sweep1 and `float 32`, 26-DOPs [of](4/5.png) H<sub>2</sub>, 414 400 answers",
                         ("{n:d} of", {"n": 3}))
        self.assertEqual([number for _, number, _ in page.uncovered()], ["10k", "1.5", "414 400"])

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
