# SPDX-License-Identifier: BSD-3-Clause
"""The command line of a script that draws one record."""

import argparse
from pathlib import Path


def record_arguments(doc, table_only=False):
    """record and out (RECORD/figures unless it is given) as paths; table_only where a script can
    do without figures. `doc` is the script's, whose first line says what it draws."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("record", type=Path)
    parser.add_argument("--out", type=Path,
                        help="folder for the figures (default: RECORD/figures)")
    if table_only:
        parser.add_argument("--table-only", action="store_true", help="print, draw nothing")
    arguments = parser.parse_args()
    arguments.out = arguments.out or arguments.record / "figures"
    return arguments
