# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a record that is to be made: what plots/draw --check refuses, and on which line. (growing_test.py and
refusals_test.py ask by `bvlab run`.)"""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import pandas as pd
from small_records import PLOTS  # noqa: F401  finds bvlab_plots

from bvlab_plots import check

CELLS = "volume,strategy,seed,step,peer,frames,frame".split(",")
MEASURED = ("repetition,time_ns,first_ns,build_ns,pairs,hits,differing,n_u,n_v,n_p,front,node,alone,wall_per_processor,p99_ns,"
            "worst_ns").split(",")
COHERENT = ["kept", "entries"]


class Checks(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        cells = [("sphere", strategy, seed, "0.5leaf", "", "10", "body") for strategy in ("recursive", "deferred") for seed in (1, 2)]
        cells.append(("", "", 1, "0.5leaf", "fcl", "10", ""))
        rows = pd.DataFrame(cells, columns=CELLS).assign(**{name: "0" if name == "repetition" else "" for name in MEASURED + COHERENT})
        rows.to_csv(self.folder / "mine.csv", index=False)
        self.write_frames(["strategy", "frame", "n_v"], [("recursive", "", ""), ("deferred", "", "")])

    def write_frames(self, columns, rows=()):
        pd.DataFrame(rows, columns=columns).to_csv(self.folder / "mine.frames.csv", index=False)

    def said(self, text, path=None):
        (self.folder / "definition.toml").write_text(text)
        path, said = path or self.folder, io.StringIO()
        with contextlib.redirect_stderr(said):
            code = check.main(["--check", str(path)])
        self.assertEqual(code, 2 if said.getvalue() else 0)
        return said.getvalue().removeprefix(f"draw: {path}: ").strip()

    def figure(self, **keys):
        table = dict(name="a", x="strategy", y="n_v") | keys
        return 'name = "mine"\n[[figure]]\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in table.items())

    def test_what_can_be_drawn(self):
        for keys in ({}, dict(y="time_ns; n_v / pairs, n_p / pairs", series="variant"), dict(over="strategy=recursive"),
                     dict(over="best peer", peers="all"), dict(over="record=elsewhere"), dict(x="survival", series="strategy"),
                     dict(where=["peer=", "n_v > 1e9", "hits=3", "step=0.5leaf", "seed == 1"]), dict(table="frames", x="frame", series="strategy"),
                     dict(kind="ecdf", x="time_ns", series="variant"), dict(kind="box", x="variant", y="later_ns / later_pairs"),
                     dict(kind="stacked", y="time_ns / pairs"), dict(kind="map", x="seed", y="strategy", value="n_v", where=["frame=body"]),
                     dict(kind="scatter", x="n_v", y="n_p", fit="power", series="strategy"), dict(series="program", where=["program=other"])):
            with self.subTest(keys):
                self.assertEqual(self.said(self.figure(**keys)), "")

    def test_what_cannot(self):
        for keys, line, mention in (
                (dict(kind="pie"), 6, "unknown kind 'pie'"), (dict(x=""), 2, "figure 'a': needs an x"), (dict(x="frob"), 2, "x: no column 'frob'"),
                (dict(y="n_v +"), 2, "y: 'n_v +' is no expression"), (dict(y="n_v,"), 2, "an expression is missing"),
                (dict(y="n_v, time_ns"), 2, "same unit"), (dict(y="n_v; time_ns", panel_rows="seed"), 6, "panel_rows"),
                (dict(y="n_v + time_ns"), 2, "same unit"), (dict(kind="stacked"), 2, "is a time"), (dict(kind="scatter"), 2, "holds names"),
                (dict(kind="stacked", y="time_ns", series="seed"), 2, "neither series"), (dict(x="seed"), 2, "axis 'volume' is neither"),
                (dict(where=["strategy=frob"]), 2, "strategy has no 'frob'"), (dict(where=["seed > 'a'"]), 2, "'seed > 'a''"),
                (dict(over="strategy=frob"), 2, "over strategy=frob: strategy has no 'frob'"), (dict(over="frob"), 2, "over"),
                (dict(table="frames", x="seed"), 2, "no column 'seed'"), (dict(y="strategy"), 2, "holds names")):
            with self.subTest(keys):
                said = self.said(self.figure(**keys))
                self.assertTrue(said.startswith(f"line {line}: figure 'a': "), said)
                self.assertIn(mention, said)
                self.assertNotIn("\n", said)

    def test_lines(self):
        start = '# a comment\nname = "mine"\nlist = [\n  1,\n  2]\n\n'
        self.assertIn("line 7: figures are written", self.said(start + "figure = 3\n"))
        two = self.figure().removeprefix('name = "mine"\n')
        self.assertIn("line 11: figure 'a': a second figure", self.said(start + two + two))
        self.assertIn("line 11: figure 'a': where must be", self.said(start + two + "where = [\n  'a',\n  1]\n"))
        self.assertEqual(self.said(start + two + "where = [\n  'seed=1',\n]\n"), "")

    def test_of_a_study_columns_are_known_and_no_rows(self):
        pd.DataFrame(columns=["set", "test", "false_positives"]).to_csv(self.folder / "mine.csv", index=False)
        for keys, mention in ((dict(x="test", y="false_positives"), ""), (dict(x="tset", y="false_positives"), "no column 'tset'"),
                              (dict(x="test", y="false_positives", where=["set=new", "test != 'a'"]), "")):
            said = self.said(self.figure(**keys))
            self.assertEqual(bool(said), bool(mention), said)
            self.assertIn(mention, said)

    def test_of_a_definition_alone_keys_are_checked(self):
        path = self.folder / "definition.toml"
        self.assertEqual(self.said(self.figure(x="frob"), path), "")
        self.assertIn("line 5: figure 'a': y must be a string", self.said(self.figure(y=3), path))
        self.assertIn("No such file", self.said("", self.folder / "nowhere.toml"))


if __name__ == "__main__":
    unittest.main()
