# SPDX-License-Identifier: BSD-3-Clause
"""The engine live on a page: one HTML file that needs no other and no network.

With meshes and, if given, a motion: bodies that are dragged, turned and thrown, several strategies side by side, what
each of them tests and keeps; or other engines beside it. With an X3D or VRML scene: its parts can be dragged, and what
they touch turns red.
"""

import argparse
import base64
import gzip
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from bvlab_plots.refused import Refused

ROOT = Path(__file__).resolve().parents[2]
PAGES, VIEWERS = ROOT / "plots" / "page", ROOT / "build" / "viewers"
# A page has at most so many bytes, of which its own scripts are some: a motion has what viewer, engine and meshes leave.
MOST_BYTES, OWN_SCRIPTS = 4_000_000, 100_000
MOST_TRIANGLES, MOST_BODIES = 50_000, 300
RUNS = ["deferred", "margins", "recursive"]
NAMED = re.compile(r'<script src="([^"]+)"></script>|<link rel="stylesheet" href="([^"]+)">|<!--data-->')


def text_of(array, kind):
    return base64.b64encode(np.ascontiguousarray(array, kind).tobytes()).decode()


def bytes_of(path):
    try:
        return Path(path).read_bytes()
    except OSError as fault:
        raise Refused(f"{path}: {fault.strerror}") from fault


def program():
    """The Python module, which reads meshes as the program does."""
    sys.path.append(str(ROOT / "build" / "release" / "python"))
    try:
        import bvlab  # pylint: disable=import-outside-toplevel
    except ImportError as fault:
        raise Refused("the Python module bvlab is not built, which reads meshes: experiments/setup builds it") from fault
    return bvlab


def zipped(content):
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()


