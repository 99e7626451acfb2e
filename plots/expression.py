# SPDX-License-Identifier: BSD-3-Clause
"""Expressions of a record's columns: "time_ns / pairs", "1e6 * (false_positives + false_negatives) / pairs"."""

import ast
import operator

import numpy as np
import pandas as pd

from refused import Refused
from words import ONE_OF, called

OPERATORS = {ast.Add: (operator.add, "+"), ast.Sub: (operator.sub, "−"), ast.Mult: (operator.mul, "·"),
             ast.Div: (operator.truediv, "/"), ast.Pow: (operator.pow, "^")}
COMPARED = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge}


class Expression:
    """Sums, products and powers of columns and numbers, and comparisons of two of them."""

    def __init__(self, text, rows):
        """Refused with the columns there are where the text names another, or is no such expression."""
        self.text, self.units, self.kind = text, rows.attrs["units"], rows.attrs["kind"]
        try:
            self.tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise Refused(f"'{text}' is no expression of columns") from None
        self.columns = []
        self.check(self.tree, rows)

    def check(self, node, rows):
        if isinstance(node, ast.Name):
            if node.id not in rows:
                raise Refused(f"'{self.text}': no column '{node.id}'; there are {', '.join(self.units)}")
            if not pd.api.types.is_numeric_dtype(rows[node.id]) and node is not self.tree:
                blank = rows[node.id].eq("").all()
                raise Refused(f"'{self.text}': column '{node.id}' " +
                              ("is empty" if blank else "holds names, not numbers"))
            self.columns.append(node.id)
        elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            self.check(node.left, rows), self.check(node.right, rows)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            self.check(node.operand, rows)
        elif node is self.tree and isinstance(node, ast.Compare) and [type(o) in COMPARED for o in node.ops] == [True]:
            self.check(node.left, rows), self.check(node.comparators[0], rows)
        elif not (isinstance(node, ast.Constant) and type(node.value) in (int, float)):
            raise Refused(f"'{self.text}' is no expression of columns: + - * / ** ( ), numbers and names are")

    def of(self, rows):
        """Its value in each row."""
        with np.errstate(all="ignore"):
            value = self.value(self.tree, rows)
        return value if isinstance(value, pd.Series) else pd.Series(value, rows.index)

    def value(self, node, rows):
        if isinstance(node, ast.Name):
            return rows[node.id]
        if isinstance(node, ast.Constant):
            return float(node.value)
        if isinstance(node, ast.UnaryOp):
            return -self.value(node.operand, rows)
        if isinstance(node, ast.Compare):
            return COMPARED[type(node.ops[0])](self.value(node.left, rows), self.value(node.comparators[0], rows))
        try:
            return OPERATORS[type(node.op)][0](self.value(node.left, rows), self.value(node.right, rows))
        except (OverflowError, ZeroDivisionError):
            raise Refused(f"'{self.text}' is infinite") from None

    def unit(self):
        """What it is measured in: of a time over a number, the time's."""
        units = {unit: power for unit, power in self.dimension(self.tree).items() if power}
        if not units:
            return ""
        if set(units.values()) == {1} and len(units) == 1:
            return next(iter(units))
        return " ".join(f"{unit}^{power:g}" if power != 1 else unit for unit, power in units.items())

    def dimension(self, node):
        if isinstance(node, ast.Name):
            return {self.units[node.id]: 1} if self.units.get(node.id) else {}
        if isinstance(node, ast.UnaryOp):
            return self.dimension(node.operand)
        if not isinstance(node, ast.BinOp):
            return {}
        left, right = self.dimension(node.left), self.dimension(node.right)
        if isinstance(node.op, (ast.Add, ast.Sub)) and left != right:
            raise Refused(f"'{self.text}' adds what is not measured in the same unit")
        if isinstance(node.op, ast.Pow):
            return {unit: power * self.value(node.right, {}) for unit, power in left.items()} if left else {}
        sign = -1 if isinstance(node.op, ast.Div) else 1
        if not isinstance(node.op, (ast.Mult, ast.Div)):
            return left
        return {unit: left.get(unit, 0) + sign * right.get(unit, 0) for unit in {**left, **right}}

    def label(self, node=None, inside=False):
        """In words: "time a pair"."""
        node = node or self.tree
        if isinstance(node, ast.Name):
            return called(node.id, self.kind)
        if isinstance(node, ast.UnaryOp):
            return "−" + self.label(node.operand, True)
        if not isinstance(node, ast.BinOp):
            return f"{node.value:g}" if isinstance(node, ast.Constant) else self.text
        if isinstance(node.op, ast.Div) and isinstance(node.right, ast.Name) and node.right.id in ONE_OF:
            return f"{self.label(node.left, True)} a {ONE_OF[node.right.id]}".replace("a answer", "an answer").replace(
                "a overlapping", "an overlapping")
        text = f"{self.label(node.left, True)} {OPERATORS[type(node.op)][1]} {self.label(node.right, True)}"
        return f"({text})" if inside else text
