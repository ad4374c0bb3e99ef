"""Runs the program under callgrind, and takes differences."""

import json
import os
import re
import subprocess
from typing import NamedTuple

import callgrind

SIZE = "40x30"
PASSES = (1, 3)
SCENES = ["cornell", "room-direct", "room-indirect", "apartment"]
METHODS = {
    "path": ["--integrator", "path"],
    "light": ["--integrator", "light"],
    "bdpt": ["--integrator", "bdpt", "--shadow-rays", "all"],
    "bdpt per-pair": ["--integrator", "bdpt", "--shadow-rays", "per-pair"],
    "lvc": ["--integrator", "lvc"],
}
# The row with figures of stages and functions.
PROFILED = ("room-indirect", "bdpt")
# The functions of each stage of `bdpt`, by the names of the stages in `--stats`.
STAGES = {
    "walk": r"^bidir::integrator::stages::walk::(walk|sum)_(camera|light)$",
    "hits": r"^bidir::integrator::stages::hits::hits$",
    "light_image": r"^bidir::integrator::stages::light_image::light_image$",
    "candidates": r"^bidir::integrator::stages::(next_event::next_events|connect::connect)$",
    "select": r"^<bidir::select::\w+::\w+ as bidir::select::Selector>::select$",
    "shadow": r"^bidir::integrator::stages::trace::shadow_rays$",
    "film": r"^bidir::(driver::deposit::Deposit::take|film::Film::add_pass"
            r"|film::pass::PassBuffer::clear)$",
}


class Failed(Exception):
    """A run gave no figures."""


class Row(NamedTuple):
    """A method in a scene, per sample."""

    scene: str
    method: str
    instructions: float
    rays: float


class Figures:
    """All counts."""

    def __init__(self):
        self.rows = []
        self.stages = {}
        self.functions = []


def rows(text):
    """Returns the scenes and methods whose names contain a text."""
    return ((scene, method) for scene in SCENES for method in METHODS
            if text in "%s, %s" % (scene, method))


class Bench(NamedTuple):
    """The program, its scenes, and the folder of profiles."""

    program: str
    scenes: str
    folder: str

    def count(self, scene, method, figures):
        """Adds a row, and the profile of the row with figures of stages."""
        (few, before), (many, after) = [self._run(scene, method, spp) for spp in PASSES]
        samples = after["samples"] - before["samples"]
        profile = many.minus(few)
        rays = after["rays"]["total"] - before["rays"]["total"]
        figures.rows.append(Row(scene, method, profile.total() / samples, rays / samples))
        if (scene, method) == PROFILED:
            figures.stages = stages(profile, samples)
            figures.functions = functions(profile, samples)

    def _run(self, scene, method, spp):
        """Returns the profile of a render, and its counters."""
        path = [os.path.join(self.folder, name) for name in ("profile", "image.exr", "stats.json")]
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=" + path[0],
                   "--dump-line=no", self.program, "render",
                   os.path.join(self.scenes, scene + ".pbrt"), "-q", "-o", path[1],
                   "--size", SIZE, "--spp", str(spp), "--threads", "1", "--seed", "0",
                   "--stats", path[2]] + METHODS[method]
        # Environment variables of the caller must not change the counts.
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("BIDIR_")}
        environment["BIDIR_ISA"] = "sse2"
        run = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, check=False)
        if run.returncode != 0:
            raise Failed("%s: %s" % (" ".join(command), run.stdout.decode(errors="replace")))
        with open(path[0], encoding="utf-8") as file:
            profile = callgrind.parse(file)
        with open(path[2], encoding="utf-8") as file:
            return profile, json.load(file)


def made_with(program):
    """Returns the versions that counts depend on, with the current compiler."""
    said = []
    for command in ([program, "--version"], ["rustc", "--version"], ["valgrind", "--version"]):
        try:
            said.append(subprocess.check_output(command).decode().strip())
        except (OSError, subprocess.CalledProcessError):
            said.append("no " + command[0])
    return ", ".join(said)


def stages(profile, samples):
    """Instructions of a sample by stage, callees included; the last is the rest."""
    found = {}
    for stage, pattern in STAGES.items():
        names = profile.find(pattern)
        if not names:
            raise Failed("no function is `%s`, the stage %s: has it another name, or is it inlined?"
                         % (pattern, stage))
        found[stage] = sum(profile.inclusive(name) for name in names) / samples
    found["other"] = profile.total() / samples - sum(found.values())
    return found


def functions(profile, samples, most=16):
    """The functions with the most instructions of their own: (name, own, inclusive) per sample."""
    return [(short(name), count / samples, profile.inclusive(name) / samples)
            for name, count in profile.own.most_common(most)]


def short(name):
    """Shortens the name of a function to the type without its path, and the function."""
    name = re.sub(r"<impl ([^<>]*)>", r"\1", name)
    name = re.sub(r"^<([^<>]*) as ([^<>]*)>", r"\1", name)
    parts = re.split(r"::(?![^<]*>)", name)
    return "::".join(parts[-2:])
