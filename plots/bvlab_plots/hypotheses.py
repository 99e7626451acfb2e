# SPDX-License-Identifier: BSD-3-Clause
"""Hypotheses that were written down before a record was made, and what became of them."""


def print_hypotheses(found):
    """A line for each (number, whether it holds, the numbers that say so)."""
    print("\nHypotheses:")
    for number, holds, why in found:
        print(f"  {number}: {'holds' if holds else 'fails'}: {why}")


def told(found, names):
    """Those that hold and those that fail, each by its name and number; `names` in the order of numbers, from 1."""
    sides = {True: [], False: []}
    for number, holds, _ in found:
        sides[bool(holds)].append(f"{names[int(number) - 1]} ({number})")
    return {"held": "; ".join(sides[True]), "failed": "; ".join(sides[False])}
