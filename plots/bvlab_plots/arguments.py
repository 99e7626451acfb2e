# SPDX-License-Identifier: BSD-3-Clause
"""The command line of a script that draws one record."""

import argparse
import os
import signal
import sys
from pathlib import Path

from bvlab_plots.refused import Refused


def require_folder(out):
    """Refuses a folder that cannot be made or written into, before figures are drawn for it."""
    place = Path(out)
    while not place.exists():
        place = place.parent
    if not place.is_dir():
        raise Refused(f"{out}: {place} is no folder")
    if not os.access(place, os.W_OK | os.X_OK):
        raise Refused(f"{out}: {place}: Permission denied")


def exit_status(main):
    """Of a script: what it refuses is said in one line, and makes 2."""
    try:
        return main() or 0
    except Refused as fault:
        print(f"{Path(sys.argv[0]).name}: {fault}", file=sys.stderr)
        return 2


def run(main):
    """What a file of plots/ is: ends the process with main's exit status; quietly where nobody reads on."""
    import matplotlib
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # | head
    matplotlib.use("Agg")
    status = exit_status(main)
    try:
        sys.stdout.flush()
    except OSError as fault:  # a full disk
        print(f"{Path(sys.argv[0]).name}: standard output: {fault.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 1
    sys.exit(status)


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
    if arguments.record.is_dir() and not (table_only and arguments.table_only):
        require_folder(arguments.out)
    return arguments
