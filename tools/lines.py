"""Lines of code by crate: product, its tests in Rust, and tools in Python.

A line of code is neither blank nor a comment. Tests are the files of `tests` folders, and modules of
`src` that are compiled for tests alone. Run by `tools/tidy --lines`, which gives it the names of files.
"""

import re
import sys
from collections import Counter
from pathlib import Path

TEST_MODULE = re.compile(r"(?P<indent>\s*)(?:pub(?:\([^)]*\))? )?mod (?P<name>\w+)\s*(?P<end>[;{])")


def count(lines, comment):
    return sum(1 for line in lines if line.strip() and not line.strip().startswith(comment))


def split(lines):
    """Returns lines of product, lines of test modules, and names of test modules in files of their own."""
    product, tests, names = [], [], []
    i = 0
    while i < len(lines):
        begin = i
        if lines[i].strip() == "#[cfg(test)]":
            i += 1
            while lines[i].strip().startswith("#["):
                i += 1
        module = TEST_MODULE.match(lines[i]) if i > begin else None
        if module is None:
            product += lines[begin:i + 1]
        elif module["end"] == ";":
            names.append(module["name"])
        else:
            while lines[i] != module["indent"] + "}":
                i += 1
            tests += lines[begin:i + 1]
        i += 1
    return product, tests, names


def modules_of(path, names):
    """Returns the files and folders of modules that the file `path` declares."""
    base = path.parent if path.stem in ("lib", "main", "mod") else path.with_suffix("")
    return {str(base / name) for name in names}


def is_python(path):
    if path.suffix == ".py":
        return True
    with path.open(encoding="utf-8", errors="replace") as file:
        return file.readline().startswith("#!/usr/bin/env python3")


def main(names):
    paths = [Path(name) for name in names]
    parts = {path: split(path.read_text(encoding="utf-8").splitlines())
             for path in paths if path.suffix == ".rs" and path.parts[0] in ("crates", "python")}
    hidden = set().union(*(modules_of(path, part[2]) for path, part in parts.items()))
    product, tests = Counter(), Counter()
    for path, (own, inline, _) in parts.items():
        crate = path.parts[1] if path.parts[0] == "crates" else path.parts[0]
        is_test = "src" not in path.parts or any(
            str(place) in hidden for place in (path.with_suffix(""), *path.parents))
        if "benches" in path.parts or "examples" in path.parts:
            continue
        (tests if is_test else product)[crate] += count(own, "//")
        tests[crate] += count(inline, "//")
    for crate in sorted(product):
        print("%-8s %6d product %6d tests" % (crate, product[crate], tests[crate]))
    print("%-8s %6d product %6d tests" % ("all", product.total(), tests.total()))
    tools = [path for path in paths if path.parts[0] == "tools" and is_python(path)]
    lines = (path.read_text(encoding="utf-8").splitlines() for path in tools)
    print("%-8s %6d" % ("tools", sum(count(text, "#") for text in lines)))


main(sys.argv[1:])
