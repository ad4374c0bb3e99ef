"""Measures speed and memory against threads, triangles, instances, pixels, lights and bounces.

    python3 tools/bench_scaling                 all tables, in Markdown; some five minutes
    python3 tools/bench_scaling --only lights   one of them
    python3 tools/bench_scaling --self-test     tests of this tool, which need no program

The scenes are generated each time, except two of the project's own. Figures are medians over rounds in
which all cases take turns; columns `of the first` are ratios within a table. The exit code is 0, 1 if a
render failed, and 2 if the command line is wrong or there is no program. Needs Linux or macOS; standard
library only.
"""

import argparse
import os
import platform
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

import runs
import sweeps
import worlds

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
TARGET = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))


def arguments():
    parser = argparse.ArgumentParser(prog="tools/bench_scaling", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--bidir", default=os.path.join(TARGET, "release", "bidir"), metavar="PROGRAM",
        help="the program that is measured [%(default)s]")
    add("--only", choices=list(sweeps.SWEEPS), help="one table")
    add("--seconds", type=float, default=0.5, help="of each render [%(default)s]")
    add("--rounds", type=int, default=3, help="renders of each case [%(default)s]")
    add("--self-test", action="store_true", help="test this tool")
    return parser.parse_args()


def machine():
    """Describes the processor in a line."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = re.search(r"model name\s*: (.*)", file.read())[1]
    except (OSError, TypeError):
        pass
    return "%s, %d processors" % (model, os.cpu_count())


def self_test():
    loader = unittest.TestLoader()
    result = unittest.TextTestRunner().run(loader.discover(HERE, "tests.py"))
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


def run(options):
    print(machine())
    for name, sweep in sweeps.SWEEPS.items():
        if options.only not in (None, name):
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = sweep(worlds.Folder(folder), os.path.join(ROOT, "scenes"))
            print("measuring: %s" % name, file=sys.stderr, flush=True)
            runner = runs.Runner(options.bidir, folder, options.seconds, options.rounds)
            print("\n%s\n\n%s" % (found.title, found.table(runner.measure(found.cases))),
                  flush=True)
    return 0


def main():
    options = arguments()
    if options.self_test:
        return self_test()
    if not os.path.exists(options.bidir):
        print("bench_scaling: there is no %s: run `cargo build --release`" % options.bidir,
              file=sys.stderr)
        return 2
    try:
        return run(options)
    except runs.Failed as error:
        print("bench_scaling: %s" % error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
