"""What benches share: command lines, runs of the program, turns, medians, and tables in Markdown.

A bench is a folder with a `__main__.py` and, if it tests itself, a `tests.py`. Standard library only.
"""

import argparse
import json
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
# The system's unit of memory. Unit: bytes.
RSS_UNIT = 1 if sys.platform == "darwin" else 1024


class Failed(Exception):
    """A run gave no figures."""


def parser(name, description):
    """Returns the parser of the command line of a tool."""
    return argparse.ArgumentParser(prog="tools/" + name, description=description,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)


def add_program(to):
    """Adds the options of benches that measure the command."""
    default = str(TARGET / "release" / "bidir")
    to.add_argument("--bidir", default=default, metavar="PROGRAM", help="the program that is measured [%(default)s]")


def main(name, options, run):
    """Runs a bench of the command. Returns the exit code."""
    try:
        if not os.path.exists(options.bidir):
            return complain(name, f"there is no {options.bidir}: run `cargo build --release`")
        return run(options) or 0
    except (Failed, OSError) as error:
        complain(name, error)
        return 1


def complain(name, problem):
    """Prints a problem, and returns the exit code of mistakes on the command line."""
    print(f"{name}: {problem}", file=sys.stderr)
    return 2


class SelfTest(argparse.Action):
    """Runs the tests of a tool, and ends it: `add_argument("--self-test", nargs=0, action=SelfTest)`."""

    def __call__(self, parser, *_):
        tests = unittest.TestLoader().discover(str(ROOT / parser.prog), "tests.py")
        result = unittest.TextTestRunner().run(tests)
        parser.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 1)


class Usage(NamedTuple):
    """Means of a process."""

    #: Of all threads together. Unit: s.
    cpu: float
    #: Unit: s.
    wall: float
    #: The most memory that was resident. Unit: bytes.
    peak: float


def environment(**variables):
    """Returns the caller's variables without settings of the program, which would change the figures."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("BIDIR_")}
    return kept | variables


def run(command, **variables):
    """Runs a command. Returns its Usage; raises Failed with its output."""
    begin = time.monotonic()
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(command, env=environment(**variables), stdout=said, stderr=said)
        # Unlike `wait`, this returns the memory of this child only.
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            said.seek(0)
            raise Failed(f"{' '.join(command)}: {said.read().decode(errors='replace')}")
    wall = time.monotonic() - begin
    return Usage(usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss * RSS_UNIT)


def render(command, folder, scene, *flags, **variables):
    """Renders with a command that ends in the program. Returns the numbers of `--stats`, and the Usage."""
    image, stats = (os.path.join(folder, name) for name in ("image.exr", "stats.json"))
    usage = run([*command, "render", str(scene), "-q", "-o", image, "--stats", stats, *flags], **variables)
    return json.loads(Path(stats).read_text(encoding="utf-8")), usage


def processor_time(pid):
    """Returns the user and system time of all threads of a process; OSError where the system has no /proc."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def turns(cases, rounds):
    """Yields all cases in each round, so that other work affects all of them; every second in reverse."""
    for number in range(rounds):
        yield from cases if number % 2 == 0 else reversed(cases)


def medians(rows):
    """Returns the median of each column."""
    return [statistics.median(column) for column in zip(*rows)]


def median_interval(values):
    """Returns bounds of the median with a confidence of at least 95 %.

    They are order statistics, by the binomial distribution of the number of values below the median.
    """
    ordered, count = sorted(values), len(values)
    # The probability that at most `rank` of the values are below the median, and the term that comes next.
    below, term, rank = 0.0, 0.5**count, 0
    while rank < count // 2 and below + term <= 0.025:
        below += term
        rank += 1
        term *= (count - rank + 1) / rank
    rank = max(rank - 1, 0)
    return ordered[rank], ordered[count - 1 - rank]


def interval(values):
    """Formats the median with its bounds."""
    return "{:.3f} ({:.3f} to {:.3f})".format(statistics.median(values), *median_interval(values))


def table(head, rows):
    """Formats cells as Markdown; the first column has names, the others have numbers."""
    first, *others = (f"| {' | '.join(map(str, cells))} |" for cells in (head, *rows))
    return "\n".join([first, "|---|" + "---:|" * (len(head) - 1), *others])


def machine():
    """Describes the processor in a line."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = re.search(r"model name\s*: (.*)", file.read())[1]
    except (OSError, TypeError):
        pass
    return f"{model}, {os.cpu_count()} processors"
