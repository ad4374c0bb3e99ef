"""Runs the program under callgrind, and takes differences."""

import os
import re
import subprocess

import callgrind
import harness

SIZE = "40x30"
PASSES = ("1", "3")
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
    "hits": r"^bidir::integrator::stages::walk::hits$",
    "light_image": r"^bidir::integrator::stages::light_image::light_image$",
    "candidates": r"^bidir::integrator::stages::(light_ends::(next_events|own_light)|connect::connect)$",
    "select": r"^<bidir::select::\w+::\w+ as bidir::select::Selector>::select$",
    "shadow": r"^bidir::integrator::stages::trace::shadow_rays$",
    "film": r"^bidir::(driver::deposit::Deposit::take|film::Film::add_pass"
            r"|film::pass::PassBuffer::clear)$",
}


def rows(text):
    """Returns the scenes and methods whose names contain a text."""
    return [(scene, method) for scene in SCENES for method in METHODS if text in "%s, %s" % (scene, method)]


def count(program, folder, row, figures):
    """Adds the figures of a scene and a method, and the profile of the row with figures of stages."""
    (few, before), (many, after) = [_profile(program, folder, row, spp) for spp in PASSES]
    samples = after["samples"] - before["samples"]
    profile = many.minus(few)
    figures["samples"]["%s, %s" % row] = sample(
        profile.total() / samples, (after["rays"]["total"] - before["rays"]["total"]) / samples)
    if row == PROFILED:
        figures["stages"] = stages(profile, samples)
        figures["functions"] = functions(profile, samples)


def sample(instructions, rays):
    """Returns the figures of a sample, rounded for the file."""
    return {"instructions": round(instructions), "rays": round(rays, 3),
            "instructions_per_ray": round(instructions / rays)}


def _profile(program, folder, row, spp):
    """Returns the profile of a render, and its counters."""
    scene, method = row
    path = os.path.join(folder, "profile")
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=" + path, "--dump-line=no", program]
    counters, _ = harness.render(command, folder, harness.ROOT / "scenes" / (scene + ".pbrt"), "--size", SIZE,
                                 "--spp", spp, "--threads", "1", "--seed", "0", *METHODS[method], BIDIR_ISA="sse2")
    with open(path, encoding="utf-8") as file:
        return callgrind.parse(file), counters


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
            raise harness.Failed("no function is `%s`, the stage %s: has it another name, or is it inlined?"
                                 % (pattern, stage))
        found[stage] = sum(profile.inclusive(name) for name in names) / samples
    found["other"] = profile.total() / samples - sum(found.values())
    return {stage: round(count) for stage, count in found.items()}


def functions(profile, samples, most=16):
    """The functions with the most instructions of their own: [name, own, inclusive] per sample."""
    return [[short(name), round(own / samples), round(profile.inclusive(name) / samples)]
            for name, own in profile.own.most_common(most)]


def short(name):
    """Shortens the name of a function to the type without its path, and the function."""
    name = re.sub(r"<impl ([^<>]*)>", r"\1", name)
    name = re.sub(r"^<([^<>]*) as ([^<>]*)>", r"\1", name)
    parts = re.split(r"::(?![^<]*>)", name)
    return "::".join(parts[-2:])
