# SPDX-License-Identifier: BSD-3-Clause
"""Expressions of a record's columns: "time_ns / pairs", "1e6 * (false_positives + false_negatives) / pairs".

pandas computes them. Read here is what pandas does not know: in what unit the value is, what it is called, and that
nothing but columns, numbers and operators is in it.
"""

import ast

import numpy as np
import pandas as pd

from bvlab_plots.refused import Refused
from bvlab_plots.words import ONE_OF, called

SIGNS = {ast.Add: "+", ast.Sub: "−", ast.Mult: "·", ast.Div: "/", ast.Pow: "^"}
CONDITIONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)


class Expression:
    """Sums, products and powers of columns and numbers; and conditions: such compared, joined by `and`, `or`, `not`."""

    def __init__(self, text, rows):
        """Refused with the columns there are where the text names another, or is no such expression."""
        self.text, self.units, self.kind = text, rows.attrs["units"], rows.attrs["kind"]
        try:
            self.tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise Refused(f"'{text}' is no expression of columns") from None
        self.columns = []
        self.check(self.tree, rows)

    def check(self, node, rows, names=False):
        """`names`: whether a column of names may stand there, and a name."""
        if isinstance(node, ast.Name):
            if node.id not in rows:
                raise Refused(f"'{self.text}': no column '{node.id}'; available: {', '.join(self.units)}")
            if not pd.api.types.is_numeric_dtype(rows[node.id]) and node is not self.tree and not names:
                blank = rows[node.id].eq("").all()
                raise Refused(f"'{self.text}': column '{node.id}' " +
                              ("is empty" if blank else "holds names, not numbers"))
            self.columns.append(node.id)
        elif isinstance(node, ast.BinOp) and type(node.op) in SIGNS:
            self.check(node.left, rows), self.check(node.right, rows)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
            self.check(node.operand, rows)
        elif isinstance(node, ast.BoolOp):
            for each in node.values:
                self.check(each, rows)
        elif isinstance(node, ast.Compare) and all(isinstance(each, CONDITIONS) for each in node.ops):
            alike = all(isinstance(each, (ast.Eq, ast.NotEq)) for each in node.ops)
            for each in (node.left, *node.comparators):
                self.check(each, rows, names=alike)
        elif not (isinstance(node, ast.Constant) and
                  (type(node.value) in (int, float) or names and isinstance(node.value, str))):
            raise Refused(f"'{self.text}' is no expression of columns: + - * / ** ( ), numbers and names are")

    def of(self, rows):
        """Its value in each row."""
        if isinstance(self.tree, ast.Name):
            return rows[self.tree.id]
        # Whole numbers as floating ones: 9 ** 9 ** 9 is infinite, and not computed for hours.
        try:
            floats = ast.unparse(Floats().visit(ast.parse(self.text.strip(), mode="eval")))
            with np.errstate(all="ignore"):
                value = rows.eval(floats, engine="python")
        except (OverflowError, ZeroDivisionError):
            raise Refused(f"'{self.text}' is infinite") from None
        except (TypeError, ValueError, NotImplementedError) as fault:
            raise Refused(f"'{self.text}': {fault}".replace("\n", " ")) from None
        return value if isinstance(value, pd.Series) else pd.Series(value, rows.index)

    def unit(self):
        """What it is measured in: of a time over a number, the time's."""
        units = {unit: power for unit, power in self.dimension(self.tree).items() if power}
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
            if left and not isinstance(node.right, ast.Constant):
                raise Refused(f"'{self.text}': the power of what has a unit must be a number")
            return {unit: power * node.right.value for unit, power in left.items()} if left else {}
        sign = -1 if isinstance(node.op, ast.Div) else 1
        if not isinstance(node.op, (ast.Mult, ast.Div)):
            return left
        return {unit: left.get(unit, 0) + sign * right.get(unit, 0) for unit in {**left, **right}}

    def titled(self):
        """In words, with the unit."""
        return self.label() + (f" ({self.unit()})" if self.unit() else "")

    def label(self, node=None, inside=False):
        """In words: "time per pair"."""
        node = node or self.tree
        if isinstance(node, ast.Name):
            return called(node.id, self.kind)
        if isinstance(node, ast.UnaryOp):
            return "−" + self.label(node.operand, True)
        if not isinstance(node, ast.BinOp):
            return f"{node.value:g}" if isinstance(node, ast.Constant) else self.text
        if isinstance(node.op, ast.Div) and isinstance(node.right, ast.Name) and node.right.id in ONE_OF:
            return f"{self.label(node.left, True)} per {ONE_OF[node.right.id]}"
        text = f"{self.label(node.left, True)} {SIGNS[type(node.op)]} {self.label(node.right, True)}"
        return f"({text})" if inside else text


class Floats(ast.NodeTransformer):
    """Whole numbers of an expression as floating ones."""

    def visit_Constant(self, node):
        return ast.Constant(float(node.value)) if type(node.value) is int else node
