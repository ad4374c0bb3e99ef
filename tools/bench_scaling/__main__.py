"""Measures speed and memory against threads, triangles, instances, pixels, lights and bounces.

    python3 tools/bench_scaling                 all tables, in Markdown; some five minutes
    python3 tools/bench_scaling --only lights   one of them
    python3 tools/bench_scaling --self-test     tests of this tool, which need no program

The scenes are generated each time, except two of the project's own. Figures are medians over rounds in
which all cases take turns; columns `of the first` are ratios within a table. The exit code is 0, 1 if a
render failed, and 2 if the command line is wrong or there is no program. Needs Linux or macOS; standard
library only.
"""

import os
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import harness
import runs
import sweeps
import worlds

NAME = "bench_scaling"


def arguments():
    parser = harness.parser(NAME, __doc__)
    harness.add_program(parser)
    parser.add_argument("--only", choices=list(sweeps.SWEEPS), help="one table")
    parser.add_argument("--seconds", type=float, default=0.5, help="of each render [%(default)s]")
    parser.add_argument("--rounds", type=int, default=3, help="renders of each case [%(default)s]")
    parser.add_argument("--self-test", nargs=0, action=harness.SelfTest, help="test this tool")
    return parser.parse_args()


def run(options):
    print(harness.machine())
    for name in [options.only] if options.only else sweeps.SWEEPS:
        with tempfile.TemporaryDirectory() as folder:
            sweep = sweeps.SWEEPS[name](worlds.Folder(folder))
            print("measuring: %s" % name, file=sys.stderr, flush=True)
            costs = runs.measure(options, folder, sweep.cases)
            print("\n%s\n\n%s" % (sweep.title, sweep.table(costs)), flush=True)


if __name__ == "__main__":
    sys.exit(harness.main(NAME, arguments(), run))
