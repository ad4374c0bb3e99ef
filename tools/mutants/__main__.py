"""A test of the tests: applies faults in light transport one by one; each must make a test fail.

    python3 tools/mutants                 all of them; exits with 1 if one survives
    python3 tools/mutants --only TEXT     those whose name, file or test contains TEXT
    python3 tools/mutants --check         only that every fault still applies to the sources

All faults share one build (schemata.py) of a copy of the tree in target/mutants, which is kept between runs.
`tools/nightly SEED changed` has faults in all other code, made by cargo-mutants. Standard library only.
"""

import argparse
import functools
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True

import schemata
from mutations import MUTATIONS

ROOT = Path(__file__).resolve().parents[2]
WORK = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"), "mutants").absolute()
TREE = WORK / "tree"
# What a build or a test reads.
SOURCES = ("Cargo.toml", "Cargo.lock", "clippy.toml", "crates", "scenes", "experiments", "fuzz/src", "fuzz/seeds")


def files_in(root):
    """Returns the files that a build or a test reads, relative to `root`."""
    places = (root / source for source in SOURCES)
    found = (file for place in places for file in ([place] if place.is_file() else place.rglob("*")))
    return {file.relative_to(root) for file in found if file.is_file()}


def with_faults():
    """Returns the sources with faults, and the roots of their crates: {file: bytes}."""
    changed = {}
    for file in {mutation[1] for mutation in MUTATIONS}:
        faults = [(number, m[2], m[3]) for number, m in enumerate(MUTATIONS, 1) if m[1] == file]
        changed[Path(file)] = schemata.with_faults((ROOT / file).read_text(encoding="utf-8"), faults).encode()
    for root in {Path(*file.parts[:2], "src", "lib.rs") for file in changed}:
        changed[root] = changed.get(root, (ROOT / root).read_bytes()) + schemata.CHOICE.encode()
    return changed


def copy_tree():
    """Brings the copy up to date. Files that are the same keep their time, and so their build."""
    wanted, changed = files_in(ROOT), with_faults()
    for file in wanted:
        data, target = changed.get(file) or (ROOT / file).read_bytes(), TREE / file
        if not target.is_file() or target.read_bytes() != data:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)
    for file in files_in(TREE) - wanted:
        (TREE / file).unlink()


def cargo_test(test, *arguments, number=0, timeout=None):
    """Returns the exit code of tests with one of the faults, None for a timeout, and their output."""
    package, target, _ = test
    command = ["cargo", "test", "--release", "--quiet", "-p", package, *target.split(), *arguments]
    # A shrunk counterexample of a mutant is no regression of the project.
    environment = dict(os.environ, CARGO_TARGET_DIR=str(WORK / "build"), PROPTEST_DISABLE_FAILURE_PERSISTENCE="1")
    environment[schemata.VARIABLE] = str(number)
    with subprocess.Popen(command, cwd=TREE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, errors="replace", start_new_session=True) as run:
        try:
            output, _ = run.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            # With cargo the test that it started, which might go on for ever.
            os.killpg(run.pid, signal.SIGKILL)
            return None, ""
    return run.returncode, output


@functools.cache
def functions_of(package):
    """Returns the paths of a package's functions as far as its files give them, each as `module::…::name`."""
    found = []
    top = ROOT / "crates" / package.removeprefix("bidir-")
    for file in top.rglob("*.rs"):
        module = re.sub(r"^(src|tests/[^/]+)/|(/mod)?\.rs$", "", file.relative_to(top).as_posix())
        names = re.findall(r"\bfn (\w+)\(", file.read_text(encoding="utf-8"))
        found += [module.replace("/", "::") + inner + name for name in names for inner in ("::", "::tests::")]
    return found


def stale(mutation):
    """Returns the reason why a fault cannot be applied or detected. None: it can."""
    _, file, old, new, (package, _, filter_) = mutation
    if not any(filter_ in test for test in functions_of(package)):
        return "no test is named `%s`" % filter_
    text = (ROOT / file).read_text(encoding="utf-8") if (ROOT / file).is_file() else ""
    if text.count(old) != 1:
        return "its text occurs %d times" % text.count(old)
    place = text.index(old)
    if not schemata.body_around(text, place, place + len(old)):
        return "is not within a function whose body can be copied"
    return "changes nothing" if old == new else None


def baseline(test):
    """Returns the seconds of a test without a fault; ends the program if it fails."""
    cargo_test(test, "--no-run")
    begin = time.monotonic()
    code, output = cargo_test(test, "--", test[2])
    if code != 0 or not re.search(r"[1-9]\d* passed", output):
        sys.exit("%s: fails without any mutant, or has no tests:\n%s" % (" ".join(test), output[-3000:]))
    return time.monotonic() - begin


def run(mutations):
    """Applies faults, prints a line for each, and returns the number of those that survived."""
    copy_tree()
    seconds, alive = {}, 0
    for mutation in mutations:
        name, _, _, _, test = mutation
        if test not in seconds:
            seconds[test] = baseline(test)
        begin = time.monotonic()
        code, _ = cargo_test(test, "--", test[2], number=MUTATIONS.index(mutation) + 1,
                             timeout=60 + 10 * seconds[test])
        alive += code == 0
        verdict = "SURVIVED" if code == 0 else "killed"
        print("%-8s %-60s %-44s %5.0f s" % (verdict, name, " ".join(test), time.monotonic() - begin), flush=True)
    return alive


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="TEXT", default="")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    mutations = [m for m in MUTATIONS if options.only in " ".join((m[0], m[1], *m[4]))]
    if not mutations:
        sys.exit("no mutant has a name, a file or a test with `%s`" % options.only)
    problems = ["%s: %s" % (m[0], stale(m)) for m in MUTATIONS if stale(m)]
    if problems:
        sys.exit("\n".join([*problems, "%d of %d mutants do not apply" % (len(problems), len(MUTATIONS))]))
    if options.check:
        print("%d mutants apply" % len(mutations))
        return
    alive = run(mutations)
    print("%d of %d mutants killed" % (len(mutations) - alive, len(mutations)))
    sys.exit(1 if alive else 0)


if __name__ == "__main__":
    main()
