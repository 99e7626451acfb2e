# SPDX-License-Identifier: BSD-3-Clause
"""Everything that bvlab refuses: exit 2 (1 for what is no fault of the caller's), one line that
names the file or the option, nothing on standard output, no file left behind."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

import numpy as np
from program import BVLAB, TETRAHEDRON, TRIANGLE, ProgramTest, names_of, poses, volumes_of, WIDE_KERNELS

METHOD = names_of("methods")[0]
NOT_NUMBERS = ("x", "1x", "0x10", "1.5", "1e1000000", "", "-0x1", "٣")


def boxes(frames=1, count=3):
    array = np.zeros((frames, count, 6))
    array[..., 3:] = 1
    return array


class Arrays(ProgramTest):
    """The three kinds of input array, each with everything that can be wrong with it."""

    def setUp(self):
        super().setUp()
        self.write("mesh.off", TETRAHEDRON)
        self.kinds = {
            "replay": (["--mesh", "mesh.off", "--trace"], poses(2, 3)),
            "boxes": (["--method", METHOD, "--trace"], boxes(2)),
            "triangles": (["--pairs"], np.ones((4, 18))),
        }

    def refuse_all(self, content, *mentions, kinds=("replay", "boxes", "triangles")):
        for kind in kinds:
            arguments, good = self.kinds[kind]
            data = content(good) if callable(content) else content
            if data is not None:
                self.write("in.npy", data)
            out = ["--out", "out.npy", "--json", "out.json"]
            self.refuse(kind, *arguments, "in.npy", *out, mentions=["in.npy: ", *mentions])

    def bytes_of(self, array):
        self.write("whole.npy", array)
        return (self.folder / "whole.npy").read_bytes()

    def test_missing(self):
        self.refuse_all(None, "No such file")

    def test_a_folder(self):
        (self.folder / "in.npy").mkdir()
        self.refuse_all(None, "is a directory")

    def test_a_device(self):
        for kind, (arguments, _) in self.kinds.items():
            for device in ("/dev/zero", "/dev/null"):
                given = [*arguments, device, "--out", "out.npy"]
                self.refuse(kind, *given, mentions=[device, "is a device"])

    def test_empty_and_foreign(self):
        self.refuse_all(b"", "not a .npy file")
        self.refuse_all(b"\x93NUMPY", "not a .npy file")
        self.refuse_all(TETRAHEDRON, "not a .npy file")

    def test_truncated_anywhere(self):
        for keep in (11, 60, 100, 127, 128, 136, -1):
            self.refuse_all(lambda good: self.bytes_of(good)[:keep], "truncated")

    def test_trailing_bytes(self):
        self.refuse_all(lambda good: self.bytes_of(good) + b"x", "trailing")

    def test_shape(self):
        self.refuse_all(lambda good: good.ravel(), "shape")
        self.refuse_all(lambda good: good[..., :-1], "shape")
        self.refuse_all(lambda good: good[None], "shape")
        self.refuse_all(np.ones(()), "shape ()")

    def test_type(self):
        for dtype in ("f2", "i4", "i8", ">f8", "c16", "?", "U3"):
            self.refuse_all(lambda good: good.astype(dtype), "holds", "needed")
        self.refuse_all(lambda good: good.astype("f4"), "holds", kinds=("replay", "triangles"))
        self.refuse_all(lambda good: good.astype("i4"), "'<f4' or '<f8' is needed", kinds=["boxes"])

    def test_order(self):
        self.refuse_all(lambda good: np.asfortranarray(good), "Fortran")

    def test_promises_of_the_header(self):
        def promised(shape):
            head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".encode()
            return lambda good: b"\x93NUMPY\1\0" + len(head).to_bytes(2, "little") + head

        for shape in ((2**62, 2**62, 7), (10**9, 1, 7)):
            self.refuse_all(promised(shape), "truncated", kinds=["replay"])
        for shape in ((2**62, 2**62, 6), (10**9, 1, 6)):
            self.refuse_all(promised(shape), "truncated", kinds=["boxes"])
        self.refuse_all(promised((2**60, 18)), "truncated", kinds=["triangles"])
        self.refuse_all(promised((0, 2**40, 7)), "32 bits", kinds=["replay"])
        self.refuse_all(promised((2**40, 0, 7)), "32 bits", kinds=["replay"])
        self.refuse_all(promised("(99999999999999999999999, 7)"), "malformed")
        self.refuse_all(promised("(-1, 2, 7)"), "malformed")

    def test_not_finite(self):
        for value, word in ((np.nan, "NaN"), (np.inf, "infinit"), (-np.inf, "infinit")):
            for place in (0, 3, 5, -1):
                def spoiled(good):
                    good = good.copy()
                    good.reshape(-1)[place] = value
                    return good

                self.refuse_all(spoiled, word, kinds=("boxes", "triangles"))
                self.refuse_all(spoiled, "not a finite number in frame", kinds=["replay"])

    def test_zero_quaternion(self):
        for zero in (0.0, -0.0):
            trace = poses(3, 2)
            trace[1, 1, 3:] = zero
            self.refuse_all(trace, "zero quaternion in frame 1, object 1", kinds=["replay"])

    def test_upside_down_box(self):
        for dtype in ("f4", "f8"):
            trace = boxes(2).astype(dtype)
            trace[1, 2, 4] = -1
            self.refuse_all(trace, "frame 1, box 2: lo > hi", kinds=["boxes"])


class Meshes(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("poses.npy", poses(2, 3))

    def refuse_mesh(self, name, content, *mentions):
        self.write(name, content)
        rest = ["--trace", "poses.npy", "--out", "out.npy", "--json", "out.json"]
        self.refuse("replay", "--mesh", name, *rest, mentions=[name, *mentions])
        rest = ["--out", "out.npy", "--meshes", "meshes"]
        self.refuse("scene", "random-walk", "--mesh", name, *rest, mentions=[name, *mentions])

    def test_missing(self):
        rest = ["--trace", "poses.npy", "--out", "out.npy"]
        self.refuse("replay", "--mesh", "none.off", *rest, mentions="none.off: No such file")
        self.write("good.off", TRIANGLE)
        self.refuse("replay", "--mesh", "good.off", "--mesh", "none.glb", *rest, mentions="none.glb")

    def test_a_folder(self):
        (self.folder / "folder.off").mkdir()
        rest = ["--trace", "poses.npy", "--out", "out.npy"]
        self.refuse("replay", "--mesh", "folder.off", *rest, mentions="folder.off: is a directory")

    def test_every_format(self):
        for extension in ("off", "obj", "ply", "stl", "gltf", "glb", "wrl", "3ds", "dae", "xyz", ""):
            name = f"bad.{extension}" if extension else "bad"
            self.refuse_mesh(name, b"", "is empty")
            self.refuse_mesh(name, b"\n")
            self.refuse_mesh(name, b"nonsense\n" * 3)
            self.refuse_mesh(name, bytes(range(256)) * 4)

    def test_truncated(self):
        for length in (3, 8, 20, 35, 60):
            self.refuse_mesh("cut.off", TETRAHEDRON[:length])

    def test_without_triangles(self):
        self.refuse_mesh("points.off", "OFF\n2 0 0\n0 0 0\n1 1 1\n", "no triangles")
        self.refuse_mesh("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "no triangles")
        self.refuse_mesh("line.off", "OFF\n2 1 0\n0 0 0\n1 1 1\n2 0 1\n", "no triangles")
        self.refuse_mesh("none.stl", "solid\nendsolid\n", "no triangles")

    def test_index_out_of_range(self):
        for index in ("4", "-1", "4294967296", "99999999999999999999"):
            self.refuse_mesh("far.off", TETRAHEDRON.replace("2 1\n", f"2 {index}\n"), "line 7")
        for index in ("0", "4", "-4", "4294967297"):
            self.refuse_mesh("far.obj", f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n", "line 4")

    def test_not_finite(self):
        for value in ("nan", "inf", "-inf", "1e999", "-1e999"):
            self.refuse_mesh("odd.off", TRIANGLE.replace("1 0 0", f"1 {value} 0"), "line 4")
            self.refuse_mesh("odd.obj", f"v 0 0 0\nv 1 0 {value}\nv 0 1 0\nf 1 2 3\n", "line 2")

    def test_too_small(self):
        for value in ("1e-400", "-2e-324"):
            self.refuse_mesh("odd.off", TRIANGLE.replace("1 0 0", f"1 {value} 0"), "line 4")
            self.refuse_mesh("odd.obj", f"v 0 0 0\nv 1 0 {value}\nv 0 1 0\nf 1 2 3\n", "line 2")

    def test_overflow_by_a_pose(self):
        """Coordinates and poses are finite; what a vertex becomes is not."""
        self.write("large.off", TRIANGLE.replace("1 0 0", "1.5e308 0 0"))
        self.write("mesh.off", TETRAHEDRON)
        trace = poses(3, 4)
        trace[2, 3, 0] = 1.5e308
        self.write("poses.npy", trace)
        for query in ("touching", "contacts", "distance"):
            self.refuse("replay", "--mesh", "mesh.off", "--mesh", "large.off", "--trace",
                        "poses.npy", "--query", query, "--out", "out.npy",
                        mentions=["poses.npy: ", "frame 2, object 3"])


class Names(ProgramTest):
    """An unknown name is answered with those there are."""

    def setUp(self):
        super().setUp()
        self.write("mesh.off", TETRAHEDRON)
        self.write("poses.npy", poses(2, 3))
        self.write("boxes.npy", boxes())
        self.write("pairs.npy", np.ones((1, 18)))
        self.replay = ["replay", "--mesh", "mesh.off", "--trace", "poses.npy", "--out", "out.npy"]

    def test_of_replay(self):
        kinds = {"volume": "volumes", "strategy": "strategies", "query": "queries",
                 "precision": "precisions", "build": "builds"}
        for option, kind in kinds.items():
            for name in ("frob", "", names_of(kind)[0] + "x"):
                given = ["--" + option, name]
                self.refuse(*self.replay, *given, mentions=["--" + option, *names_of(kind)])
        for value in ("deferred:-1", "deferred:x", "deferred:", "deferred:99999999999", "deferred:1:1"):
            self.refuse(*self.replay, "--strategy", value, mentions=["--strategy", value])
        self.refuse(*self.replay, "--strategy", "recursive:1", mentions="takes no parameter")
        self.refuse(*self.replay, "--configuration", "frob",
                    mentions=["--configuration", *names_of("configurations")])
        self.refuse(*self.replay, "--configuration", "", mentions=names_of("configurations"))
        self.refuse(*self.replay, "--frame", "frob", mentions=["--frame", *names_of("frames")])
        self.refuse(*self.replay, "--kernel", "frob", mentions=["--kernel", *names_of("kernels")])
        for value in ("3", "0", "32", "-2", "x", ""):
            self.refuse(*self.replay, "--fan-out", value, mentions="--fan-out")
        self.refuse(*self.replay, "--count", "maybe", mentions=["--count", "on", "off"])

    def test_of_wide_kernels(self):
        for kernel in WIDE_KERNELS:
            for volume in volumes_of(kernel):
                wide = [*self.replay, "--kernel", kernel, "--volume", volume]
                for strategy in ("recursive:1", "margins:1", "deferred:x", "frob", ""):
                    self.refuse(*wide, "--strategy", strategy, mentions=["--strategy", strategy])
                self.refuse(*wide, "--query", "frob", mentions=["--query", *names_of("queries")])
                self.refuse(*wide, "--frame", "frob", mentions=["--frame frob", "world", "body"])
                self.refuse(*wide, "--fan-out", "3", mentions=["--fan-out"])
                self.refuse(*wide, "--budget", "10", mentions=["--budget", kernel])
            for volume in (*(set(names_of("volumes")) - set(volumes_of(kernel))), "frob", ""):
                self.refuse(*self.replay, "--kernel", kernel, "--volume", volume,
                            mentions=["--volume " + volume, *volumes_of(kernel)])

    def test_of_configurations(self):
        for configuration in (["--recommended"], ["--configuration", "as-published"]):
            for part in (["--volume", "obb"], ["--fan-out", "4"], ["--frame", "body"], ["--kernel", "siblings"],
                         ["--strategy", "recursive"],
                         ["--build", "bottom-up"], ["--fit", "tight"], ["--leaf-size", "2"]):
                self.refuse(*self.replay, *configuration, *part, mentions=[configuration[0], part[0]])
        self.refuse(*self.replay, "--recommended", "--configuration", "as-published",
                    mentions=["--recommended", "--configuration"])

    def test_of_configurations_in_their_own_words(self):
        self.refuse(*self.replay, "--recommended", "--page", "page.html", mentions=["--page", "--configuration recommended"])
        self.refuse(*self.replay, "--recommended", "--budget", "10", mentions=["--budget", "--configuration recommended"])
        self.refuse(*self.replay, "--kernel", "siblings", "--volume", names_of("volumes")[0], "--page", "page.html",
                    mentions=["--page", "--kernel siblings"])
        self.refuse(*self.replay, "--fan-out", "8", "--page", "page.html", mentions=["--page", "--fan-out 8"])

    def test_of_a_budget(self):
        for value in ("-1", "x", "1.5", ""):
            self.refuse(*self.replay, "--budget", value, mentions="--budget")
        budget = [*self.replay, "--budget", "10"]
        self.refuse(*budget, "--query", "distance", mentions=["--budget", "distance"])
        self.refuse(*budget, "--query", "contacts", mentions=["--budget", "contacts"])
        self.refuse(*budget, "--strategy", "deferred", mentions=["--budget", "deferred"])
        self.refuse(*budget, "--threads", "2", mentions=["--budget", "thread"])
        self.refuse(*budget, "--volume", "frob", mentions=["--volume", *names_of("volumes")])

    def test_of_the_other_commands(self):
        rest = ["--out", "out.npy"]
        given = ["boxes", "--trace", "boxes.npy", "--method", "frob"]
        self.refuse(*given, *rest, mentions=["--method", *names_of("methods")])
        given = ["boxes", "--trace", "boxes.npy", "--coherent", "maybe"]
        self.refuse(*given, *rest, mentions=["--coherent", "on", "off"])
        given = ["triangles", "--pairs", "pairs.npy", "--precision", "frob"]
        self.refuse(*given, *rest, mentions=["--precision", *names_of("precisions")])
        self.refuse("scene", "frob", *rest, mentions=["frob", *names_of("scenes")])
        given = ["scene", "random-walk", "--shape", "frob"]
        self.refuse(*given, *rest, mentions=["frob", "bunny", *names_of("meshes")])
        given = ["scene", "random-walk", "--shape", "box", "--freedoms", "frob"]
        self.refuse(*given, *rest, mentions=["freedoms", "one", "all"])
        given = ["scene", "random-walk", "--shape", "box", "--contact", "frob"]
        self.refuse(*given, *rest, mentions=["contact", "pass", "reject"])
        kinds = ["volumes", "strategies", "queries", "methods", "scenes", "precisions"]
        self.refuse("list", "frob", mentions=["frob", *kinds])

    def test_of_commands(self):
        commands = ["replay", "boxes", "triangles", "run", "scene", "list"]
        self.refuse(mentions=commands)
        self.refuse("frob", mentions=["frob", *commands])
        self.refuse("--frob", mentions=["--frob"])

    def test_of_options(self):
        self.refuse(*self.replay, "--frob", mentions="--frob")
        self.refuse(*self.replay, "frob", mentions="frob")
        self.refuse("scene", "random-walk", "--out", "out.npy", "--frob", mentions="--frob")
        self.refuse("boxes", "--trace", "boxes.npy", "--frob=1", mentions="--frob")
        self.refuse("replay", "--mesh", "mesh.off", mentions="--trace")
        self.refuse("replay", "--trace", "poses.npy", mentions="--mesh")
        self.refuse("boxes", mentions="--trace")
        self.refuse("triangles", mentions="--pairs")
        self.refuse("scene", mentions=names_of("scenes"))
        self.refuse("scene", "random-walk", mentions="--out")
        self.refuse("run", mentions="definition")
        self.refuse(*self.replay, "--volume", mentions="--volume")

    def test_of_empty_values(self):
        for option in ("--out", "--json", "--page"):
            self.refuse(*self.replay, option, "", mentions=[option, "a value is needed"])
        self.refuse("predict", "poses.npy", "--mesh", "mesh.off", "--csv", "", mentions="--csv")
        self.refuse("scene", "random-walk", "--out", "out.npy", "--meshes", "", mentions="--meshes")
        for option in ("--record", "--part"):
            self.refuse("run", "none.toml", option, "", mentions=[option, "a value is needed"])
        self.refuse("list", "", mentions="a value is needed")

    def test_on_one_line_whatever_is_quoted(self):
        self.refuse("triangles", "--pairs", "a\nb\r\x1b[31m", mentions="a?b??[31m: No such file")
        self.refuse("list", "a\nb", mentions="a?b")


class Pages(ProgramTest):
    def test_the_page_of_parameters_is_what_the_program_lists(self):
        source = pathlib.Path(__file__).resolve().parents[3]
        page = (source / "experiments/definitions/README.md").read_text()
        listed = self.run_bvlab("list", "parameters").stdout
        self.assertIn("```\n" + listed + "```", page)


class Values(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("mesh.off", TETRAHEDRON)
        self.write("poses.npy", poses(2, 3))
        self.write("boxes.npy", boxes())
        self.replay = ["replay", "--mesh", "mesh.off", "--trace", "poses.npy", "--out", "out.npy"]

    def test_a_fit_that_a_volume_has_not(self):
        for volume in names_of("volumes"):
            if volume in ("sphere", "aabb") or volume.startswith("kdop"):
                self.refuse(*self.replay, "--volume", volume, "--fit", "tight", mentions=["--fit tight", volume])
                self.refuse("predict", "--mesh", "mesh.off", "--trace", "poses.npy", "--volume", volume, "--fit", "tight", mentions=["--fit tight", volume])

    def test_whole_numbers(self):
        wrong = ("0", "-1", "-4294967295", "-18446744073709551615", *NOT_NUMBERS)
        scene = ["scene", "random-walk", "--mesh", "mesh.off", "--out", "out.npy"]
        for value in wrong:
            self.refuse(*self.replay, f"--threads={value}", mentions="--threads")
            self.refuse(*self.replay, f"--leaf-size={value}", mentions="--leaf-size")
            given = ["boxes", "--trace", "boxes.npy", "--out", "out.npy"]
            self.refuse(*given, f"--threads={value}", mentions="--threads")
            if value == "0":
                continue
            for option in ("objects", "frames", "moving", "seed", "polygons"):
                self.refuse(*scene, f"--{option}={value}", mentions="--" + option)
        for value in ("-1", "-0.001", "nan", "inf", "x", "", "1e999"):
            given = ["--query=distance", f"--relative-error={value}"]
            self.refuse(*self.replay, *given, mentions="--relative-error")
        self.refuse(*self.replay, "--threads=1000000", mentions="--threads")
        self.refuse(*self.replay, "--leaf-size=1000000", mentions="--leaf-size")
        self.refuse(*self.replay, "--fit=loose", mentions="published, tight")

    def test_of_scenes(self):
        scene = ["scene", "random-walk", "--mesh", "mesh.off", "--out", "out.npy", "--frames", "3"]
        for option in ("side", "step"):
            for value in ("-1", "-1leaf", "nan", "inf", "x", "", "1 mile", "1e999", "1leafs"):
                self.refuse(*scene, f"--{option}={value}", mentions="--" + option)
        self.refuse(*scene, "--side=1", "--step=2", mentions="step")
        for value in ("-1", "181", "nan", "inf", "x", ""):
            self.refuse(*scene, f"--degrees={value}", mentions="degrees")
        for option in ("persistence", "teleport"):
            for value in ("-0.1", "1.1", "nan", "inf", "x", ""):
                self.refuse(*scene, f"--{option}={value}", mentions=option)
        self.refuse(*scene, "--objects=2", "--moving=3", mentions="moving: 3 of 2 bodies")
        self.refuse(*scene, f"--objects={2**34}", mentions="objects")
        self.refuse(*scene, "--frames=18446744073709551615", mentions="frames")
        self.refuse(*scene, "--side=0", "--step=0", "--contact=reject", mentions="side: no room")
        crowd = ["scene", "random-walk", "--shape=icosphere", "--out=out.npy"]
        self.refuse(*crowd, "--polygons=0", mentions="0 polygons")


class Definitions(ProgramTest):
    START = 'name = "small"\n[parameters]\nmesh = "box"\npolygons = 12\nobjects = 2\nframes = 3\n'

    def refuse_definition(self, content, *mentions):
        self.write("bad.toml", content)
        mentions = ["bad.toml: ", *mentions]
        return self.refuse("run", "bad.toml", "--record", "record", mentions=mentions)

    def test_files(self):
        self.refuse("run", "none.toml", "--record", "record", mentions="none.toml: No such file")
        (self.folder / "folder.toml").mkdir()
        self.refuse("run", "folder.toml", "--record", "record", mentions="folder.toml: is a dir")
        self.refuse_definition("", "name")
        self.refuse_definition(bytes(range(256)))
        self.refuse_definition("name = 'x'\nname = 'y'\n", "line 2")
        self.refuse_definition("name = \n", "line 1")
        self.refuse_definition("[[[[\n", "line 1")

    def test_keys(self):
        self.refuse_definition(self.START + "frob = 1\n", "line 7", "frob", "mesh", "polygons")
        self.refuse_definition("frob = 1\n" + self.START, "line 1", "frob")
        self.refuse_definition("description = 'no name'\n", "name")
        self.refuse_definition("name = 'a/b'\n", "name")
        self.refuse_definition("name = 3\n", "line 1", "string")
        self.refuse_definition('name = "a\\u0000b"\n', "line 1", "control character")
        self.refuse_definition(f"name = '{'x' * 300}'\n", "longer than")
        for value in ("0", "-1", "1.5", "'three'", "100000"):
            self.refuse_definition(f"repetitions = {value}\n" + self.START, "line 1", "repetitions")
        self.refuse_definition("name = 'x'\nparameters = 3\n", "line 2", "table")
        self.refuse_definition(self.START + "seed = [1]\n", "line 7", "seed")
        self.refuse_definition(self.START + "[series]\nfrob = 1\n", "series", "frob", "seed")

    def test_studies(self):
        start = "name = 'x'\nkind = 'triangles'\n"
        self.refuse_definition("name = 'x'\nkind = 'frob'\n", "frob", "triangles", "stability")
        self.refuse_definition("kind = 'triangles'\n", "name")
        self.refuse_definition(start + "frob = 1\n", "line 3", "frob")
        self.refuse_definition(start + "parameters = 1\n", "line 3", "table")
        self.refuse_definition(start + "repetitions = 0\n", "line 3", "repetitions")
        self.refuse_definition(start + "[parameters]\nfrob = 1\n", "frob", "pairs", "sets")
        self.refuse_definition(start + "[parameters]\npairs = 'x'\n", "pairs", "x")
        self.refuse_definition(start + "[parameters]\npairs = [1, 2]\n", "pairs", "one number")
        self.refuse_definition(start + "[parameters]\npairs = 0\n", "pairs", "whole number")
        self.refuse_definition(start + "[parameters]\nsets = ['frob']\n", "frob", "integer grid")
        for kind in ("stability", "distance"):
            given = f"name = 'x'\nkind = '{kind}'\n[parameters]\nframes = -1\n"
            self.refuse_definition(given, "frames", "whole number")
        given = "name = 'x'\nkind = 'distance'\n[parameters]\nstrategies = 'frob'\n"
        self.refuse_definition(given, "frob", *names_of("strategies"))

    def test_parameters_of_studies(self):
        """Of each kind by the table that the program lists: what is no such value is refused by name."""
        lines = self.run_bvlab("list", "study-parameters").stdout.splitlines()
        defaults: dict = {}
        for line in lines:
            kind, name, what, several, more = re.fullmatch(
                r"([a-z-]+)\.(\w+) +.*: (word|number|whole number)(s?)((?:, .*)?(?: \[.*\])?)", line).groups()
            start = f"name = 'x'\nkind = '{kind}'\n[parameters]\n{name} = "
            bad = {"word": [], "number": ["'x'", "nan", "inf"], "whole number": ["'x'", "nan", "1.5", "-1", "1e300"]}[what]
            if ", of " in more:
                bad.append("'frob'")
            if not several:
                bad.append("[1, 1]")
            elif " [" in more:
                bad.append("[]")
            for value in bad:
                with self.subTest(kind=kind, name=name, value=value):
                    self.refuse_definition(start + value + "\n", f"bad.toml: {name}")
            default = re.search(r" \[(.*)\]$", more)
            if default and default[1] != "all":
                values = [repr(each) if what == "word" else each for each in default[1].split(", ")]
                defaults.setdefault(kind, []).append(f"{name} = " + (f"[{', '.join(values)}]" if several else values[0]))
        self.assertEqual(sorted({line.split(".")[0] for line in lines}), sorted(names_of("studies")))
        # Written out they are taken: what is refused is the figure.
        for kind, written in defaults.items():
            with self.subTest(kind=kind):
                self.refuse_definition(f"name = 'x'\nkind = '{kind}'\n[parameters]\n" + "\n".join(written)
                                       + "\n[[figure]]\nname = 'f'\nx = 'frob'\ny = 'frob'\n", "figure", "frob")

    def test_axes(self):
        def axis(text):
            return self.START + "[[axis]]\n" + text

        self.refuse_definition(self.START + "[axis]\nname = 'seed'\n", "[[axis]]")
        self.refuse_definition(axis("values = [1]\n"), "line 7", "name")
        self.refuse_definition(axis("name = 'seed'\n"), "line 7", "values")
        self.refuse_definition(axis("name = 'seed'\nvalues = []\n"), "seed", "no values")
        self.refuse_definition(axis("name = 'seed'\nvalues = [[1]]\n"), "line 9", "seed")
        for meshes, mention in (("[[]]", "the list is empty"), ("[['a.off', 3]]", "a mesh in a list must be a string"),
                                ("[['a.off,b.off']]", "without commas"), ("[['a.off', ' ']]", "one mesh"),
                                ("[['a.off', 'b.off'], 'a.off,b.off']", "twice")):
            self.refuse_definition(axis(f"name = 'mesh'\nvalues = {meshes}\n"), "line 9", mention)
        self.refuse_definition(axis("name = 'frob'\nvalues = [1]\n"), "line 8", "frob", "seed")
        self.refuse_definition(axis("name = 'seed'\nvalues = [1, 1]\n"), "line 9", "seed", "twice")
        self.refuse_definition(axis("name = 'seed'\nvalues = [1]\n") + "[[axis]]\nname = 'seed'\n"
                               "values = [2]\n", "seed")
        self.refuse_definition(axis("name = 'way'\n[[axis.value]]\nmoving = 1\n"), "line 9", "name")
        self.refuse_definition(axis("name = 'seed'\n[[axis.value]]\nname = 'a'\n"), "seed", "values")
        way = "name = 'way'\n[[axis.value]]\nname = 'a'\nseed = 1\n"
        for other in ("name = 'seed'\nvalues = [2]\n", way.replace("'way'", "'road'")):
            self.refuse_definition(axis(way) + "[[axis]]\n" + other, "line 12", "sets 'seed'", "'way'")
        for name in ("time_ns", "differing", "repetition", "pairs", "kept", "n_v", "later_ns", "later_pairs", "survival"):
            self.refuse_definition(axis(way.replace("way", name)), f"axis '{name}'", "a column of that name")
        self.refuse_definition(axis(way.replace("way", "")), "line 8", "name is empty")
        self.refuse_definition(axis(way.replace("'way'", '"a\\nb"')), "line 8", "control character")

    def test_beside_a_configuration(self):
        """What a configuration sets is refused where it would be ignored in every cell."""
        def axis(name, *values):
            return f"[[axis]]\nname = '{name}'\nvalues = {list(values)}\n"

        def way(*values):
            return "[[axis]]\nname = 'way'\n" + "".join(f"[[axis.value]]\nname = 'w{k}'\n{each}" for k, each in enumerate(values))

        recommended, chosen = self.START + "configuration = 'recommended'\n", "configuration = 'recommended'\n"
        strategies = axis("strategy", "recursive", "deferred")
        for text, name in ((recommended + "volume = 'obb'\n", "volume"), (recommended + strategies, "strategy"),
                           (self.START + way(chosen + "leaf_size = 2\n"), "leaf_size"),
                           (self.START + axis("configuration", "recommended", "as-published") + strategies, "strategy"),
                           (self.START + "volume = 'obb'\n" + way(chosen), "volume"),
                           (self.START + "leaf_size = 2\n" + way(chosen, "leaf_size = 4\n"), "leaf_size")):
            self.refuse_definition(text, f"{name}: is set by the configuration, too")
        for k, text in enumerate((self.START + "leaf_size = 2\n" + way(chosen, ""), self.START + way(chosen, "leaf_size = 4\n"),
                                  recommended + way("configuration = ''\n", "") + strategies)):
            self.write("good.toml", text)
            self.take("run", "good.toml", "--record", f"record{k}")

    def test_figures(self):
        for start, line in (("name = 'x'\n", 2), ("name = 'x'\nkind = 'triangles'\n", 3)):
            def refuse(text, *mentions):
                self.refuse_definition(start + text, *mentions)

            good = "[[figure]]\nname = 'a'\nx = 'seed'\n"
            refuse("figure = 3\n", f"line {line}", "[[figure]]")
            refuse("[figure]\nname = 'a'\n", "[[figure]]")
            refuse("[[figure]]\nx = 'seed'\n", f"line {line}", "name")
            refuse("[[figure]]\nname = 'a'\n", f"line {line}", "an x")
            refuse("[[figure]]\nname = 'a/b'\nx = 'seed'\n", f"line {line + 1}", "'/'")
            refuse(good + "frob = 1\n", f"line {line + 3}", "frob", "panels", "where")
            refuse(good + "y = 1\n", f"line {line + 3}", "y", "string")
            refuse(good + "kind = 'frob'\n", f"line {line + 3}", "frob", "line, bars, map")
            refuse(good + "kind = 'map'\n", f"line {line}", "'a'", "needs a y")
            refuse(good + "log = 'z'\n", f"line {line + 3}", "none, x, y, xy")
            refuse(good + "where = 'a=b'\n", f"line {line + 3}", "list of strings")
            refuse(good + "where = [1]\n", f"line {line + 3}", "list of strings")
            refuse(good + good, f"line {line + 3}", "second", "'a'")
        for text in ("time_ns /", "* 2", "(time_ns", "time_ns)", "time_ns n_v", "time_ns ? 2", "not", "seed = 1 and",
                     "time_ns in n_v", "1.2.3", "-not n_v", "True"):
            self.refuse_definition(self.START + "[[figure]]\nname = 'a'\nx = 'seed'\n" + f"y = '{text}'\n", "line 7", "'a'", "y", text)
            self.refuse_definition(self.START + "[[figure]]\nname = 'a'\nx = 'seed'\n" + f"where = ['n_v < {text}']\n", "line 7", "'a'")
        self.refuse_definition(self.START + "[[figure]]\nname = 'a'\nx = 'seed'\ny = 'n_v,,'\n", "line 7", "an expression is missing")

    def test_names_and_numbers(self):
        kinds = {"scene": "scenes", "volume": "volumes", "strategy": "strategies",
                 "query": "queries", "build": "builds", "precision": "precisions", "peer": "peers",
                 "frame": "frames", "kernel": "kernels", "configuration": "configurations"}
        for parameter, kind in kinds.items():
            self.refuse_definition(self.START + f"{parameter} = 'frob'\n", "frob", *names_of(kind))
            self.refuse_definition(self.START + f"[[axis]]\nname = '{parameter}'\n"
                                   f"values = ['{names_of(kind)[0]}', 'frob']\n", "frob")
        for parameter in ("seed", "moving", "leaf_size"):
            for value in ("-1", "1.5", "'x'", "99999999999999999999999.0", "''"):
                self.refuse_definition(self.START + f"{parameter} = {value}\n", parameter)
        for value in ("-1", "'1 mile'", "nan", "inf"):
            self.refuse_definition(self.START + f"step = {value}\n", "step")
        for value in ("0", "100000"):
            self.refuse_definition(self.START + f"leaf_size = {value}\n", "leaf-size")
        # "native" is a word for fan_out alone; an empty name is none.
        self.refuse_definition(self.START + 'leaf_size = "native"\n', "leaf_size = native")
        self.refuse_definition(self.START + 'volume = ""\n', "--volume")
        for value in ("-1", "nan", "inf", "'x'"):
            self.refuse_definition(self.START + f"relative_error = {value}\n", "relative")
        for value in ("-1", "200", "nan"):
            self.refuse_definition(self.START + f"degrees = {value}\n", "degrees")
        self.refuse_definition(self.START + "moving = 3\n", "moving")
        for parameter in ("turns", "core", "wobble", "fall"):  # of scenes that are not asked for
            self.refuse_definition(self.START + f"{parameter} = 'x'\n", parameter, "x")

    def test_billions_of_cells(self):
        numbers = ", ".join(map(str, range(100)))
        text = self.START
        for name in ("seed", "moving", "degrees", "leaf_size", "persistence", "teleport"):
            text += f"[[axis]]\nname = '{name}'\nvalues = [{numbers}]\n"
        self.refuse_definition(text, "cells", "degrees")

    def test_tables_in_tables(self):
        self.refuse_definition("name = 'deep'\n" + "a." * 100000 + "a = 1\n", "line 2", "dots")
        self.refuse_definition("name = 'deep'\nparameters = " + "[" * 100000 + "\n", "line 2")
        self.refuse_definition("name = 'deep'\nparameters = " + "{a=" * 100000 + "\n", "line 2")

    def test_records(self):
        self.write("good.toml", self.START)
        self.write("record", "a file")
        self.refuse("run", "good.toml", "--record", "record", mentions="record")
        self.write("other/definition.toml", "name = 'other'\n")
        self.refuse("run", "good.toml", "--record", "other", mentions="another definition")
        self.take("run", "good.toml", "--record", "kept")
        self.write("kept/small.csv", "seed,frob\n1,2\n")
        self.refuse("run", "good.toml", "--record", "kept", mentions="small.csv: has other columns")

    def test_a_refused_run_is_begun_again(self):
        """What it left in its record is no reason to refuse the definition once it is mended."""
        self.write("mine.toml", self.START.replace('"box"', '"none.off"'))
        done = self.run_bvlab("run", "mine.toml", "--record", "record")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.write("mine.toml", self.START)
        self.assertFalse((self.folder / "record").exists())
        self.write("mine.toml", "repetitions = 2\n" + self.START)
        self.take("run", "mine.toml", "--record", "record", "--counts")
        (self.folder / "record/small.csv").unlink()
        self.write("record/unfinished.json", '{"what": "rows", "done": 0, "all": 1}\n')
        self.write("mine.toml", self.START)
        self.take("run", "mine.toml", "--record", "record")
        self.assertEqual((self.folder / "record/definition.toml").read_text(), self.START)
        self.write("mine.toml", self.START + "seed = 2\n")
        self.refuse("run", "mine.toml", "--record", "record", mentions="another definition")

    def test_rows_that_bvlab_did_not_write(self):
        self.write("good.toml", "repetitions = 2\n" + self.START + "[[axis]]\nname = 'seed'\nvalues = [1, 2]\n")
        self.take("run", "good.toml", "--record", "record")
        table = self.folder / "record/small.csv"
        whole = table.read_text()
        lines = whole.splitlines(keepends=True)
        for text, said in ((whole[:-10], "is cut off"), (whole + '"', "is cut off"),
                           (whole + lines[-1], "row 5 is a second one of its cell and repetition"),
                           (whole.replace(",sphere,", ",cube,"), "row 1 is of no cell"),
                           (lines[0] + "1,2\n", "line 2 has 2 fields")):
            table.write_text(text)
            self.refuse("run", "good.toml", "--record", "record", mentions=["record/small.csv: ", said])


class Places(ProgramTest):
    """Results that cannot be written."""

    def setUp(self):
        super().setUp()
        self.write("mesh.off", TETRAHEDRON)
        self.write("poses.npy", poses(200, 9))
        self.write("boxes.npy", boxes(300, 50))
        self.write("pairs.npy", np.ones((100000, 18)))
        self.commands = [
            ["replay", "--mesh", "mesh.off", "--trace", "poses.npy", "--query", "contacts"],
            ["boxes", "--trace", "boxes.npy", "--method", METHOD],
            ["triangles", "--pairs", "pairs.npy"],
        ]
        self.scene = ["scene", "random-walk", "--mesh", "mesh.off"]

    def test_missing_folder(self):
        for command in self.commands:
            self.refuse(*command, "--out", "none/out.npy", mentions=["--out", "none/out.npy"])
            given = ["--out", "out.npy", "--json", "none/out.json"]
            self.refuse(*command, *given, mentions=["--json", "none/out.json"])
        self.refuse(*self.scene, "--out", "none/out.npy", mentions=["--out", "none/out.npy"])
        self.refuse(*self.scene, "--out", "mesh.off/out.npy", mentions=["--out", "mesh.off"])

    def test_folder_instead_of_file(self):
        (self.folder / "folder").mkdir()
        for command in [*self.commands, self.scene]:
            self.refuse(*command, "--out", "folder", mentions=["--out", "folder", "directory"])
        self.refuse(*self.scene, "--out", "o.npy", "--meshes", "mesh.off", mentions="mesh.off")

    def test_the_place_of_something_else(self):
        """Nothing is written over what is read, nor one result over another."""
        for command in self.commands:
            given = command[command.index("--pairs" if "--pairs" in command else "--trace") + 1]
            self.refuse(*command, "--out", given, mentions=["--out", given, "the place of"])
            self.refuse(*command, "--out", "./" + given, mentions=["--out", given, "the place of"])
            self.refuse(*command, "--json", given, mentions=["--json", given, "the place of"])
            self.refuse(*command, "--out", "one", "--json", "./one", mentions=["--out one", "the place of --json"])
            self.refuse(*command, "--out", "/dev/stdout", mentions=["--out /dev/stdout", "the totals"])
        self.refuse(*self.commands[0], "--out", "mesh.off", mentions=["--out mesh.off", "--mesh"])
        self.refuse(*self.commands[0], "--page", "one", "--out", "one", mentions=["--page one", "--out"])
        self.refuse(*self.scene, "--out", "mesh.off", mentions=["--out mesh.off", "--mesh"])
        predict = ["predict", "poses.npy", "--mesh", "mesh.off"]
        self.refuse(*predict, "--csv", "one", "--json", "one", mentions=["--json one", "--csv"])
        self.refuse(*predict, "--csv", "poses.npy", mentions=["--csv poses.npy", "--trace"])
        self.refuse(*predict, "--json", "/dev/stdout", mentions=["--json /dev/stdout", "the table"])
        (self.folder / "0-a.off").write_text(TETRAHEDRON)
        (self.folder / "a.off").write_text(TRIANGLE)
        mesh = ["scene", "random-walk", "--mesh", "a.off", "--meshes", "."]
        self.refuse(*mesh, "--mesh", "0-a.off", "--out", "out.npy", mentions=["--meshes", "0-a.off", "--mesh"])
        self.assertEqual((self.folder / "0-a.off").read_text(), TETRAHEDRON)
        self.refuse(*mesh, "--out", "0-a.off", mentions=["--meshes", "0-a.off", "--out"])
        (self.folder / "link.npy").symlink_to("poses.npy")
        self.refuse(*self.commands[0], "--out", "link.npy", mentions=["--out link.npy", "--trace"])
        self.take(*self.commands[1], "--out", "/dev/null", "--json", "/dev/null")

    def test_read_only_folder(self):
        nobody = {}
        if os.geteuid() == 0:
            nobody = {"user": 65534, "group": 65534}
            self.folder.chmod(0o755)
            try:
                subprocess.run([BVLAB, "list", "scenes"], check=True, capture_output=True, **nobody)
            except (OSError, subprocess.CalledProcessError):
                self.skipTest("the program cannot be run by another user")
        (self.folder / "shut").mkdir(mode=0o555)
        for command in [*self.commands, self.scene]:
            given = [*command, "--out", "shut/out.npy"]
            self.refuse(*given, mentions=["--out", "shut", "Permission denied"], **nobody)
        self.write("small.toml", "name = 'small'\n")
        self.refuse("run", "small.toml", "--record", "shut", mentions=["--record", "shut", "Permission denied"], **nobody)

    def test_full_device(self):
        for command in [*self.commands, self.scene]:
            given = [*command, "--out", "/dev/full"]
            self.refuse(*given, mentions=["/dev/full", "No space left"], exit=1)
        for command in self.commands:
            given = [*command, "--json", "/dev/full"]
            self.refuse(*given, mentions=["/dev/full", "No space left"], exit=1)

    def test_full_standard_output(self):
        for command in [*self.commands, ["list"], ["--help"]]:
            with open("/dev/full", "w", encoding="ascii") as full:
                self.refuse(*command, mentions="standard output", exit=1, stdout=full)

    def test_full_disk(self):
        """On a disk of 16 KiB, which only this process and its children see."""
        mount = "mkdir -p disk && mount -t tmpfs -o size=16k none disk && exec "
        probe = ["unshare", "--mount", "sh", "-c", mount + "true"]
        if shutil.which("unshare") is None or subprocess.run(
            probe, cwd=self.folder, capture_output=True, check=False
        ).returncode:
            self.skipTest("nothing can be mounted here")
        script = mount + 'sh -c \'echo old > disk/old.npy; "$@"; echo $?; ls -A disk; cat disk/old.npy\' sh "$@"'
        for command in [*self.commands, [*self.scene, "--frames", "1000"]]:
            for name in ("new.npy", "old.npy"):
                done = subprocess.run(
                    ["unshare", "--mount", "sh", "-c", script, "sh", BVLAB, *command]
                    + ["--out", "disk/" + name], cwd=self.folder, capture_output=True, text=True, check=True)
                with self.subTest(command=command, name=name):
                    self.assertEqual(done.stdout, "1\nold.npy\nold\n")
                    self.assertRegex(done.stderr, rf"\Abvlab: disk/{name}: [^\n]*No space left[^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
