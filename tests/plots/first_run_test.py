# SPDX-License-Identifier: BSD-3-Clause
"""What the first run ends with: the talk's speedups and ours, and `recommended` beside other libraries."""

import unittest

from drawing import PLOTS

import first_run
from bvlab_plots.refused import Refused

RECORDS = PLOTS.parent / "experiments" / "record"


class FirstRun(unittest.TestCase):
    def test_ten_lines_or_so(self):
        lines = first_run.lines(RECORDS / "nine-bunnies", RECORDS / "tournament-peers")
        self.assertLessEqual(len(lines), 12)
        self.assertLessEqual(max(map(len, lines)), 120)
        text = "\n".join(lines)
        for words in ("1.40", "1.84", "separation list", "recommended", "OPCODE", "FCL", "Every answer was compared"):
            self.assertIn(words, text)
        self.assertNotIn("contacts", text)

    def test_a_record_of_something_else(self):
        with self.assertRaises(Refused):
            first_run.lines(RECORDS / "nine-bunnies", RECORDS / "coherence")


if __name__ == "__main__":
    unittest.main()
