# SPDX-License-Identifier: BSD-3-Clause
"""The records of the repository, and what a test of them needs."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLOTS = ROOT / "plots"
sys.path.insert(0, str(PLOTS))
sys.dont_write_bytecode = True
RECORDS = sorted(path.parent for path in (ROOT / "experiments" / "record").glob("*/definition.toml"))


def skip(why):
    """As ctest understands it."""
    print(f"skipped: {why}")
    sys.exit(77)
