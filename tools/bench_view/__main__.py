"""Measures the cost of watching a render: samples per second with and without clients.

    python3 tools/bench_view                    a table, in Markdown; some four minutes
    python3 tools/bench_view --clients 64       other numbers of clients

One `bidir view` renders all the time. Measurements with and without clients alternate in pairs, whose
order changes from pair to pair. Clients receive every frame; one of them connects and never reads. All
run on the rendering machine, so that their own cost counts, too. Speed is the number of whole passes per
time between their ends. The processor time of the server per sample is less sensitive to other programs,
but excludes the cost of the clients. The exit code is 0, 1 if the server failed, and 2 if the command line
is wrong or there is no program. Needs Linux; standard library only.
"""

import os
import sys

sys.dont_write_bytecode = True
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import harness
import server

NAME = "bench_view"


def arguments():
    parser = harness.parser(NAME, __doc__)
    harness.add_program(parser)
    add = parser.add_argument
    add("--scene", default=str(harness.ROOT / "scenes" / "cornell.pbrt"), help="what is rendered [%(default)s]")
    add("--size", default="512x512", help="the film [%(default)s]")
    add("--clients", type=int, default=5, help="one of them never reads [%(default)s]")
    add("--seconds", type=float, default=10.0, help="of each half of a pair [%(default)s]")
    add("--pairs", type=int, default=12, help="how often both are measured [%(default)s]")
    return parser.parse_args()


def run(options):
    rates = {True: [], False: []}
    with server.View(options.bidir, options.scene, options.size) as view:
        view.settle()
        for watched in harness.turns([True, False], options.pairs):
            with server.Clients(view, options.clients if watched else 0):
                rates[watched].append(view.rate(options.seconds))
            if len(rates[True]) == len(rates[False]):
                print("pair %d: %.3f of the speed, %.3f of the processor time" % (
                    len(rates[True]), *ratios(rates[False][-1], rates[True][-1])), file=sys.stderr, flush=True)
        print(table(rates[False], rates[True], view.memory(), options.clients))


def ratios(alone, watched):
    """Returns the speed and the processor time with clients relative to those without."""
    return tuple(b / a for a, b in zip(alone, watched))


def table(alone, watched, memory, clients):
    """Formats the rates of all pairs, and the server's first, last and largest memory in bytes."""
    first, last, most = ("%.0f MB" % (size / 1e6) for size in memory)
    speeds = ("%.0f k" % (harness.medians(rates)[0] / 1e3) for rates in (alone, watched))
    speed, cost = map(harness.interval, zip(*map(ratios, alone, watched)))
    return harness.table(["%d pairs" % len(alone), "alone", "watched"], [
        ["clients, one of which never reads", 0, clients],
        ["samples per second, median", *speeds],
        ["the same of the pair", 1, speed],
        ["processor time of the server for a sample, of the pair", 1, cost],
        ["memory of the server: at first; at last, at most", first, "%s, %s" % (last, most)],
    ])


if __name__ == "__main__":
    sys.exit(harness.main(NAME, arguments(), run))
