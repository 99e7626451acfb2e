# SPDX-License-Identifier: BSD-3-Clause
"""plots/report: the page of records opens from a file, its tables sort, its search finds."""

import html
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path
from urllib.parse import unquote, urlsplit

from browser import ROOT, Browser, require_browser

COLUMN = "return [...document.querySelector('.table table').tBodies[0].rows].map(row => row.cells[arguments[0]].textContent)"


def record_of(name):
    return next(path.parent for path in sorted((ROOT / "experiments" / "record").glob("*/definition.toml"))
                if f'name = "{name}"' in path.read_text())


def setUpModule():
    require_browser()


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.out = Path(cls.temporary.name) / "report"
        done = subprocess.run([ROOT / "plots" / "report", record_of("talk"), record_of("boxes-fast"), "--out",
                               cls.out, "--no-scenes"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        cls.page = Path(done.stdout.strip())

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_opens_sorts_and_searches(self):
        with Browser() as browser:
            browser.open(self.page)
            self.assertEqual(browser.errors(), [])
            self.assertTrue(browser.wait_for("return [...document.images].slice(0, 1).every(i => i.naturalWidth > 100)"))
            self.assertEqual(browser.run("return document.querySelectorAll('.experiment').length"), 2)
            self.assertIn("best peer", browser.text(".says"))

            browser.click(".table summary")
            column = browser.run("return [...document.querySelector('.table table').tBodies[0].rows[0].cells]"
                                 ".findLastIndex(cell => cell.classList.contains('n'))")
            for direction in ("ascending", "descending"):
                browser.run("document.querySelector('.table table').querySelectorAll('th button')[arguments[0]].click()", column)
                shown = [float(x.replace(",", "")) for x in browser.run(COLUMN, column) if x]
                self.assertGreater(len(set(shown)), 1)
                self.assertEqual(shown, sorted(shown, reverse=direction == "descending"))
            browser.keep("report")

            browser.driver.find_element("id", "search").send_keys("separation-list")
            self.assertEqual(browser.run("return [...document.querySelectorAll('.experiment:not([hidden]) h2')]"
                                         ".map(h => h.textContent)"), ["talk"])

            light = browser.run("return getComputedStyle(document.body).backgroundColor")
            browser.click("#theme")
            self.assertNotEqual(browser.run("return getComputedStyle(document.body).backgroundColor"), light)
            self.assertEqual(browser.errors(), [])

    def test_narrow_pages_do_not_scroll_sideways(self):
        with Browser(width=390, height=844, dark=True) as browser:
            browser.open(self.page)
            self.assertEqual(browser.run("return document.documentElement.dataset.theme"), "dark")
            self.assertLessEqual(browser.run("return document.documentElement.scrollWidth - innerWidth"), 0)
            browser.keep("report-narrow")

    def test_needs_nothing_else(self):
        page = self.page.read_text()
        self.assertNotRegex(page, r'(src|href)="(https?:)?//')
        self.assertNotIn("<!--links-->", page)

    def test_links_of_any_name(self):
        name, out = "a,b %20#?&", Path(self.temporary.name) / "named"
        record = Path(self.temporary.name) / name
        shutil.copytree(record_of("talk"), record)
        figure = next((record / "figures").glob("*.png"))
        figure.rename(figure.with_name(f"{name}.png"))
        done = subprocess.run([ROOT / "plots" / "report", record, "--out", out, "--no-scenes"], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        links = re.findall(r' (?:href|src)="(figures/[^"]*)"', (out / "index.html").read_text())
        shown = [unquote(urlsplit(html.unescape(link)).path) for link in links]
        self.assertTrue(any(name in link for link in shown), links)
        for link in shown:
            self.assertTrue((out / link).is_file(), link)

    def test_an_unfinished_record_says_so(self):
        record, out = Path(self.temporary.name) / "broken-off", Path(self.temporary.name) / "unfinished"
        shutil.copytree(record_of("talk"), record)
        (record / "unfinished.json").write_text('{"what": "rows", "done": 0, "all": 9999}')
        subprocess.run([ROOT / "plots" / "report", record, "--out", out, "--no-scenes"], capture_output=True, check=True)
        self.assertRegex((out / "index.html").read_text(), r"Unfinished: \d+ of 9999 rows")
        self.assertNotIn("Unfinished", self.page.read_text())

    def test_refused(self):
        done = subprocess.run([ROOT / "plots" / "report", self.out, "--out", self.out], capture_output=True, text=True,
                              check=False)
        self.assertEqual((done.returncode, len(done.stderr.strip().splitlines())), (2, 1))
        self.assertIn("definition.toml", done.stderr)


if __name__ == "__main__":
    unittest.main()
