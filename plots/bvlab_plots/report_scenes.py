# SPDX-License-Identifier: BSD-3-Clause
"""The scenes of the report in 3D, made by the program."""

import subprocess
import sys
import tempfile
from pathlib import Path

# Name, what it shows, how its trace is made, and how that is replayed.
SCENES = [
    ("nine-bunnies", "Nine bunnies of 500 polygons in a closed workspace, all of them moving",
     ["random-walk", "--objects", "9", "--frames", "1000", "--side", "4body"],
     ["--volume", "sphere", "--strategy", "separation-list"]),
    ("pile", "Twenty-four bunnies dropped into a box, coming to rest",
     ["pile", "--objects", "24", "--frames", "1000", "--side", "5body"],
     ["--volume", "obb", "--strategy", "raise", "--build", "bottom-up", "--fit", "tight", "--leaf-size", "2"]),
]


def make(program, out):
    """Writes OUT/scenes/*.html and says what was written: name, description and file of each. One line on standard
    error where they cannot be made."""
    if not program.is_file():
        print(f"report: scenes in 3D are left out, for {program} is not built", file=sys.stderr)
        return []
    (out / "scenes").mkdir(parents=True, exist_ok=True)
    made = []
    for name, description, scene, variant in SCENES:
        file = Path("scenes") / f"{name}.html"
        try:
            with tempfile.TemporaryDirectory() as folder:
                play(program, Path(folder), name, scene, variant, out / file)
            made.append((name, description, file.as_posix()))
        except subprocess.CalledProcessError as fault:
            said = fault.stderr.strip().splitlines() or [f"exit {fault.returncode}"]
            print(f"report: the scene {name} is left out: {said[-1]}", file=sys.stderr)
    return made


def play(program, folder, name, scene, variant, page):
    def run(*words):
        subprocess.run([program, *words], capture_output=True, text=True, check=True)

    trace = folder / f"{name}.npy"
    run("scene", *scene, "--out", trace, "--meshes", folder / "meshes")
    meshes = [word for mesh in sorted((folder / "meshes").iterdir()) for word in ("--mesh", mesh)]
    run("replay", *meshes, "--trace", trace, *variant, "--page", page, "--json", folder / "totals.json")
