# SPDX-License-Identifier: BSD-3-Clause
"""What README.md and experiments/results.md say of the records, in the order of the results."""

import importlib
from pathlib import Path

for path in sorted(Path(__file__).parent.glob("[a-z]*.py")):
    importlib.import_module(f"quotes.{path.stem}")
