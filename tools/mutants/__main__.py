"""A test of the tests: applies one fault after another, each of which must turn some test red.

    python3 tools/mutants                 all of them; exits with 1 if one survives
    python3 tools/mutants --only TEXT     those whose name or test contains TEXT
    python3 tools/mutants --share 1/4     the second of four shares of them
    python3 tools/mutants --list          names, files and tests
    python3 tools/mutants --check         only that every fault still applies to the sources

Works on a copy of the tree in target/mutants, whose build is kept between runs. Standard library
only.
"""

import argparse
import fcntl
import os
import re
import subprocess
import sys
import time

sys.dont_write_bytecode = True

from mutations import MUTATIONS

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
WORK = os.path.join(os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target")), "mutants")
TREE = os.path.join(WORK, "tree")
TIMEOUT = 900


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def sources():
    """The files that a build or a test reads, relative to the root."""
    files = ["Cargo.toml", "Cargo.lock", "clippy.toml"]
    for top in ("crates", "scenes"):
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            files += [os.path.relpath(os.path.join(folder, name), ROOT) for name in names]
    return sorted(file for file in files if os.path.isfile(os.path.join(ROOT, file)))


def lock_tree():
    """Two runs on one copy would undo each other's faults: the lock lasts as long as the file."""
    os.makedirs(WORK, exist_ok=True)
    lock = open(os.path.join(WORK, "lock"), "w")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        sys.exit("another run is using %s" % WORK)
    return lock


def copy_tree():
    """Brings the copy up to date; files that are the same keep their time, and so their build."""
    wanted = set(sources())
    for file in wanted:
        data, target = read(os.path.join(ROOT, file)), os.path.join(TREE, file)
        if not os.path.isfile(target) or read(target) != data:
            write(target, data)
    for folder, _, names in os.walk(TREE):
        for name in names:
            path = os.path.join(folder, name)
            if os.path.relpath(path, TREE) not in wanted:
                os.remove(path)


def cargo(test, *arguments):
    """Runs `cargo test` on the copy: (exit code or None for a timeout, output)."""
    package, target, filter_ = test
    command = ["cargo", "test", "--release", "--quiet", "-p", package]
    command += target.split() + list(arguments)
    if "--no-run" not in arguments:
        command += ["--", filter_] if filter_ else []
    environment = dict(os.environ, CARGO_TARGET_DIR=os.path.join(WORK, "build"))
    # A shrunk counterexample of a mutant is no regression of the project.
    environment["PROPTEST_DISABLE_FAILURE_PERSISTENCE"] = "1"
    # One file differs from mutant to mutant.
    environment["CARGO_INCREMENTAL"] = "1"
    try:
        run = subprocess.run(
            command,
            cwd=TREE,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, ""
    return run.returncode, run.stdout.decode(errors="replace")


def passed(output):
    """How many tests passed."""
    return sum(int(count) for count in re.findall(r"(\d+) passed", output))


def stale(mutation):
    """Why a fault cannot be applied; None where it can."""
    _, file, old, new, _ = mutation
    path = os.path.join(ROOT, file)
    if not os.path.isfile(path):
        return "no such file"
    count = read(path).decode().count(old)
    if count != 1:
        return "its text occurs %d times" % count
    return "changes nothing" if old == new else None


def check_baseline(test):
    """Why a test says nothing about mutants; None where it passes on the tree as it is."""
    code, output = cargo(test)
    if code != 0:
        return "fails without any mutant:\n" + output[-3000:]
    return None if passed(output) > 0 else "has no tests"


def run_mutant(mutation):
    """killed, SURVIVED or BROKEN, with the reason of the latter."""
    _, file, old, new, test = mutation
    path = os.path.join(TREE, file)
    original = read(path)
    write(path, original.decode().replace(old, new).encode())
    try:
        code, output = cargo(test, "--no-run")
        if code != 0:
            return "BROKEN", "does not compile:\n" + output[-3000:]
        code, output = cargo(test)
    finally:
        write(path, original)
    return ("SURVIVED", "") if code == 0 else ("killed", "")


def share(text):
    """The shares `I/N` of a list: every N-th entry, from number I on."""
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not int(found[1]) < int(found[2]):
        raise argparse.ArgumentTypeError("`%s` is no share such as 1/4, from 0/4 to 3/4" % text)
    return slice(int(found[1]), None, int(found[2]))


def describe(test):
    return " ".join(part for part in test if part)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", metavar="TEXT", default="")
    parser.add_argument("--share", metavar="I/N", type=share, default=slice(None))
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    mutations = [m for m in MUTATIONS if arguments.only in m[0] + " " + describe(m[4])]
    mutations = mutations[arguments.share]
    if not mutations:
        sys.exit("no mutant has a name or a test with `%s`" % arguments.only)
    if arguments.list:
        for name, file, _, _, test in mutations:
            print("%-60s %-44s %s" % (name, file, describe(test)))
        return
    problems = [(m[0], stale(m)) for m in mutations if stale(m)]
    for name, problem in problems:
        print("%s: %s" % (name, problem), file=sys.stderr)
    if problems:
        sys.exit("%d of %d mutants do not apply" % (len(problems), len(mutations)))
    if arguments.check:
        print("%d mutants apply" % len(mutations))
        return
    lock = lock_tree()
    copy_tree()
    for test in sorted({m[4] for m in mutations}):
        begin = time.monotonic()
        problem = check_baseline(test)
        if problem:
            sys.exit("%s: %s" % (describe(test), problem))
        print("baseline %-70s %6.0f s" % (describe(test), time.monotonic() - begin), flush=True)
    alive = 0
    for mutation in mutations:
        begin = time.monotonic()
        verdict, reason = run_mutant(mutation)
        alive += verdict != "killed"
        seconds = time.monotonic() - begin
        print("%-8s %-60s %-44s %5.0f s" % (verdict, mutation[0], describe(mutation[4]), seconds))
        if reason:
            print(reason)
        sys.stdout.flush()
    lock.close()
    print("%d of %d mutants killed" % (len(mutations) - alive, len(mutations)))
    sys.exit(1 if alive else 0)


if __name__ == "__main__":
    main()
