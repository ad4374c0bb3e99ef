"""A test of the tests: applies faults one by one; each must make a test fail.

    python3 tools/mutants                 all of them; exits with 1 if one survives
    python3 tools/mutants --only TEXT     those whose name, file or test contains TEXT
    python3 tools/mutants --share 1/4     the second of four shares of them
    python3 tools/mutants --list          names, files and tests
    python3 tools/mutants --check         only that every fault still applies to the sources

Nearly all faults share one build (schemata.py). A fault that does not fit into it, or that survives there,
gets a build of its own. The tool works on copies of the tree in target/mutants and keeps their builds
between runs. Standard library only.
"""

import argparse
import fcntl
import functools
import os
import re
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True

import schemata
from mutations import MUTATIONS

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
WORK = os.path.join(os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target")), "mutants")
# The tree with all faults, and the tree that has one at a time.
ALL = os.path.join(WORK, "all")
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
    for top in ("crates", "scenes", "experiments", "fuzz/src", "fuzz/seeds"):
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


def copy_tree(tree, changed=None):
    """Brings a copy up to date, `changed` (file -> bytes) in place of the sources where given.

    Files that are the same keep their time, and so their build.
    """
    wanted, changed = set(sources()), changed or {}
    for file in wanted:
        data, target = changed.get(file) or read(os.path.join(ROOT, file)), os.path.join(tree, file)
        if not os.path.isfile(target) or read(target) != data:
            write(target, data)
    for folder, _, names in os.walk(tree):
        for name in names:
            path = os.path.join(folder, name)
            if os.path.relpath(path, tree) not in wanted:
                os.remove(path)


def cargo(tree, test, *arguments, number=0, timeout=TIMEOUT):
    """Runs `cargo test` on a copy: (exit code or None for a timeout, output)."""
    package, target, filter_ = test
    command = ["cargo", "test", "--release", "--quiet", "-p", package]
    command += target.split() + list(arguments)
    if "--no-run" not in arguments:
        command += ["--", filter_] if filter_ else []
    environment = dict(os.environ, CARGO_TARGET_DIR=os.path.join(WORK, "build"))
    environment[schemata.VARIABLE] = str(number)
    # A shrunk counterexample of a mutant is no regression of the project.
    environment["PROPTEST_DISABLE_FAILURE_PERSISTENCE"] = "1"
    # From one mutant of its own to the next one file differs.
    environment["CARGO_INCREMENTAL"] = "1" if tree == TREE else "0"
    with subprocess.Popen(
        command,
        cwd=tree,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    ) as run:
        try:
            output, _ = run.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            return None, ""
        finally:
            end_session(run)
    return run.returncode, output.decode(errors="replace")


def end_session(run):
    """Kills what runs in the session of `run`: the test that a stopped cargo started would go on for ever."""
    try:
        os.killpg(run.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def passed(output):
    """Returns the number of passed tests."""
    return sum(int(count) for count in re.findall(r"(\d+) passed", output))


@functools.cache
def tests_of(package):
    """The paths of a package's tests as far as its files give them, each as `module::…::name`."""
    found = []
    top = os.path.join(ROOT, "crates", package.removeprefix("bidir-"))
    for folder, _, names in os.walk(top):
        for name in names:
            if not name.endswith(".rs"):
                continue
            path = os.path.relpath(os.path.join(folder, name), top)
            module = re.sub(r"^(src|tests/[^/]+)/|(/mod)?\.rs$", "", path).replace("/", "::")
            code = read(os.path.join(folder, name)).decode()
            tests = re.findall(r"#\[test\]\s+(?:#\[[^\]]*\]\s+)*fn (\w+)|^\s+fn (\w+)\(", code, re.MULTILINE)
            for test in (one or other for one, other in tests):
                found += [module + "::" + test, module + "::tests::" + test]
    return found


def stale(mutation):
    """Returns the reason why a fault cannot be applied or detected. None: it can."""
    _, file, old, new, (package, _, filter_) = mutation
    if filter_ and not any(filter_ in test for test in tests_of(package)):
        return "no test is named `%s`" % filter_
    path = os.path.join(ROOT, file)
    if not os.path.isfile(path):
        return "no such file"
    count = read(path).decode().count(old)
    if count != 1:
        return "its text occurs %d times" % count
    return "changes nothing" if old == new else None


def baselines(tree, tests):
    """The seconds of each test on a tree whose faults are off; ends the program where one fails."""
    seconds = {}
    for test in sorted(tests):
        begin = time.monotonic()
        code, output = cargo(tree, test)
        if code != 0:
            sys.exit("%s: fails without any mutant:\n%s" % (describe(test), output[-3000:]))
        if passed(output) == 0:
            sys.exit("%s: has no tests" % describe(test))
        seconds[test] = time.monotonic() - begin
        print("baseline %-70s %6.0f s" % (describe(test), seconds[test]), flush=True)
    return seconds


def number_of(mutation):
    """The number of a fault in the shared build; 0 is none."""
    return MUTATIONS.index(mutation) + 1


def all_faults(mutations):
    """The sources that hold faults, changed (file -> bytes), and the faults that they hold."""
    changed, held = {}, []
    for file in sorted({mutation[1] for mutation in mutations}):
        faults = [(number_of(m), m[2], m[3]) for m in mutations if m[1] == file]
        text, taken = schemata.with_faults(read(os.path.join(ROOT, file)).decode(), faults)
        if taken:
            changed[file] = text.encode()
            held += [m for m in mutations if number_of(m) in taken]
    for crate in {os.path.join(*file.split("/")[:2]) for file in changed}:
        root = os.path.join(crate, "src", "lib.rs")
        whole = changed.get(root) or read(os.path.join(ROOT, root))
        changed[root] = whole + schemata.CHOICE.encode()
    return changed, held


def build_all(mutations):
    """Builds the tree that has the faults to choose from; returns those that it has.

    A file whose changes do not compile is left as it is.
    """
    while mutations:
        changed, mutations = all_faults(mutations)
        copy_tree(ALL, changed)
        wrong, output = set(), ""
        for package, target, _ in sorted({(m[4][0], m[4][1], "") for m in mutations}):
            build = (package, target, "")
            code, output = cargo(ALL, build, "--no-run", "--message-format=short", timeout=None)
            if code != 0:
                wrong |= set(re.findall(r"^(crates/\S+\.rs):\d+:\d+: error", output, re.MULTILINE))
                break
        else:
            return mutations
        rest = [m for m in mutations if m[1] not in wrong]
        if len(rest) == len(mutations):
            sys.exit("the faults do not compile:\n" + output[-3000:])
        mutations = rest
    return []


def run_in_all(mutation, seconds):
    """Returns True if a fault of the shared build makes its test fail, or run ten times as long."""
    timeout = 60 + 10 * seconds[mutation[4]]
    return cargo(ALL, mutation[4], number=number_of(mutation), timeout=timeout)[0] != 0


def run_alone(mutation):
    """killed, SURVIVED or BROKEN, with the reason of the latter."""
    _, file, old, new, test = mutation
    path = os.path.join(TREE, file)
    original = read(path)
    write(path, original.decode().replace(old, new).encode())
    try:
        code, output = cargo(TREE, test, "--no-run")
        if code != 0:
            return "BROKEN", "does not compile:\n" + output[-3000:]
        code, output = cargo(TREE, test)
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
    mutations = [m for m in MUTATIONS if arguments.only in " ".join((m[0], m[1], describe(m[4])))]
    mutations = mutations[arguments.share]
    if not mutations:
        sys.exit("no mutant has a name, a file or a test with `%s`" % arguments.only)
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
    alive = run(mutations)
    lock.close()
    print("%d of %d mutants killed" % (len(mutations) - alive, len(mutations)))
    sys.exit(1 if alive else 0)


def report(verdict, mutation, begin):
    seconds = time.monotonic() - begin
    line = (verdict, mutation[0], describe(mutation[4]), seconds)
    print("%-8s %-60s %-44s %5.0f s" % line, flush=True)


def run(mutations):
    """Applies faults, prints a line for each, and returns how many survived."""
    begin = time.monotonic()
    together = build_all(mutations)
    print("%d faults in one build, %.0f s" % (len(together), time.monotonic() - begin), flush=True)
    seconds = baselines(ALL, {m[4] for m in together})
    alone = [m for m in mutations if m not in together]
    for mutation in together:
        begin = time.monotonic()
        if run_in_all(mutation, seconds):
            report("killed", mutation, begin)
        else:
            alone.append(mutation)
    if alone:
        copy_tree(TREE)
        baselines(TREE, {m[4] for m in alone})
    alive = 0
    for mutation in alone:
        begin = time.monotonic()
        verdict, reason = run_alone(mutation)
        alive += verdict != "killed"
        report(verdict, mutation, begin)
        if reason:
            print(reason, flush=True)
    return alive


if __name__ == "__main__":
    main()
