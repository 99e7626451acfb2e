# SPDX-License-Identifier: BSD-3-Clause
"""Compiles a user's volume or strategy into the module."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

_FORM = r".+:[A-Za-z_][A-Za-z0-9_:]*(<.*>)?"


def compile_in(volumes: str | Iterable[str] = (), strategies: str | Iterable[str] = (), *,
               source: str | os.PathLike | None = None, build: str | os.PathLike | None = None,
               only_volumes: Iterable[str] = (), only_strategies: Iterable[str] = ()) -> ModuleType:
    """Compiles volumes or strategies from outside into a module, and returns that module.

    volumes, strategies   ["mine.hpp:Mine<float>"]: header and type, as -DBVLAB_EXTRA_VOLUMES has them; see
                          hierarchies/adding_a_volume.md and traversal/adding_a_strategy.md
    source, build         the source tree, and its build folder; as this module was built, and then an import
                          of bvlab from that folder has the new entries from now on
    only_volumes, only_strategies   compile only these of the built-in lists, which takes less time

        mine = bvlab.compile_in(volumes=["capsule.hpp:Capsule<float>"])
        mine.replay([mine.Mesh(vertices, faces)], poses, volume="capsule")

    Only the new entry and a table are compiled: a minute or two. The returned module is independent of this one:
    a Mesh of one cannot be used with the other. ValueError: the first error of CMake or the compiler.
    """
    extra = {"VOLUMES": _entries(volumes), "STRATEGIES": _entries(strategies)}
    if not any(extra.values()):
        raise ValueError("compile_in: nothing to compile; volumes=['header.hpp:Type'] or strategies=[...]")
    where = json.loads((Path(__file__).with_name("built.json")).read_text())
    source = Path(source or where["source"])
    build = Path(build or where["build"])
    if not (source / "CMakeLists.txt").is_file():
        raise ValueError(f"{source}: no source tree of bvlab; name one: source=...")
    options = [f"-DBVLAB_EXTRA_{kind}={';'.join(each)}" for kind, each in extra.items()]
    # Also where all are wanted: the build folder remembers what the last call named.
    options += [f"-DBVLAB_{kind}={';'.join(only)}" for kind, only in
                (("VOLUMES", only_volumes), ("STRATEGIES", only_strategies))]
    if not (build / "CMakeCache.txt").is_file():
        options += ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBVLAB_BUILD_TESTS=OFF"]
    _call(["cmake", "-S", str(source), "-B", str(build), *options])
    _call(["cmake", "--build", str(build), "--target", "bvlab_python"])
    return _loaded(build / "python" / "bvlab", json.dumps(extra))


def _entries(given):
    """Headers by their whole paths, since the build runs elsewhere."""
    given = [given] if isinstance(given, str) else list(given)
    for each in given:
        if not re.fullmatch(_FORM, each):
            raise ValueError(f"'{each}' is not header.hpp:Type")
    found = []
    for each in given:
        header, kind = each.split(":", 1)
        if not Path(header).is_file():
            raise ValueError(f"{each}: there is no {header}")
        found.append(f"{Path(header).resolve()}:{kind}")
    return found


def _call(command):
    environment = {**os.environ, "LC_ALL": "C"}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    if done.returncode == 0:
        return
    lines = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    first = next((k for k, line in enumerate(lines) if "error" in line.lower()), -1)
    if lines and lines[first].endswith("(message):"):  # CMake puts the text below
        first = min(first + 1, len(lines) - 1)
    raise ValueError(f"{' '.join(command[:2])}: {lines[first] if lines else 'failed'}")


def _loaded(package, key):
    name = f"bvlab_{hashlib.sha256(key.encode()).hexdigest()[:8]}"
    for each in [each for each in sys.modules if each == name or each.startswith(f"{name}.")]:
        del sys.modules[each]
    spec = importlib.util.spec_from_file_location(name, package / "__init__.py", submodule_search_locations=[str(package)])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
