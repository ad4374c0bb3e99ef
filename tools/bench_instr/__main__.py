"""Instructions of samples and of their stages, counted by valgrind's callgrind.

    python3 tools/bench_instr               tables in Markdown, and changes since the stored figures
    python3 tools/bench_instr --check       the same; exits with 1 if a figure changed
    python3 tools/bench_instr --save        stores the figures in tools/bench_instr/figures.json
    python3 tools/bench_instr --self-test   tests of this tool, which need neither program nor valgrind

Counts do not depend on other work of the machine. The counts of renders with one and three samples per
pixel are subtracted, so that start, scene and image cancel; rays are traced with the instruction set that
every machine has. Changes above 3 % are shown. The exit code is 0 on success, 1 if a render failed or
`--check` found a change, 2 if the command line is wrong or there is no program, and 3 if valgrind is not
installed. Standard library only.
"""

import argparse
import os
import shutil
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

import figures
import measure

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
TARGET = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
KEPT = os.path.join(HERE, "figures.json")


def arguments():
    parser = argparse.ArgumentParser(prog="tools/bench_instr", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--bidir", default=os.path.join(TARGET, "release", "bidir"), metavar="PROGRAM",
        help="the program that is measured [%(default)s]")
    add("--only", default="", metavar="TEXT", help="rows whose scene and method contain this")
    add("--check", action="store_true", help="exit with 1 where a figure changed")
    add("--save", action="store_true", help="keep the figures")
    add("--self-test", action="store_true", help="test this tool")
    return parser.parse_args()


def self_test():
    loader = unittest.TestLoader()
    result = unittest.TextTestRunner().run(loader.discover(HERE, "tests.py"))
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


def run(options):
    measured = measure.Figures()
    with tempfile.TemporaryDirectory() as folder:
        bench = measure.Bench(options.bidir, os.path.join(ROOT, "scenes"), folder)
        for scene, method in measure.rows(options.only):
            print("counting: %s, %s" % (scene, method), file=sys.stderr, flush=True)
            bench.count(scene, method, measured)
    kept = figures.load(KEPT)
    new = figures.from_measured(measured, measure.made_with(options.bidir))
    print(figures.report(new, kept))
    changes = figures.changes(new, kept)
    if options.save:
        figures.save(KEPT, new)
    return 1 if options.check and changes else 0


def main():
    options = arguments()
    if options.self_test:
        return self_test()
    if options.save and options.only:
        print("bench_instr: --save keeps all figures: leave --only out", file=sys.stderr)
        return 2
    if not any(True for _ in measure.rows(options.only)):
        print("bench_instr: no row contains `%s`" % options.only, file=sys.stderr)
        return 2
    if shutil.which("valgrind") is None:
        print("bench_instr: skipped: valgrind is not installed", file=sys.stderr)
        return 3
    if not os.path.exists(options.bidir):
        print("bench_instr: there is no %s: run `cargo build --release`" % options.bidir,
              file=sys.stderr)
        return 2
    try:
        return run(options)
    except measure.Failed as error:
        print("bench_instr: %s" % error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
