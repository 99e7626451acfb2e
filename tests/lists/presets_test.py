# SPDX-License-Identifier: BSD-3-Clause
"""A preset is what it says: entries of THE lists that an earlier call left out are back.

usage: presets_test.py SOURCE
"""

import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
LISTS = ["VOLUMES", "STRATEGIES", "EXTRA_VOLUMES", "EXTRA_STRATEGIES", "WITHOUT"]


def cached(folder, *options):
    """What the cache says of the lists after `cmake --preset release` with the options."""
    command = ["cmake", "--preset", "release", "-S", SOURCE, "-B", folder, "-DBVLAB_BUILD_EXPERIMENTS=OFF",
               "-DBVLAB_BUILD_TESTS=OFF", *options]
    subprocess.run(command, check=True, capture_output=True, cwd=SOURCE)
    lines = (pathlib.Path(folder) / "CMakeCache.txt").read_text(encoding="utf-8").splitlines()
    entries = dict(line.split("=", 1) for line in lines if line.startswith("BVLAB_"))
    values = {name.split(":")[0]: value for name, value in entries.items()}
    return {name: values[f"BVLAB_{name}"] for name in LISTS}


with tempfile.TemporaryDirectory() as work:
    some = cached(work, "-DBVLAB_VOLUMES=sphere;obb", "-DBVLAB_STRATEGIES=recursive", "-DBVLAB_WITHOUT=tbb",
                  "-DBVLAB_EXTRA_VOLUMES=tests/example/capsule.hpp:Capsule<float>",
                  "-DBVLAB_EXTRA_STRATEGIES=tests/example/periodic.hpp:Periodic")
    assert all(some.values()), some
    again = cached(work)
    assert not any(again.values()), f"left over from an earlier call: {again}"
