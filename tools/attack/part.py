"""A part of the campaign: its random numbers, its cases, and the failures that it keeps."""

import hashlib
import os
import random
import shutil
import tempfile
import time
from pathlib import Path

# Folders of cases are in memory where that is possible: thousands of them sync their files.
MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
# Failures of a part that are kept as files; the others are only counted.
KEPT = 50


class Part:
    """Counts cases. Every case has a folder that is removed unless the case fails."""

    def __init__(self, name, options):
        self.name, self.options = name, options
        self.random = random.Random("%d %s" % (options.seed, name))
        self.cases = 0
        self.failures = 0
        self.skipped = None
        self.begin = time.monotonic()
        self.out = os.path.join(options.out, name)
        self.last = self.begin

    def count(self):
        """Returns the number of cases of this part."""
        return self.options.counts[self.name]

    def bidir(self, *arguments):
        return [self.options.bidir, *map(str, arguments)]

    def folder(self):
        return tempfile.TemporaryDirectory(prefix="bidir-attack-", dir=MEMORY)

    def case(self, title, problem, folder=None, command=()):
        """Counts a case; `problem` is the reason why it failed, or None."""
        self.cases += 1
        if problem:
            self.failures += 1
            self.keep(title, problem, folder, command)
        if time.monotonic() - self.last > 60:
            self.last = time.monotonic()
            self.say("%d cases, %d failures" % (self.cases, self.failures))

    def keep(self, title, problem, folder, command):
        self.say("FAILED: %s: %s" % (title, problem))
        if self.failures > KEPT:
            return
        place = os.path.join(self.out, "%03d" % self.failures)
        shutil.rmtree(place, ignore_errors=True)
        if folder:
            shutil.copytree(folder, place, symlinks=True, ignore_dangling_symlinks=True)
        os.makedirs(place, exist_ok=True)
        write(place, "failure.txt", "%s\n%s\n%s\n" % (title, problem, " ".join(map(str, command))))

    def say(self, text):
        print("%s: %s" % (self.name, text), flush=True)

    def row(self):
        """Stops the clock. Returns the cells of the table."""
        result = "skipped: " + self.skipped if self.skipped else self.failures
        return [self.name, self.cases, result, round(time.monotonic() - self.begin)]


def write(folder, name, data):
    Path(folder, name).write_bytes(data if isinstance(data, bytes) else data.encode())


def read(folder, name):
    return Path(folder, name).read_bytes()


def digest(folder, names):
    """The contents of files by name."""
    return {name: hashlib.sha256(read(folder, name)).hexdigest() for name in names
            if os.path.isfile(os.path.join(folder, name))}
