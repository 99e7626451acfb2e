# SPDX-License-Identifier: BSD-3-Clause
"""`pip install .`: builds the module with CMake and packs it (PEP 517). Needs no other package of Python, so it
works where no registry is reached: pip install . --no-build-isolation."""

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The build folder of the program is used, so that what is built already is not built again."""
    options = [f"-D{key}={value}" for key, value in (config_settings or {}).items()]
    if not (BUILD / "CMakeCache.txt").is_file():
        options.append("-DBVLAB_BUILD_TESTS=OFF")
    call("cmake", "--preset", "release", f"-DPython3_EXECUTABLE={sys.executable}", "-DBVLAB_PYTHON=ON", *options)
    call("cmake", "--build", str(BUILD), "--target", "bvlab_python")
    if not list((BUILD / "python" / "bvlab").glob("_bvlab.*.so")):
        raise SystemExit("bvlab: Python's headers or pybind11 are absent: experiments/setup installs what is missing")
    with tempfile.TemporaryDirectory() as folder:
        call("cmake", "--install", str(BUILD), "--component", "python", "--prefix", folder)
        installed = next(Path(folder).glob("**/bvlab"))
        return packed(installed.parent, Path(wheel_directory))


def packed(folder, out):
    """A wheel of all files of the folder; its name."""
    version = re.search(r"project\(bvlab VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    tag, info = f"{python}-{python}-{platform}", f"bvlab-{version}.dist-info"
    files = {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
    files[f"{info}/METADATA"] = (f"Metadata-Version: 2.1\nName: bvlab\nVersion: {version}\nSummary: Collision detection"
                                 " of moving triangle meshes, exact and counted\nLicense: BSD-3-Clause\n"
                                 "Requires-Python: >=3.11\nRequires-Dist: numpy\n").encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: bvlab\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    lines = [f'"{name}",sha256={digest(data)},{len(data)}' for name, data in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*lines, f"{info}/RECORD,,", ""]).encode()
    name = f"bvlab-{version}-{tag}.whl"
    with zipfile.ZipFile(out / name, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            archive.writestr(path, data)
    return name


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def call(*command):
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, "LC_ALL": "C"})
