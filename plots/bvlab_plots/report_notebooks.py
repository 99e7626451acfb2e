# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of the report: as they were rendered when they were made, by tests/run."""

import re
import shutil
from html import unescape
from pathlib import Path


def make(rendered, out):
    """Copies the pages in the folder `rendered` to OUT/notebooks; name, title and file of each."""
    made = []
    for page in sorted(Path(rendered).glob("*.html")):
        (out / "notebooks").mkdir(parents=True, exist_ok=True)
        shutil.copy(page, out / "notebooks" / page.name)
        title = re.search(r"<h1[^>]*>(.*?)(<a|</h1>)", page.read_text(), re.DOTALL)
        made.append((page.stem, unescape(title[1]).strip() if title else "", f"notebooks/{page.name}"))
    return made
