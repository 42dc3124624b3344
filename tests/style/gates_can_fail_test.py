#!/usr/bin/env python3
"""Every gate of gates.py fails on a file that it should refuse, and passes without that file.

    gates_can_fail_test.py ROOT BUILD
"""
import os
import shutil
import subprocess
import sys
import tempfile

ROOT, BUILD = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
GATES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "gates.py")
GOOD = "#pragma once\n\nnamespace lab {\n\nstruct Good {\n  int first_count = 0;\n};\n\n}  // namespace lab\n"
# Gate: a file, its text, and a part of the line that the gate must print.
BAD = {
    "format": ("light/bad.hpp", "#pragma once\n\nnamespace lab {\nstruct   Bad {int a=0;};\n}  // namespace lab\n",
               "light/bad.hpp: clang-format would change it"),
    "names": ("light/bad.hpp", "#pragma once\n\nnamespace lab {\n\nclass Bad {\n  int wrongName = 0;\n};\n\n"
              "}  // namespace lab\n", "'wrongName'"),
    # The misspelt word stands in two pieces, so that this file passes the gate.
    "spelling": ("docs/bad.md", "The robot reci" "eves a command.\n", "reci" "eves ==> receives"),
    "includes": ("light/bad.hpp", "#pragma once\n\nnamespace lab {\n\nstruct Bad {\n  std::string text;\n};\n\n"
                 "}  // namespace lab\n", "light/bad.hpp:6: uses std::string, expected #include <string>"),
    "layout": ("light/bad.hpp", '#pragma once\n\n#include "runner/live/launch.hpp"\n', "light may include robot"),
    "programs": ("light/bad.hpp", '#pragma once\n\nconstexpr const char* kModel = "hover";\n',
                 "light/bad.hpp:3: names the program hover"),
    "alone": ("light/bad.hpp", "#pragma once\n\nnamespace lab {\n\nstruct Bad {\n  Unknown member;\n};\n\n"
              "}  // namespace lab\n", "does not compile alone"),
}


def run(gate, root):
    return subprocess.run([sys.executable, "-B", GATES, gate, root, BUILD], capture_output=True, text=True)


def main():
    failed = skipped = 0
    for gate, (name, text, expected) in BAD.items():
        with tempfile.TemporaryDirectory() as root:
            shutil.copy(os.path.join(ROOT, ".clang-format"), root)
            shutil.copy(os.path.join(ROOT, ".clang-tidy"), root)
            os.makedirs(os.path.join(root, "docs"))
            os.makedirs(os.path.join(root, "light"))
            with open(os.path.join(root, "light/good.hpp"), "w", encoding="utf-8") as file:
                file.write(GOOD)
            os.makedirs(os.path.join(root, "programs"))
            with open(os.path.join(root, "programs/hover.toml"), "w", encoding="utf-8") as file:
                file.write('[phases.hover]\nhold = "forever"\n')
            before = run(gate, root)
            with open(os.path.join(root, name), "w", encoding="utf-8") as file:
                file.write(text)
            after = run(gate, root)
        if before.returncode == 77:
            print(f"{gate}: {before.stdout.strip()}")
            skipped += 1
            continue
        if before.returncode != 0:
            print(f"FAILED: {gate} refuses a good file: {before.stdout}{before.stderr}")
            failed += 1
        if after.returncode != 1 or expected not in after.stdout:
            print(f"FAILED: {gate}: expected \"{expected}\", found: {after.stdout}{after.stderr}")
            failed += 1
    if failed:
        return 1
    return 77 if skipped == len(BAD) else 0


if __name__ == "__main__":
    sys.exit(main())
