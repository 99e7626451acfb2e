# SPDX-License-Identifier: BSD-3-Clause
"""Hypotheses that were written down before a record was made, and what became of them."""


def print_hypotheses(found):
    """A line for each (number, whether it holds, the numbers that say so)."""
    print("\nHypotheses:")
    for number, holds, why in found:
        print(f"  {number}: {'holds' if holds else 'fails'}: {why}")