def engine():
    """The modules for WebAssembly by name, made first where that is to be done: of those a browser takes the first that it runs
    as it is meant (engine.js)."""
    done = subprocess.run([ROOT / "experiments" / "live" / "build"], stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise Refused(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "the engine was not made")
    made = {name: ROOT / "build" / "live" / f"{name}.wasm" for name in ("relaxed", "engine")}
    return {name: zipped(bytes_of(path)) for name, path in made.items() if name == "engine" or path.exists()}


def written(name, data, scripts=()):
    """The page of that name with its scripts, its styles and the data, which cannot end the script that they are in. Nothing
    else runs there, nor in a frame but `scripts`, and nothing is fetched: what its policy says to the browser."""
    text = json.dumps(data).replace("<", "\\u003c")
    allowed = [*map(hash_of, scripts)]

    def part(match):
        if match[1]:
            place = PAGES / match[1] if (PAGES / match[1]).exists() else VIEWERS / match[1]
            script = place.read_text() if place.exists() else ""
            script = "\n" + script.replace("</script", "<\\/script")
            allowed.append(hash_of(script))
            return f"<script>{script}</script>"
        return "<style>\n" + (PAGES / match[2]).read_text() + "</style>" if match[2] else text
    page = NAMED.sub(part, (PAGES / name).read_text())
    # Engines of others are unzipped in the page, and so become functions.
    evaluated = "'unsafe-eval'" if {"others", "vrml_reader"} & data.keys() else "'wasm-unsafe-eval'"
    policy = f"default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src {evaluated} {' '.join(allowed)}"
    return page.replace('<meta charset="utf-8">', f'<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="{policy}">', 1)


def hash_of(script):
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"


def motion_of(path, bvlab):
    try:
        trace = np.load(path, allow_pickle=False)
    except OSError as fault:
        raise Refused(f"{path}: {fault.strerror or 'not a trace'}") from fault
    except (ValueError, EOFError) as fault:
        raise Refused(f"{path}: not a .npy array") from fault
    if trace.dtype != np.float64 or trace.ndim != 3 or trace.shape[2] != 7:
        raise Refused(f"{path}: must be float64 of shape (frames, objects, 7), not {trace.dtype} {trace.shape}")
    if 0 in trace.shape:
        raise Refused(f"{path}: there is no frame or no object to show")
    try:
        bvlab.poses(trace[..., :3], trace[..., 3:], order="wxyz")
    except ValueError as fault:
        raise Refused(f"{path}: {fault}") from fault
    return trace


def side_by_side(meshes, bodies):
    """One frame: bodies in a square, nearly as close as the largest is wide."""
    step = 1.05 * max(np.linalg.norm(np.ptp(mesh.vertices, axis=0)) for mesh in meshes) / np.sqrt(2)
    side = int(np.ceil(np.sqrt(bodies)))
    poses = np.zeros((1, bodies, 7))
    poses[0, :, 0], poses[0, :, 2] = step * (np.arange(bodies) % side), step * (np.arange(bodies) // side)
    poses[..., 3] = 1
    for i in range(bodies):
        poses[0, i, :3] -= (meshes[i % len(meshes)].vertices.min(0) + meshes[i % len(meshes)].vertices.max(0)) / 2
    return poses


def run_of(text):
    """STRATEGY[,VOLUME[,KERNEL[,FAN-OUT]]]."""
    words = text.split(",")
    kernel = words[2] if len(words) > 2 else "gathered"
    return {"strategy": words[0], "volume": words[1] if len(words) > 1 else "sphere", "kernel": kernel,
            "fanOut": int(words[3]) if len(words) > 3 and words[3].isdigit() else 2}


def live_page(arguments):
    bvlab = program()
    meshes = []
    for path in arguments.mesh:
        try:
            meshes.append(bvlab.read(path))
        except (ValueError, OSError) as fault:
            raise Refused(str(fault)) from fault
    triangles = sum(len(mesh.faces) for mesh in meshes)
    if triangles > MOST_TRIANGLES:
        raise Refused(f"{arguments.mesh[0]}: {triangles} triangles with all other meshes; a page holds {MOST_TRIANGLES}")
    motion = motion_of(arguments.trace, bvlab) if arguments.trace else side_by_side(meshes, arguments.bodies or max(2, len(meshes)))
    frames, bodies = motion.shape[:2]
    if bodies > MOST_BODIES:
        raise Refused(f"{arguments.trace or '--bodies'}: {bodies} bodies; a page moves at most {MOST_BODIES}")
    modules, viewer = engine(), VIEWERS / "three.min.js"
    texts = [{"name": Path(path).name, "vertices": text_of(mesh.vertices, "<f8"), "triangles": text_of(mesh.faces, "<u4")}
             for path, mesh in zip(arguments.mesh, meshes)]
    taken = OWN_SCRIPTS + (viewer.stat().st_size if viewer.exists() else 0) + sum(map(len, modules.values())) + len(json.dumps(texts))
    shown = max(1, min(frames, (MOST_BYTES - taken) * 3 // 4 // (56 * bodies)))
    left_out = [f"Of {frames} frames the first {shown} are in this page."] if shown < frames else []
    return written("peers.html" if arguments.peers else "live.html", {
        "title": title_of(dict.fromkeys(Path(path).name for path in arguments.mesh)), "bodies": bodies, "query": arguments.query,
        "runs": [run_of(text) for text in arguments.run or RUNS], "left_out": left_out,
        "meshes": texts, "motion": text_of(motion[:shown], "<f8"), "engine": modules, **(others() if arguments.peers else {})})


def title_of(names):
    first, *rest = names
    return f"{first} and {len(rest)} others" if len(rest) > 1 else ", ".join(names)


def from_npm(name):
    """What set-up got, zipped; nothing where it did not."""
    return zipped((VIEWERS / name).read_bytes()) if (VIEWERS / name).exists() else ""


def others():
    packages = json.loads((ROOT / "plots" / "viewers" / "package-lock.json").read_text())["packages"]
    return {"others": from_npm("peers.min.js"), "versions": {name.removeprefix("node_modules/"): package.get("version")
                                                             for name, package in packages.items()}}


def x3d_page(arguments):
    scene = bytes_of(arguments.x3d)
    frame = (PAGES / "vrml_frame.js").read_text()
    vrml = {"vrml_reader": from_npm("x_ite.min.js"), "vrml_frame": frame} if scene.startswith(b"#VRML") else {}
    return written("x3d.html", {"title": Path(arguments.x3d).name, "scene": scene.decode(errors="replace"), "engine": engine(), **vrml},
                   [frame] if vrml else [])


def main():
    parser = argparse.ArgumentParser(prog="plots/live", description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", action="append", help="mesh file; body i has mesh i modulo their number")
    parser.add_argument("--trace", help="a motion, as bvlab replay takes it; without it bodies stand side by side")
    parser.add_argument("--bodies", type=int, help="how many stand there without a motion (default: one a mesh, at least two)")
    parser.add_argument("--query", choices=["touching", "contacts", "distance"], default="contacts")
    parser.add_argument("--run", action="append", metavar="STRATEGY[,VOLUME[,KERNEL[,FAN-OUT]]]",
                        help=f"what runs side by side at first (default: {', '.join(RUNS)} over spheres)")
    parser.add_argument("--peers", action="store_true", help="instead, a page that times three-mesh-bvh and rapier on the same motion")
    parser.add_argument("--x3d", help="instead of meshes, an X3D or VRML 97 scene, whose parts can be dragged")
    parser.add_argument("--out", required=True, help="the page")
    arguments = parser.parse_args()
    if bool(arguments.mesh) == bool(arguments.x3d):
        raise Refused("either --mesh or --x3d says what is shown")
    if arguments.peers and not arguments.trace:
        raise Refused("--peers: needs the motion of --trace")
    if arguments.bodies is not None and not 1 <= arguments.bodies <= MOST_BODIES:
        raise Refused(f"--bodies {arguments.bodies}: must be 1 to {MOST_BODIES}")
    out = Path(arguments.out)
    page = x3d_page(arguments) if arguments.x3d else live_page(arguments)
    try:
        part = out.with_name(out.name + ".part")
        part.write_text(page)
        os.replace(part, out)
    except OSError as fault:
        raise Refused(f"--out {out}: {fault.strerror}") from fault
