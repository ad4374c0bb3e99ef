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

import os
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import figures
import harness
import measure

NAME = "bench_instr"


def arguments():
    parser = harness.parser(NAME, __doc__)
    harness.add_program(parser)
    parser.add_argument("--only", default="", metavar="TEXT", help="rows whose scene and method contain this")
    parser.add_argument("--check", action="store_true", help="exit with 1 where a figure changed")
    parser.add_argument("--save", action="store_true", help="keep the figures")
    parser.add_argument("--self-test", nargs=0, action=harness.SelfTest, help="test this tool")
    return parser.parse_args()


def run(options):
    rows = measure.rows(options.only)
    if not rows:
        return harness.complain(NAME, "no row contains `%s`" % options.only)
    if options.save and options.only:
        return harness.complain(NAME, "--save keeps all figures: leave --only out")
    if shutil.which("valgrind") is None:
        harness.complain(NAME, "skipped: valgrind is not installed")
        return 3
    new = {"made_with": measure.made_with(options.bidir), "samples": {}, "stages": {}, "functions": []}
    with tempfile.TemporaryDirectory() as folder:
        for scene, method in rows:
            print("counting: %s, %s" % (scene, method), file=sys.stderr, flush=True)
            measure.count(options.bidir, folder, (scene, method), new)
    kept = figures.load()
    print(figures.report(new, kept))
    if options.save:
        figures.save(new)
    return 1 if options.check and figures.changes(new, kept) else 0


if __name__ == "__main__":
    sys.exit(harness.main(NAME, arguments(), run))
