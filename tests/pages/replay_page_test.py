# SPDX-License-Identifier: BSD-3-Clause
"""`bvlab replay ... --page`: the page opens from a file, draws, plays, and shows the volumes of a pair."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from browser import BVLAB, ROOT, Browser, require_browser

# How many pixels of the scene are drawn, and a number that another picture hardly has.
PICTURE = """
const canvas = document.getElementById('scene'), copy = document.createElement('canvas');
copy.width = canvas.width, copy.height = canvas.height;
const pen = copy.getContext('2d');
pen.drawImage(canvas, 0, 0);
const pixels = pen.getImageData(0, 0, copy.width, copy.height).data;
let drawn = 0, sum = 0;
for (let i = 0; i < pixels.length; i += 4) {
  drawn += pixels[i + 3] > 0;
  sum = (31 * sum + pixels[i] + 256 * pixels[i + 1] + 65536 * pixels[i + 2]) % 4294967291;
}
return [drawn / (copy.width * copy.height), sum];
"""


def run(*words):
    return subprocess.run([BVLAB, *map(str, words)], capture_output=True, text=True, check=False)


def setUpModule():
    require_browser()


class ReplayPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        done = run("scene", "random-walk", "--objects", 4, "--frames", 90, "--side", "1.5body", "--polygons", 200,
                   "--out", cls.folder / "trace.npy", "--meshes", cls.folder / "meshes")
        assert done.returncode == 0, done.stderr
        cls.mesh = next((cls.folder / "meshes").iterdir())

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def page(self, *words, trace="trace.npy"):
        page = self.folder / "page.html"
        done = run("replay", "--mesh", self.mesh, "--trace", self.folder / trace, "--page", page, "--json",
                   self.folder / "totals.json", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return page

    def picture(self, browser):
        browser.driver.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => "
                                            "requestAnimationFrame(() => done()));")
        drawn, number = browser.run(PICTURE)
        return drawn, number

    def test_says_that_it_was_made_without_three(self):
        """As where npm could not be reached."""
        page = self.page("--strategy", "separation-list")
        page.write_text(page.read_text().replace("var THREE=", "var other="))
        with Browser() as browser:
            browser.open(page)
            self.assertIn("without three.js", browser.text("#no-webgl"))
            browser.click("#play")
            self.assertTrue(browser.wait_for("return document.getElementById('frame').value >= 3"))
            self.assertEqual(browser.errors(), [])

    @unittest.skipUnless((ROOT / "build" / "viewers" / "three.min.js").exists(), "three.js could not be had from npm")
    def test_opens_plays_and_shows_volumes(self):
        with Browser() as browser:
            browser.open(self.page("--strategy", "separation-list"))
            self.assertEqual(browser.errors(), [])
            drawn, first = self.picture(browser)
            self.assertGreater(drawn, 0.02)

            self.assertEqual(browser.text("#frame-number"), "frame 0 of 90")
            browser.click("#play")
            self.assertTrue(browser.wait_for("return document.getElementById('frame').value >= 3"))
            browser.click("#play")
            self.assertNotEqual(self.picture(browser)[1], first)
            at = browser.text("#frame-number")
            self.picture(browser)
            self.assertEqual(browser.text("#frame-number"), at, "it goes on although it was paused")

            before = self.picture(browser)[1]
            browser.click("#pairs button")
            self.assertIn("level 2 of each body: 4 + 4 volumes (sphere)", browser.text("#volumes-drawn"))
            level = self.picture(browser)[1]
            self.assertNotEqual(level, before)
            browser.click("input[value='front']")
            self.assertRegex(browser.text("#volumes-drawn"), r"^nodes that the front stands on: \d+ \+ \d+ volumes")
            self.assertNotEqual(self.picture(browser)[1], level)
            browser.click("input[value='none']")
            self.assertNotIn(self.picture(browser)[1], (level, before))  # the pair still stands out
            browser.keep("replay-sphere")

            browser.run("document.querySelector('.curve canvas').scrollIntoView()")
            browser.click(".curve canvas")  # in its middle
            self.assertRegex(browser.text("#frame-number"), r"^frame 4\d of 90$")
            self.assertEqual(browser.errors(), [])

    def test_says_that_there_is_no_webgl(self):
        with Browser(more_options=["--disable-3d-apis"]) as browser:
            browser.open(self.page("--strategy", "separation-list"))
            self.assertIn("WebGL", browser.text("#no-webgl"))
            browser.click("#play")
            self.assertTrue(browser.wait_for("return document.getElementById('frame').value >= 3"))
            browser.click("#pairs button")
            self.assertEqual(browser.errors(), [])

    def test_says_what_the_program_says(self):
        page = self.page("--strategy", "separation-list", "--count", "on", "--out", self.folder / "touching.npy")
        touching = np.load(self.folder / "touching.npy")
        with Browser() as browser:
            browser.open(page)
            for frame in (0, 7, 89):
                browser.run("const f = document.getElementById('frame'); f.value = arguments[0]; "
                            "f.dispatchEvent(new Event('input'));", frame)
                marked = browser.run("return [...document.querySelectorAll('#pairs button')]"
                                     ".map(b => Number(b.classList.contains('touching')))")
                self.assertEqual(marked, touching[frame].tolist())
            counted = browser.run("return [0, 1, 2].map(k => data.series.reduce((s, x, i) => s + (i % 4 === k) * x, 0))")
        totals = json.loads((self.folder / "totals.json").read_text())
        self.assertEqual(counted, [totals["n_u"], totals["n_v"], totals["n_p"]])

    def test_fronts_cover_both_bodies(self):
        """Every leaf of either body lies below a node that the front stands on, in every frame, for strategies that
        keep, raise and rebuild it; and a strategy that keeps none is not offered one."""
        for strategy in ("separation-list", "raise", "margins"):
            with self.subTest(strategy), Browser() as browser:
                browser.open(self.page("--strategy", strategy))
                checked, bare = browser.run(COVERED)
                self.assertGreater(checked, 90)
                self.assertEqual(bare, 0)
        with Browser() as browser:
            browser.open(self.page("--strategy", "recursive"))
            self.assertTrue(browser.run("return document.querySelector('input[value=\"front\"]').disabled"))

    def test_volumes_of_every_shape_enclose_their_triangles(self):
        """What is drawn of the root, and of a k-DOP in the world, reaches as far as the mesh does."""
        compiled = {line.split()[0] for line in run("list", "volumes").stdout.splitlines() if line}
        for volume in ("sphere", "obb", "aabb", "kdop14", "kdop18", "kdop26", "rss", "shell", "slab-box"):
            if volume not in compiled:
                continue
            with self.subTest(volume), Browser() as browser:
                browser.open(self.page("--volume", volume, "--strategy", "separation-list"))
                browser.click("#pairs button")
                outside = browser.run(OUTSIDE)
                self.assertLess(outside, 1e-3)
                browser.keep(f"replay-{volume}")
                self.assertEqual(browser.errors(), [])

    def test_degenerate_traces(self):
        np.save(self.folder / "none.npy", np.zeros((0, 3, 7)))
        np.save(self.folder / "one.npy", np.array([[[0, 0, 0, 1, 0, 0, 0]]], float))
        for trace, words in (("none.npy", "no frames"), ("one.npy", "frame 0 of 1")):
            with self.subTest(trace), Browser(width=390, height=844, dark=True) as browser:
                browser.open(self.page(trace=trace))
                self.assertEqual(browser.text("#frame-number"), words)
                self.assertEqual(browser.errors(), [])

    def test_nine_bunnies_are_small(self):
        done = run("scene", "random-walk", "--side", "4body", "--out", self.folder / "nine.npy", "--meshes",
                   self.folder / "nine")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page("--strategy", "separation-list", trace="nine.npy")
        self.assertLess(page.stat().st_size, 10_000_000)
        self.assertNotIn("is shown", page.read_text())

    def test_a_long_trace_is_thinned_and_says_so(self):
        poses = np.zeros((30_000, 4, 7))
        poses[..., 0], poses[..., 3] = np.arange(4) * 10, 1
        np.save(self.folder / "long.npy", poses)
        page = self.page("--strategy", "separation-list", trace="long.npy")
        self.assertLess(page.stat().st_size, 10_000_000)
        with Browser() as browser:
            browser.open(page)
            self.assertIn("Of 30000 frames one in 2 is shown.", browser.text("#left-out"))

    def test_refused(self):
        refused = run("replay", "--mesh", self.mesh, "--trace", self.folder / "trace.npy", "--page",
                      self.folder / "missing" / "page.html")
        self.assertEqual((refused.returncode, len(refused.stderr.strip().splitlines())), (2, 1))
        self.assertIn("--page", refused.stderr)
        refused = run("replay", "--mesh", self.mesh, "--trace", self.folder / "trace.npy", "--budget", 5, "--page",
                      self.folder / "other.html")
        self.assertEqual(refused.returncode, 2)
        self.assertFalse((self.folder / "other.html").exists())


# Of how many fronts, and in how many of them a leaf of a body is below no node. An empty front is one not kept.
COVERED = """
let checked = 0, bare = 0;
for (const p of Object.keys(data.fronts)) {
  for (const front of data.front(Number(p))) {
    if (front.length === 0) continue;
    ++checked;
    for (const side of [0, 1]) {
      const { children } = data.meshOf(data.pairOf(Number(p))[side]);
      const nodes = new Set(front.filter(n => (n & 1) === side).map(n => n >> 1));
      const covered = n => nodes.has(n) || (children[n] > 0 && covered(children[n]) && covered(children[n] + 1));
      if (!covered(0)) ++bare;
    }
  }
}
return [checked, bare];
"""


# How far the mesh's extent along the world's axes is beyond that of the volume drawn around its root, at most,
# over the mesh's own; shapes are polygons within round volumes, which a fine grid hides.
OUTSIDE = """
const extent = numbers => {
  const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
  numbers.forEach((x, i) => { box[i % 3] = Math.min(box[i % 3], x); box[3 + i % 3] = Math.max(box[3 + i % 3], x); });
  return box;
};
const [c, s, d, t] = [Math.cos(0.7), Math.sin(0.7), Math.cos(0.4), Math.sin(0.4)], rows = volumes.realigned
  ? [[c, -s * d, s * t], [s, c * d, -c * t], [0, t, d]]
  : [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const { vertices } = data.meshes[0], moved = [];
for (let v = 0; v < vertices.length; v += 3)
  for (const row of rows) moved.push(row[0] * vertices[v] + row[1] * vertices[v + 1] + row[2] * vertices[v + 2]);
const mesh = extent(moved), root = extent([...volumes.shape(0, [0], rows).corners]);
let worst = 0;
for (let k = 0; k < 3; ++k)
  worst = Math.max(worst, (root[k] - mesh[k]) / (mesh[3 + k] - mesh[k]), (mesh[3 + k] - root[3 + k]) / (mesh[3 + k] - mesh[k]));
return worst;
"""


if __name__ == "__main__":
    unittest.main()
