# SPDX-License-Identifier: BSD-3-Clause
"""The sample in experiments/definitions/definition.hpp is a definition that bvlab takes."""

import os
import pathlib
import subprocess
import tempfile

HEADER = pathlib.Path(__file__).resolve().parents[2] / "experiments" / "definitions" / "definition.hpp"

lines = [line[4:].strip() for line in HEADER.read_text(encoding="utf-8").splitlines() if line.startswith("///     ")]
assert any(line.startswith("[[axis]]") for line in lines), "definition.hpp has no sample"
with tempfile.TemporaryDirectory() as work:
    sample = pathlib.Path(work) / "sample.toml"
    sample.write_text("\n".join(lines) + "\n", encoding="utf-8")
    done = subprocess.run([os.environ["BVLAB"], "run", sample, "--parts"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
