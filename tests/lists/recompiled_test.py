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


def ninja(tree, *arguments):
    done = subprocess.run(["ninja", "-C", tree, "-t", *arguments], check=True, capture_output=True, text=True)
    return done.stdout


def dependents():
    """Of each list the objects and precompiled headers that include it."""
    found, target = {name: set() for name in LISTS}, None
    for line in ninja(BUILD, "deps").splitlines():
        if heading := re.match(r"(\S.*): #deps", line):
            target = heading[1]
        for name in LISTS:
            if line.strip().endswith("/" + name):
                found[name].add(target)
    return found


def objects_of_program(tree):
    """Those that bvlab is linked from."""
    return {path for path in ninja(tree, "inputs", "bvlab").split() if re.fullmatch(r"experiments/\S+\.o", path)}


def configured(folder):
    """A tree of that source, without tests and other libraries."""
    tree = folder / "build"
    subprocess.run(
        ["cmake", "-G", "Ninja", "-S", folder, "-B", tree, "-DCMAKE_BUILD_TYPE=Release", "-DBVLAB_BUILD_TESTS=OFF"],
        check=True,
        capture_output=True,
    )
    return objects_of_program(tree)


def with_example(scratch, example, name, list_header, folder_of, before_it):
    """Objects of the program before and after an example is put into a copy of its list."""
    folder = pathlib.Path(scratch) / example
    ignore = shutil.ignore_patterns("build", "record", ".git", "node_modules")
    shutil.copytree(SOURCE, folder, ignore=ignore)
    before = configured(folder)
    shutil.copy(folder / f"tests/example/{example}.hpp", folder / folder_of / f"{example}.hpp")
    header = folder / list_header
    text = header.read_text()
    first = text.index("#include")
    text = text[:first] + f'#include "{folder_of}/{example}.hpp"\n' + text[first:]
    header.write_text(text.replace(before_it, f"{before_it} {name},", 1))
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
        volume = with_example(
            scratch, "capsule", "Capsule<float>", "hierarchies/volumes.hpp", "hierarchies/volumes", "Sphere<float>,"
        )
        strategy = with_example(
            scratch, "kinetic_list", "KineticList", "traversal/strategies.hpp", "traversal/strategies", "SeparationList,"
        )
    # A volume: one unit for itself, one for its tests on kernel gathered under all queries, one for kernels siblings and
    # mixed. A strategy, also one with a front of its own: one for all volumes.
    for name, (before, after), wanted in [("capsule", volume, 3), ("kinetic_list", strategy, 1)]:
        added = sorted(pathlib.Path(o).name for o in after - before)
        print("new units:", ", ".join(added))
        if before - after or len(added) != wanted or not all(name in each for each in added):
            wrong.append(f"the {name} is compiled in {added}")
    sys.exit("\n".join(wrong) or 0)


main()
