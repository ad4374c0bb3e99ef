"""Measures the cost of watching a render: samples per second with and without clients.

    python3 tools/bench_view                    a table, in Markdown; some four minutes
    python3 tools/bench_view --clients 64       other numbers of clients
    python3 tools/bench_view --self-test        tests of this tool, which need no program

One `bidir view` renders all the time. Measurements with and without clients alternate in pairs, whose
order changes from pair to pair. Clients receive every frame; one of them connects and never reads. All
run on the rendering machine, so that their own cost counts, too. Speed is the number of whole passes per
time between their ends. The processor time of the server per sample is less sensitive to other programs,
but excludes the cost of the clients. The exit code is 0, 1 if the server failed, and 2 if the command line
is wrong or there is no program. Needs Linux; standard library only.
"""

import argparse
import os
import sys
import unittest

sys.dont_write_bytecode = True

import figures
import server

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
TARGET = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))


def arguments():
    parser = argparse.ArgumentParser(prog="tools/bench_view", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--bidir", default=os.path.join(TARGET, "release", "bidir"), metavar="PROGRAM",
        help="the program that is measured [%(default)s]")
    add("--scene", default=os.path.join(ROOT, "scenes", "cornell.pbrt"),
        help="what is rendered [%(default)s]")
    add("--size", default="512x512", help="the film [%(default)s]")
    add("--clients", type=int, default=5, help="one of them never reads [%(default)s]")
    add("--seconds", type=float, default=10.0, help="of each half of a pair [%(default)s]")
    add("--pairs", type=int, default=12, help="how often both are measured [%(default)s]")
    add("--self-test", action="store_true", help="test this tool")
    return parser.parse_args()


def measured(options):
    """Measures the rates of all pairs, and the memory of the server."""
    pairs = []
    with server.View(options.bidir, options.scene, options.size) as view:
        view.settle()
        for number in range(options.pairs):
            rates, frames = {}, 0
            for watched in (number % 2 == 0, number % 2 == 1):
                with server.Clients(view, options.clients if watched else 0) as clients:
                    rates[watched] = view.rate(options.seconds)
                    frames = max(frames, clients.frames())
            pairs.append(figures.Pair(rates[False], rates[True]))
            print("pair %d: %.3f of the speed, %.3f of the processor time, %d frames" %
                  (number, pairs[-1].speed(), pairs[-1].cost(), frames), file=sys.stderr, flush=True)
        return pairs, view.memory()


def self_test():
    loader = unittest.TestLoader()
    result = unittest.TextTestRunner().run(loader.discover(HERE, "tests.py"))
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


def main():
    options = arguments()
    if options.self_test:
        return self_test()
    if not os.path.exists(options.bidir):
        print("bench_view: there is no %s: run `cargo build --release`" % options.bidir,
              file=sys.stderr)
        return 2
    try:
        pairs, memory = measured(options)
    except (server.Failed, OSError) as error:
        print("bench_view: %s" % error, file=sys.stderr)
        return 1
    print(figures.table(pairs, memory, options.clients))
    return 0


if __name__ == "__main__":
    sys.exit(main())
