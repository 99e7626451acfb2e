# SPDX-License-Identifier: BSD-3-Clause
"""What traversal/adding_a_strategy.md shows of the example strategies stands in their headers, word for word.

usage: shown_test.py SOURCE
"""

import pathlib
import re
import sys

SOURCE = pathlib.Path(sys.argv[1])
EXAMPLES = [SOURCE / "tests/example" / name for name in ("periodic.hpp", "kinetic_list.hpp")]


def main():
    page = (SOURCE / "traversal/adding_a_strategy.md").read_text()
    headers = {header.name: header.read_text() for header in EXAMPLES}
    shown = {name: 0 for name in headers}
    wrong = []
    # What stands in an example and is left out on the page is marked by a line of three dots.
    for block in re.findall(r"^```cpp\n(.*?)^```", page, re.M | re.S):
        name = next((name for name, text in headers.items() if block.splitlines()[0] in text), None)
        if name is None:
            continue
        parts = [part.strip("\n") for part in re.split(r"^ *// \.\.\.$", block, flags=re.M)]
        at = 0
        for part in filter(None, parts):
            at = headers[name].find(part, at)
            if at < 0:
                wrong.append(f"{name} has not, in this place:\n{part}")
                break
        shown[name] += 1
    wrong += [f"{name} is not shown" for name, times in shown.items() if times == 0]
    print(shown)
    sys.exit("\n".join(wrong) or 0)


main()
