"""Attacks the program: kills it, lets system calls fail, damages its inputs, and strains its limits.

    python3 tools/attack                  the whole campaign: some two hours
    python3 tools/attack --minute         a little of every part
    python3 tools/attack PART...          some parts, such as kills
    python3 tools/attack --self-test      tests of this tool, which need no program

A case passes if the program ends by itself within its time and memory, with an exit code of
docs/reference/cli.md, and if its results are right; an error with a message passes. A table ends the
campaign. Failures are kept as files in target/attack/SEED/PART, with the command. The same seed makes
the same cases, but for the moments of kills. The exit code is 1 if a case failed.
Needs Linux or macOS and a built bidir; standard library only.
"""

import importlib
import os
import shutil
import sys
import time
import traceback

sys.dont_write_bytecode = True
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import harness
import part

TARGET = harness.TARGET.absolute()
# Parts, with the cases of a night and of a minute.
PARTS = {
    "kills": (1000, 20),
    "faults": (3000, 60),
    "mutations": (1_000_000, 10_000),
    "files": (6000, 60),
    "bombs": (1000, 6),
    "scale": (1000, 6),
    "extremes": (1000, 12),
}


def arguments():
    parser = harness.parser("attack", __doc__)
    harness.add_program(parser)
    add = parser.add_argument
    add("parts", nargs="*", metavar="PART", help="which of %s [all]" % ", ".join(PARTS))
    add("--minute", action="store_true", help="few cases")
    add("--count", type=int, metavar="N", help="cases of each part, instead")
    add("--seed", type=int, default=int(time.time()), metavar="N", help="random seed [the time]")
    add("--mutations", default=str(TARGET / "release" / "examples" / "mutations"),
        metavar="PROGRAM", help="the example `mutations` of bidir-lab [%(default)s]")
    add("--self-test", nargs=0, action=harness.SelfTest, help="test this tool")
    options = parser.parse_args()
    unknown = [name for name in options.parts if name not in PARTS]
    if unknown:
        parser.error("there is no part %s; the parts are %s" % (unknown[0], ", ".join(PARTS)))
    options.parts = options.parts or list(PARTS)
    options.bidir, options.mutations = map(os.path.abspath, (options.bidir, options.mutations))
    options.out = str(TARGET / "attack" / str(options.seed))
    options.counts = {name: options.count or counts[options.minute] for name, counts in PARTS.items()}
    return options


def attack(name, options):
    """Runs a part to its end. Returns the cells of the table, and the number of failures."""
    work = part.Part(name, options)
    shutil.rmtree(work.out, ignore_errors=True)
    try:
        importlib.import_module(name).run(work)
    except Exception:
        # A fault of this tool must not hide the results of the other parts.
        work.case("the tool", traceback.format_exc())
    row = work.row()
    print(*row, sep="  ", flush=True)
    return row, work.failures


def run(options):
    print("seed %d, %s" % (options.seed, options.bidir), flush=True)
    rows, failures = zip(*(attack(name, options) for name in options.parts))
    total = ["total", sum(row[1] for row in rows), sum(failures), sum(row[3] for row in rows)]
    print("\nSeed %d.\n\n%s" % (options.seed, harness.table(["part", "cases", "failures", "seconds"], [*rows, total])))
    if any(failures):
        print("\nFailures are in %s." % options.out)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(harness.main("attack", arguments(), run))
