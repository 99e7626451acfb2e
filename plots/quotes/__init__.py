# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that README.md, the pages of experiments/ and the paper quote from the records."""

import importlib
from pathlib import Path

for path in sorted(Path(__file__).parent.glob("[a-z]*.py")):
    importlib.import_module(f"quotes.{path.stem}")
