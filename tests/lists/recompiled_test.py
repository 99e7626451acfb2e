# SPDX-License-Identifier: BSD-3-Clause
"""What a new entry of a list costs: its own units and a table, and no other unit of the program.

usage: recompiled_test.py SOURCE BUILD, the tree of a build that is up to date
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE, BUILD = map(pathlib.Path, sys.argv[1:3])
LISTS = ["hierarchies/volumes.hpp", "traversal/strategies.hpp", "traversal/queries.hpp", "broadphase/broadphase.hpp"]


def ninja(*arguments):
    done = subprocess.run(["ninja", "-C", BUILD, "-t", *arguments], check=True, capture_output=True, text=True)
    return done.stdout


def dependents():
    """Of each list the objects and precompiled headers that include it."""
    found, target = {name: set() for name in LISTS}, None
    for line in ninja("deps").splitlines():
        if heading := re.match(r"(\S.*): #deps", line):
            target = heading[1]
        for name in LISTS:
            if line.strip().endswith("/" + name):
                found[name].add(target)
    return found


def objects_of_program(tree):
    """Those that bvlab is linked from, by the build file."""
    text = (tree / "build.ninja").read_text()
    return set(re.findall(r"^build (experiments/\S+\.o):", text, re.M))


def configured(folder):
    """A tree of that source, without tests and other libraries."""
    tree = folder / "build"
    subprocess.run(
        ["cmake", "-G", "Ninja", "-S", folder, "-B", tree, "-DCMAKE_BUILD_TYPE=Release", "-DBVLAB_BUILD_TESTS=OFF"],
        check=True,
        capture_output=True,
    )
    return objects_of_program(tree)


def with_capsule(scratch):
    """Objects of the program before and after the capsule is put into a copy of the list."""
    folder = pathlib.Path(scratch) / "copy"
    ignore = shutil.ignore_patterns("build", "record", ".git", "node_modules")
    shutil.copytree(SOURCE, folder, ignore=ignore)
    before = configured(folder)
    shutil.copy(folder / "tests/example/capsule.hpp", folder / "hierarchies/volumes/capsule.hpp")
    volumes = folder / "hierarchies/volumes.hpp"
    text = volumes.read_text()
    first = text.index("#include")
    text = text[:first] + '#include "hierarchies/volumes/capsule.hpp"\n' + text[first:]
    volumes.write_text(text.replace("Sphere<float>,", "Sphere<float>, Capsule<float>,", 1))
    return before, configured(folder)


def main():
    wrong = []
    program = objects_of_program(BUILD)
    for name, targets in dependents().items():
        again = sorted(t for t in targets if t in program or t.startswith("experiments/") and t.endswith(".gch"))
        print(f"{name}: {len(again)} units of the program include it")
        if again:
            wrong.append(f"{name} is included by {', '.join(again)}")
    with tempfile.TemporaryDirectory(prefix="bvlab-") as scratch:
        before, after = with_capsule(scratch)
    added = sorted(pathlib.Path(o).name for o in after - before)
    print("new units:", ", ".join(added))
    # One for the volume itself, one for its loops under all queries.
    if before - after or len(added) != 2 or not all("capsule" in name for name in added):
        wrong.append(f"the capsule is compiled in {added}")
    sys.exit("\n".join(wrong) or 0)


main()
