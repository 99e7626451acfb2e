# SPDX-License-Identifier: BSD-3-Clause
"""Set-up where nobody may install: packages are unpacked into build/prefix, once, and cmake is told of them. apt-get is
a script here that has two packages.

usage: prefix_test.py SETUP
"""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SETUP = Path(sys.argv[1])
# An installed library, to which a package's link leads that comes without it.
INSTALLED = next(iter(sorted(Path("/usr/lib").glob("*/libc.so.6"))), None)
APT_GET = """#!/bin/sh
echo "$*" >>"$PACKAGES/asked"
case "$1" in
  install) echo 'Inst libthing-dev (1 here)'; echo 'Inst libthing1 (1 here)' ;;
  download) [ ! -e "$PACKAGES/away" ] && cp "$PACKAGES"/*.deb . ;;
esac
"""


@unittest.skipUnless(shutil.which("dpkg-deb") and shutil.which("gcc") and INSTALLED, "this is no Debian")
class Prefix(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="a folder ")
        self.addCleanup(folder.cleanup)
        self.tree, self.packages = Path(folder.name) / "tree", Path(folder.name) / "packages"
        (self.tree / "experiments").mkdir(parents=True)
        (self.tree / "build").mkdir()
        shutil.copy(SETUP, self.tree / "experiments/setup")
        self.prefix = self.tree / "build/prefix"
        self.libraries = INSTALLED.parent.relative_to("/")
        self.commands = self.packages / "bin"
        self.commands.mkdir(parents=True)
        for name, text in ("apt-get", APT_GET), ("dpkg-query", "#!/bin/sh\n"):
            (self.commands / name).write_text(text)
            (self.commands / name).chmod(0o755)
        self.pack("libthing-dev", {"libinstalled.so": INSTALLED.name, "libthing.so": "libthing.so.1"},
                  {"cmake/thing/thing.cmake": f'set(a "/{self.libraries}/libthing.so.1" "{INSTALLED}")\n'})
        self.pack("libthing1", {}, {"libthing.so.1": "a library\n"})

    def pack(self, name, links, files):
        root = self.packages / name
        (root / "DEBIAN").mkdir(parents=True)
        (root / "DEBIAN/control").write_text(f"Package: {name}\nVersion: 1\nArchitecture: all\nMaintainer: nobody\n"
                                             "Description: a test\n")
        for place, text in files.items():
            (root / self.libraries / place).parent.mkdir(parents=True, exist_ok=True)
            (root / self.libraries / place).write_text(text)
        for place, target in links.items():
            (root / self.libraries / place).symlink_to(target)
        subprocess.run(["dpkg-deb", "--root-owner-group", "-b", root, self.packages / f"{name}.deb"], check=True,
                       capture_output=True)

    def call(self, function):
        """A function of set-up, of which the group `things` is two packages that are missing."""
        words = f"source experiments/setup; packages_of() {{ echo libthing-dev a-program; }}; {function}"
        environment = os.environ | {"PATH": f"{self.commands}:{os.environ['PATH']}", "PACKAGES": str(self.packages),
                                    "BVLAB_WITHOUT_ROOT": "1"}
        return subprocess.run(["bash", "-c", words], cwd=self.tree, env=environment, capture_output=True, text=True,
                              check=False)

    def asked(self):
        path = self.packages / "asked"
        return path.read_text().splitlines() if path.exists() else []

    def test_libraries_are_unpacked_and_programs_done_without(self):
        self.assertEqual(self.call("prefix_options").stdout, "")
        done = self.call("set_up_packages things")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a-program cannot be installed without root", done.stderr)
        self.assertNotIn("a-program", self.asked()[0])
        unpacked = self.prefix / self.libraries
        self.assertEqual((unpacked / "libthing.so").read_text(), "a library\n")
        self.assertEqual((unpacked / "libinstalled.so").resolve(), INSTALLED.resolve())
        self.assertEqual((unpacked / "cmake/thing/thing.cmake").read_text(),
                         f'set(a "{unpacked}/libthing.so.1" "{INSTALLED}")\n')
        options = dict(line.split("=", 1) for line in self.call("prefix_options").stdout.splitlines())
        self.assertEqual(options["-DCMAKE_PREFIX_PATH"], f"{self.prefix}/usr")
        flags = options["-DCMAKE_EXE_LINKER_FLAGS"]
        self.assertIn(f"-L{unpacked}", shlex.split(flags))
        self.assertNotIn(flags[0], "'\"")  # CMake takes away quotes around a whole value
        self.assertEqual(sorted(path.name for path in (self.tree / "build").iterdir()), ["prefix"])

    def test_what_is_there_is_not_asked_for_again(self):
        self.call("set_up_packages things")
        before = self.asked()
        self.assertEqual(self.call("set_up_packages things").returncode, 0)
        self.assertEqual(self.asked(), before)

    def test_packages_that_cannot_be_fetched(self):
        (self.packages / "away").touch()
        done = self.call("set_up_packages things")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("experiments/anywhere.md", done.stderr)
        self.assertFalse((self.prefix / "had/libthing-dev").exists())
        self.assertEqual(list((self.tree / "build").glob("packages-*")), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
