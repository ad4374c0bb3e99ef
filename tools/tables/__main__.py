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

A column is a title and a template over the columns of the file; `rows` takes those with these
values, in this order. The line below the table names command, date and file unless `source` is `no`.
A file of data begins with the comments `# command: …`, `# date: …`, `# version: …`, `# machine: …`.
"""

import csv
import os
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.append(str(Path(__file__).resolve().parents[1]))

import harness

KEYS = ("command", "date", "version", "machine")
SKIPPED = ("node_modules", "target")
TABLE = re.compile(r"^<!-- table: (\S+)(.*?)-->$.*?^<!-- end of table -->$", re.DOTALL | re.MULTILINE)


class Fault(Exception):
    """A marker or a file of data cannot be used."""


class Value(str):
    """A value of a file; a format such as `.2f` takes it as a number."""

    def __format__(self, spec):
        return format(float(self), spec) if spec else str(self)


def read(path):
    """Return the comments of a file of data, by key, and its rows."""
    lines = path.read_text(encoding="utf-8").splitlines()
    about = dict(line[2:].partition(": ")[::2] for line in lines if line.startswith("# "))
    if missing := [key for key in KEYS if not about.get(key)]:
        raise Fault("%s lacks `# %s: …`" % (path.name, missing[0]))
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
    if not found.keys() <= {"columns", "rows", "source"}:
        raise Fault("a table has options other than columns, rows and source")
    return found


def cell(template, row):
    """Fill in a template; empty where one of its values is."""
    used = re.findall(r"{(\w+)", template)
    return "" if any(row[key] == "" for key in used) else template.format(**row).replace("|", "\\|")


def table(name, rows, chosen):
    """Return the lines of a table of these rows by a marker's options."""
    try:
        for key, values in pairs(chosen["rows"]) if "rows" in chosen else []:
            wanted = values.split(", ")
            if missing := set(wanted) - {row[key] for row in rows}:
                raise Fault("no row of %s has %s = %s" % (name, key, missing.pop()))
            rows = [row for value in wanted for row in rows if row[key] == value]
        columns = pairs(chosen.get("columns", " | ".join("%s = {%s}" % (key, key) for key in rows[0])))
        cells = [[cell(template, row) for row in rows] for _, template in columns]
    except (KeyError, ValueError) as error:
        raise Fault("a column does not fit %s: %s" % (name, error)) from error
    numbers = [all(re.match(r"[-+−]?\d|$", one) for one in column) for column in cells]
    rule = "|".join("---:" if number else "---" for number in numbers)
    lines = ["| %s |" % " | ".join(line) for line in [[title for title, _ in columns], *zip(*cells)]]
    return [lines[0], "|%s|" % rule, *lines[1:]]


def rewritten(page):
    """Return the text of a page as it is and as it should be."""
    old = page.read_text(encoding="utf-8")

    def marked(match):
        name, chosen = match[1], options(match[2])
        about, rows = read(page.parent / name)
        lines = table(name, rows, chosen)
        if chosen.get("source") != "no":
            lines += ["", "`%s`, %s ([data](%s))" % (about["command"], about["date"], name)]
        lines = [match[0].partition("-->")[0] + "-->", "", *lines, "", "<!-- end of table -->"]
        return "\n".join(lines)

    if len(re.findall(r"^<!-- table:", old, re.MULTILINE)) != len(TABLE.findall(old)):
        raise Fault("a table has no end: `<!-- end of table -->`")
    return old, TABLE.sub(marked, old)


def pages():
    """Return all pages of the tree."""
    for folder, below, files in os.walk(harness.ROOT):
        below[:] = sorted(name for name in below if name[0] != "." and name not in SKIPPED)
        yield from (Path(folder, name) for name in sorted(files) if name.endswith(".md"))


def main():
    parser = harness.parser("tables", __doc__)
    parser.add_argument("pages", nargs="*", type=Path, metavar="PAGE.md", help="pages [all]")
    parser.add_argument("--check", action="store_true", help="change nothing")
    parser.add_argument("--self-test", nargs=0, action=harness.SelfTest, help="test this tool")
    args = parser.parse_args()
    faults = []
    for place in [*sorted(harness.ROOT.glob("docs/data/*.csv")), *(args.pages or pages())]:
        name = os.path.relpath(place)
        try:
            old, new = rewritten(place) if place.suffix == ".md" else (read(place),) * 2
            if old != new and args.check:
                faults.append("%s is out of date: run `python3 tools/tables`" % name)
            elif old != new:
                place.write_text(new, encoding="utf-8")
        except (Fault, OSError) as error:
            faults.append("%s: %s" % (name, error))
    for fault in faults:
        print("tables: %s" % fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
