# SPDX-License-Identifier: BSD-3-Clause
"""What counting costs: instructions, counted by callgrind, of the engine with counting off, of a
copy of it in which no counter is called, and of the engine with counting on. Off must cost no more
than a thousandth.

    run.py COMPILER EIGEN_INCLUDES BUILD_FOLDER     exits with 77 where there is no valgrind
"""

import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
CALL = re.compile(r"\bcounter_?(\.|->)(posed|tested|primitives|queried|add)\([^;]*\);")
READ = re.compile(r"\bcounter\.n_v \+ counter\.n_p\b")
MOST = 0.001


def copy_without_calls(target):
    """Copies the engine; the number of calls left out."""
    shutil.rmtree(target, ignore_errors=True)
    left_out = 0
    for room in ("hierarchies", "traversal"):
        for source in (ROOT / room).rglob("*.hpp"):
            kept, calls = CALL.subn("(void)0;", source.read_text())
            kept, reads = READ.subn("0", kept)
            left_out += calls + reads
            if source.name != "counters.hpp" and re.search(r"\bcounter_?(\.|->)", kept):
                raise SystemExit(f"{source}: calls a counter in a way that is not left out")
            copy = target / source.relative_to(ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(kept)
    return left_out


def instructions(compiler, eigen, build, name, includes, counter, strategy):
    program = build / f"{name}-{strategy}"
    # For any x86-64: valgrind does not know the newest instructions.
    flags = ["-std=c++20", "-O3", "-DNDEBUG", "-ffp-contract=off", "-fno-tree-slp-vectorize", "-w"]
    flags += [f"-I{includes}", f"-isystem{eigen}"]
    flags += [f"-DBVLAB_COUNTER={counter}", f"-DBVLAB_STRATEGY={strategy}"]
    subprocess.run([compiler, *flags, HERE / "driver.cpp", "-o", program], check=True)
    grind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    grind += ["--collect-atstart=no", "--toggle-collect=play"]
    done = subprocess.run([*grind, program], check=True, capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", done.stderr)[1]), done.stdout.strip()


def main():
    compiler, eigen, build = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    if shutil.which("valgrind") is None:
        print("skipped: no valgrind (Debian: valgrind)")
        return 77
    build.mkdir(parents=True, exist_ok=True)
    copy = build / "without"
    left_out = copy_without_calls(copy)
    print(f"{left_out} calls of counters left out of the copy")
    fault = left_out == 0
    for strategy in ("Recursive", "Deferred"):
        ways = {"without": (copy, "NotCounting"), "off": (ROOT, "NotCounting"), "on": (ROOT, "Counting")}
        counts, said = {}, {}
        for name, (includes, counter) in ways.items():
            counts[name], said[name] = instructions(
                compiler, eigen, build, name, includes, counter, strategy
            )
        cost = {name: counts[name] / counts["without"] - 1 for name in ("off", "on")}
        print(f"{strategy}: {said['on']}")
        print(f"  without counters {counts['without']:12} instructions")
        print(f"  counting off     {counts['off']:12} {cost['off']:+.4%}")
        print(f"  counting on      {counts['on']:12} {cost['on']:+.4%}")
        fault |= abs(cost["off"]) > MOST
    return int(fault)


if __name__ == "__main__":
    sys.exit(main())
