"""Renders, shares of renders, and merges that are killed go on to the bits of one that was not.

Half of the kills come at a random moment, half at a random system call. The last run of each render ends
by itself: its image must have all bits, and no file may be left over.
"""

import os

import part
import runs
import tracer
from worlds import INTEGRATORS, ROOM

LIMITS = runs.Limits(cpu=60, wall=120)
# A render is killed so often before it may end.
KILLS = 4
# Calls that touch files: between two of them the files do not change.
FILES = ("openat", "write", "fsync", "fdatasync", "rename", "renameat", "renameat2", "linkat", "link", "unlink",
         "flock", "ftruncate")
# Samples of a pixel. A render of them takes a few tenths of a second.
SPP = 192


class Whole:
    """A render that nothing interrupts, by an integrator."""

    def __init__(self, work, integrator, folder):
        self.integrator, self.folder = integrator, folder
        self.flags = ["render", "room.pbrt", "-q", "--threads", 1, "--size", "48x32", "--integrator",
                      integrator]
        part.write(folder, "room.pbrt", ROOM)
        command = work.bidir(*self.flags, "--spp", SPP, "-o", "whole.exr", "--checkpoint", "whole.film")
        ended = runs.run(command, folder, LIMITS)
        self.seconds = ended.seconds
        work.case("%s whole" % integrator, ended.wrong(0), folder, command)


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
        return runs.run(command, folder, LIMITS).wrong(0)


def left_over(folder, wanted):
    """The reason why the files of a folder are not those wanted."""
    surplus = sorted(set(os.listdir(folder)) - set(wanted) - {".said", "room.pbrt"})
    return "leaves %s behind" % ", ".join(surplus) if surplus else None


def same(work, whole, image, folder):
    command = work.bidir("compare", "--exact", image, os.path.join(whole.folder, "whole.exr"))
    return runs.run(command, folder, LIMITS).wrong(0)


def resumed(kills, whole, folder):
    """One render with a checkpoint after every pass."""
    work = kills.work
    command = work.bidir(*whole.flags, "--spp", SPP, "-o", "a.exr", "--checkpoint", "a.film", "--resume",
                         "--checkpoint-every", "0.001s")
    fault = kills.insist("render", command, folder, whole.seconds)
    fault = fault or same(work, whole, "a.exr", folder)
    return fault or left_over(folder, ("a.exr", "a.png", "a.film", "a.film.previous")), command


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
    fault, command = merged(kills, films, folder)
    fault = fault or same(work, whole, "a.exr", folder)
    kept = {"a.exr", "a.png", "whole.film"}.union(films, (film + ".previous" for film in films))
    return fault or left_over(folder, kept | {"whole.film.previous"}), command


def merged(kills, films, folder):
    """Adds one film after the other to `whole.film`: the result is among the inputs. Every merge is
    killed, and given again after it ended."""
    for number, film in enumerate(films):
        inputs = [film] if number == 0 else ["whole.film", film]
        command = kills.work.bidir("merge", *inputs, "-o", "whole.film", "--image", "a.exr")
        kills.kill("merge", command, folder, 0.02)
        for _ in range(2):
            fault = runs.run(command, folder, LIMITS).wrong(0)
            if fault:
                return fault, command
    return None, command


def run(work):
    kills, wholes = Kills(work), {}
    with work.folder() as place:
        while kills.killed < work.count():
            integrator = work.random.choice(INTEGRATORS)
            if integrator not in wholes:
                folder = os.path.join(place, integrator)
                os.mkdir(folder)
                wholes[integrator] = Whole(work, integrator, folder)
                if work.failures:
                    return
            with work.folder() as folder:
                part.write(folder, "room.pbrt", ROOM)
                scenario = work.random.choice((resumed, resumed, shared))
                before = kills.killed
                fault, command = scenario(kills, wholes[integrator], folder)
                title = "%s %s after %d kills" % (integrator, scenario.__name__, kills.killed - before)
                work.case(title, fault, folder, command)
    work.say("%d kills" % kills.killed)
