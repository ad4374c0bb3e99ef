"""Writes the tables of pages from the measurements in docs/data.

    python3 tools/tables [PAGE.md ...]      rewrites tables that are out of date [all pages]
    python3 tools/tables --check            changes nothing; exits with 1 where one is out of date
    python3 tools/tables --self-test        tests of this tool

A page marks the place of a table; the path is relative to the page:

    <!-- table: data/auto.csv
         columns: Scene = `{scene}` | `path` = {path:#.3g} | Range = {low} to {high}
         rows: scene = room-direct, apartment | threads = 2
         source: no -->
    <!-- end of table -->

A column is a title and a template over the columns of the file; without `columns` the table has all
of them. `rows` keeps the rows with one of the values, in the order of the file. The line below the
table names command, date and file unless `source` is `no`. A file of data begins with comments:
`# command: …`, `# date: …`, `# version: …` and `# machine: …`. Standard library only.
"""

import argparse
import csv
import os
import re
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KEYS = ("command", "date", "version", "machine")
OPTIONS = ("columns", "rows", "source")
TABLE = re.compile(r"^<!-- table: (\S+)(.*?)-->$(.*?)^<!-- end of table -->$", re.DOTALL | re.MULTILINE)
SKIPPED = ("target", "node_modules")


class Fault(Exception):
    """A marker or a file of data that cannot be used."""


class Value(str):
    """A value of a file; a format such as `.2f` takes it as a number."""

    def __format__(self, spec):
        return format(float(self), spec) if spec else str(self)


def read(path):
    """Return the comments of a file of data, by key, and its rows."""
    if not path.is_file():
        raise Fault("there is no %s" % path.name)
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line[1:].partition(":") for line in lines if line.startswith("#")]
    about = {key.strip(): value.strip() for key, _, value in comments}
    for key in KEYS:
        if not about.get(key):
            raise Fault("%s lacks `# %s: …`" % (path.name, key))
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    if not rows or any(None in row or None in row.values() for row in rows):
        raise Fault("%s has no rows, or rows of different lengths" % path.name)
    return about, [{key: Value(value) for key, value in row.items()} for row in rows]


def pairs(text):
    """Return the parts of `a = b | c = d`."""
    return [[side.strip() for side in part.split(" = ", 1)] for part in text.split(" | ")]


def options(text):
    """Return the options of a marker."""
    found = dict(line.strip().partition(": ")[::2] for line in text.splitlines() if line.strip())
    if any(key not in OPTIONS for key in found):
        raise Fault("an option is not one of %s" % ", ".join(OPTIONS))
    return found


def cell(template, row):
    """Fill in a template; empty where one of its values is."""
    used = re.findall(r"{(\w+)", template)
    return "" if any(row[key] == "" for key in used) else template.format(**row).replace("|", "\\|")


def table(path, text):
    """Return the lines of a table of the file `path` by a marker's options."""
    about, rows = read(path)
    chosen = options(text)
    try:
        for key, values in pairs(chosen["rows"]) if "rows" in chosen else []:
            rows = [row for row in rows if row[key] in values.split(", ")]
        all_of_them = " | ".join("%s = {%s}" % (key, key) for key in rows[0]) if rows else ""
        columns = pairs(chosen.get("columns", all_of_them))
        cells = [[cell(template, row) for row in rows] for _, template in columns]
    except (KeyError, ValueError) as error:
        raise Fault("%s does not fit: %s" % (path.name, error)) from error
    if not rows:
        raise Fault("no row of %s is chosen" % path.name)
    numbers = [all(re.match(r"[-+−]?\d|$", one) for one in column) for column in cells]
    rule = "|".join("---:" if number else "---" for number in numbers)
    lines = ["| %s |" % " | ".join(title for title, _ in columns), "|%s|" % rule]
    lines += ["| %s |" % " | ".join(line) for line in zip(*cells)]
    return lines, about


def rewritten(page):
    """Return the text of a page as it is and as it should be."""
    old = page.read_text(encoding="utf-8")

    def marked(match):
        name, text, _ = match.groups()
        lines, about = table(page.parent / name, text)
        if options(text).get("source") != "no":
            lines += ["", "`%s`, %s ([data](%s))" % (about["command"], about["date"], name)]
        return "<!-- table: %s%s-->\n\n%s\n\n<!-- end of table -->" % (name, text, "\n".join(lines))

    if len(re.findall(r"^<!-- table:", old, re.MULTILINE)) != len(TABLE.findall(old)):
        raise Fault("a table has no end: `<!-- end of table -->`")
    return old, TABLE.sub(marked, old)


def pages():
    """Return all pages of the tree."""
    for folder, below, files in os.walk(ROOT):
        below[:] = sorted(name for name in below if name[0] != "." and name not in SKIPPED)
        yield from (Path(folder, name) for name in sorted(files) if name.endswith(".md"))


def main():
    parser = argparse.ArgumentParser(prog="tools/tables", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", type=Path, metavar="PAGE.md", help="pages [all]")
    parser.add_argument("--check", action="store_true", help="change nothing")
    parser.add_argument("--self-test", action="store_true", help="test this tool")
    chosen = parser.parse_args()
    if chosen.self_test:
        result = unittest.TextTestRunner().run(unittest.TestLoader().discover(str(HERE), "tests.py"))
        return 0 if result.wasSuccessful() and result.testsRun > 0 else 1
    status, place = 0, ROOT
    try:
        for place in sorted(ROOT.glob("docs/data/*.csv")):
            read(place)
        for place in chosen.pages or pages():
            old, new = rewritten(place)
            if old != new and chosen.check:
                print("tables: %s is out of date: run `python3 tools/tables`" % place, file=sys.stderr)
                status = 1
            elif old != new:
                place.write_text(new, encoding="utf-8")
    except (Fault, OSError) as error:
        print("tables: %s: %s" % (place, error), file=sys.stderr)
        status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
