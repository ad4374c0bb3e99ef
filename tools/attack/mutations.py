"""Mutations of all kinds of inputs, read by the parsers in one process after the other.

The example `mutations` of bidir-lab makes and reads them, a million in minutes. Here its processes are
limited, and an input that ends one or that takes too long is found by the number that it leaves in a
file. `files` feeds some of the same kinds to the whole program.
"""

import os
import resource
import subprocess
import time

import harness
import runs

# Parsers and their shares of the cases; those that build scenes are slower and have more code.
TARGETS = {"pbrt": 2, "gltf": 2, "ply": 3, "image": 2, "film": 3, "spectrum": 1, "nanovdb": 1,
           "experiment": 3}
# Of processors, for one input; and of all of a process. Unit: seconds, bytes.
SLOW = 10
MEMORY = 2 * runs.GIB
# Inputs of a process.
BATCH = 50_000


class Reader:
    """A process that reads a range of mutations."""

    def __init__(self, work, target, begin, end, folder):
        self.target, self.begin, self.end = target, begin, end
        self.place = os.path.join(folder, "place")
        self.folder = folder
        self.command = [work.options.mutations, target, str(work.options.seed), str(begin), str(end),
                        self.place, work.out]
        with open(os.path.join(folder, ".said"), "wb") as said:
            self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                            stderr=said, text=True, preexec_fn=impose)

    def number(self):
        """The mutation that is being read."""
        try:
            with open(self.place) as file:
                return int(file.read() or self.begin)
        except (OSError, ValueError):
            return self.begin

    def used(self):
        """Seconds of processors; 0 where the system does not count them."""
        try:
            return harness.processor_time(self.process.pid)
        except OSError:
            return 0.0

    def wait(self):
        """Waits for the end. Returns the number of an input that takes too long, which ends it, or None."""
        last, since, begin = None, 0.0, time.monotonic()
        while self.process.poll() is None:
            number, used = self.number(), self.used() or time.monotonic() - begin
            if number != last:
                last, since = number, used
            elif used - since > SLOW:
                self.process.kill()
                self.process.wait()
                return number
            time.sleep(0.05)
        return None


def impose():
    runs.limit_memory(MEMORY)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def keep(work, target, number, problem):
    """Keeps a failure with its input, which is generated again."""
    file = os.path.join(work.out, "%s-%d" % (target, number))
    command = [work.options.mutations, target, str(work.options.seed), str(number), file]
    subprocess.run(command, check=True)
    work.case("%s %d" % (target, number), problem, None, command)


def batch(work, target, begin, end):
    """Reads a range. Returns the next input, which lies before the end if an input ended the process."""
    with work.folder() as folder:
        reader = Reader(work, target, begin, end, folder)
        slow = reader.wait()
        panicked = reader.process.stdout.read().split()
        code = reader.process.returncode
        for file in panicked:
            work.case(os.path.basename(file), "panics; the input is %s" % file, folder, reader.command)
        if slow is not None:
            keep(work, target, slow, "takes more than %d s" % SLOW)
        elif code not in (0, 1):
            keep(work, target, reader.number(), "ends the process with %d: %s" % (code, runs.said(folder)[-2000:]))
        else:
            work.cases += end - begin - len(panicked)
            return end
        last = reader.number()
        work.cases += last - begin - len(panicked)
        return last + 1


def run(work):
    if not os.path.exists(work.options.mutations):
        work.skipped = "no %s: `cargo build --release --workspace --example mutations`" % work.options.mutations
        return
    os.makedirs(work.out, exist_ok=True)
    whole = sum(TARGETS.values())
    for target, share in TARGETS.items():
        begin, number, end = time.monotonic(), 0, work.count() * share // whole
        while number < end:
            number = batch(work, target, number, min(number + BATCH, end))
        work.say("%s: %d inputs in %.0f s" % (target, end, time.monotonic() - begin))
