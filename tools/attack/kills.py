"""Killed and resumed renders, shares of renders, and merges have the bits of an uninterrupted render.

Half of the kills come at a random moment, half at a random system call. The last run of each render ends
by itself: its image must have all bits, and no file may be left over.
"""

import os

import commands
import part
import runs
import tracer
from worlds import INTEGRATORS, ROOM

LIMITS = runs.Limits(cpu=60, wall=300)
# The number of kills before a render may end.
KILLS = 4
# Calls that touch files: between two of them the files do not change.
FILES = ("openat", "write", "fsync", "fdatasync", "rename", "renameat", "renameat2", "linkat", "link", "unlink",
         "flock", "ftruncate")
# Samples of a pixel. A render of them takes a few tenths of a second.
SPP = 64


class Whole:
    """An uninterrupted command, in a folder of its own: a render by an integrator, a reference or an experiment."""

    def __init__(self, work, name, folder):
        self.name = name
        self.flags = ["render", "room.pbrt", "-q", "--threads", 1, "--size", "48x32", "--integrator", name]
        self.command = work.bidir(*self.flags, "--spp", SPP, "-o", "a.exr", "--checkpoint", "a.film")
        if name not in INTEGRATORS:
            self.command = work.bidir(*commands.COMMANDS[name][0])
        prepare(folder)
        ended = runs.run(self.command, folder, LIMITS)
        self.seconds = None if ended.wrong(0) else ended.seconds
        work.case("%s whole" % name, ended.wrong(0), folder, self.command)
        self.right = contents(folder)

    def difference(self, folder):
        """Returns the difference of a folder's files from the right ones. None: there is none."""
        found = contents(folder)
        names = sorted(set(found) ^ set(self.right))
        if names:
            return "the files differ: %s" % ", ".join(names)
        wrong = [name for name in found if found[name] != self.right[name]]
        return "differs: %s" % ", ".join(wrong) if wrong else None


def prepare(folder):
    for file, text in (("room.pbrt", ROOM), ("small.toml", commands.EXPERIMENT)):
        part.write(folder, file, text)


def contents(folder):
    """Returns the contents of all files by name, but for locks and those that a share or a merge has more or less of."""
    paths = [os.path.relpath(os.path.join(place, name), folder)
             for place, _, names in os.walk(folder) for name in names]
    others = (".film", ".film.previous", ".lock", "a.png")
    return commands.contents(folder, [path for path in paths if not path.endswith(others)])


class Kills:
    def __init__(self, work):
        self.work, self.killed = work, 0
        self.traced = tracer.absent()
        if self.traced:
            work.say("no kills at system calls: %s" % self.traced)
        # Calls of a command by name, from the last run of its kind that was traced.
        self.counts = {}

    def kill(self, kind, command, folder, seconds):
        """Runs a command and kills it on the way. Returns how it ended."""
        random = self.work.random
        if self.traced or random.random() < 0.5:
            ended = runs.run(command, folder, LIMITS, kill_after=seconds * random.uniform(0.02, 1.0))
        else:
            counts = self.counts.get(kind)
            if counts is None:
                counts = dict.fromkeys(FILES, 3)
            name = random.choice([name for name in FILES if counts.get(name)])
            action = tracer.Action(name, random.randint(1, counts[name]), "kill")
            ended, self.counts[kind] = tracer.trace(command, folder, action, LIMITS)
        if ended.code == -9:
            self.killed += 1
        elif ended.fault():
            self.work.case("before a kill", ended.fault(), folder, command)
        return ended

    def insist(self, kind, command, folder, seconds):
        """Kills a command several times, and lets it end. Returns the fault, or None."""
        for _ in range(self.work.random.randint(1, KILLS)):
            if self.kill(kind, command, folder, seconds).code == 0:
                break
        age(folder)
        return runs.run(command, folder, LIMITS).wrong(0)


def age(folder):
    """Makes temporary files so old that the next writer of their names removes them."""
    for name in os.listdir(folder):
        if ".bidir-" in name:
            os.utime(os.path.join(folder, name), (0, 0))


def resumed(kills, whole, folder):
    """One render with a checkpoint after every pass."""
    command = [*whole.command, "--resume", "--checkpoint-every", "0.001s"]
    return kills.insist("render", command, folder, whole.seconds), command


def shared(kills, whole, folder):
    """Ranges of passes by processes that are killed, merged by processes that are killed."""
    work = kills.work
    cuts = sorted(work.random.sample(range(1, SPP), work.random.randint(1, 3)))
    films = []
    for number, (begin, end) in enumerate(zip([0, *cuts], [*cuts, SPP])):
        films.append("%d.film" % number)
        command = work.bidir(*whole.flags, "--passes", "%d..%d" % (begin, end), "--checkpoint", films[-1],
                             "--resume", "--checkpoint-every", "0.001s")
        fault = kills.insist("share", command, folder, whole.seconds * (end - begin) / SPP)
        if fault:
            return fault, command
    return merged(kills, films, folder)


def merged(kills, films, folder):
    """Adds one film after the other to `whole.film`: the result is among the inputs. Every merge is
    killed, and given again after it ended."""
    for number, film in enumerate(films):
        inputs = [film] if number == 0 else ["whole.film", film]
        command = kills.work.bidir("merge", *inputs, "-o", "whole.film", "--image", "a.exr")
        kills.kill("merge", command, folder, 0.02)
        age(folder)
        for _ in range(2):
            fault = runs.run(command, folder, LIMITS).wrong(0)
            if fault:
                return fault, command
    return None, command


def continued(kills, whole, folder):
    """A killed reference or experiment, which the same command resumes."""
    return kills.insist(whole.name, whole.command, folder, whole.seconds), whole.command


def run(work):
    kills, wholes = Kills(work), {}
    with work.folder() as place:
        # A program that always fails is never killed.
        while kills.killed < work.count() and work.failures < part.KEPT:
            name = work.random.choice((*INTEGRATORS, *INTEGRATORS, "reference", "experiment"))
            if name not in wholes:
                folder = os.path.join(place, name)
                os.mkdir(folder)
                wholes[name] = Whole(work, name, folder)
                if wholes[name].seconds is None:
                    return
            scenario = work.random.choice((resumed, shared)) if name in INTEGRATORS else continued
            with work.folder() as folder:
                prepare(folder)
                before = kills.killed
                fault, command = scenario(kills, wholes[name], folder)
                fault = fault or wholes[name].difference(folder)
                title = "%s %s after %d kills" % (name, scenario.__name__, kills.killed - before)
                work.case(title, fault, folder, command)
    work.say("%d kills" % kills.killed)
