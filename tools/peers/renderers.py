"""The compared renderers, each with the settings under which its image converges to the reference.

A job is the same work for all: a scene, CPU seconds, threads, a seed and the image to write.
"""

import json
import os
import re
import subprocess
from typing import NamedTuple

import harness
import neutral

HERE = os.path.dirname(os.path.abspath(__file__))


class Job(NamedTuple):
    scenes: str      # the folder that `neutral.write` made
    scene: str       # one of neutral.SCENES
    seconds: float   # CPU seconds, of all threads together
    threads: int
    seed: int
    image: str       # the EXR file to write


class Run(NamedTuple):
    image: str
    samples: float   # per pixel
    cpu: float       # seconds, of all threads together
    wall: float      # seconds


class Ours:
    """`bidir render` with some flags. The time is that of the whole process: loading, tracing, writing."""

    ours = True
    scenes = neutral.SCENES

    def __init__(self, program, flags):
        self.name = "bidir " + flags
        self.program = program
        self.flags = flags.split()
        self.cost = {}  # scene -> CPU seconds of a pass, as far as is known

    def problem(self, _environment):
        """Returns None, since it runs everywhere."""
        return None

    def render(self, job):
        """Renders as many passes as the CPU seconds allow, by the cost of the previous run; the first run
        is preceded by a short one that does not count."""
        if job.scene not in self.cost:
            self._learn(job)
        passes = max(1, round(job.seconds / self.cost[job.scene]))
        run = self.passes(job, passes)
        self.cost[job.scene] = run.cpu / passes
        return run

    def _learn(self, job):
        passes, cpu = 1, 0.0
        while cpu < 0.1 * job.seconds:
            cpu = self.passes(job, passes).cpu
            self.cost[job.scene] = cpu / passes
            passes *= 4

    def passes(self, job, passes):
        """Renders a number of samples per pixel, at any cost."""
        scene = os.path.join(job.scenes, job.scene + ".pbrt")
        command = [self.program, "render", scene, "-q", "-o", job.image, "--spp", str(passes),
                   "--seed", str(job.seed), "--threads", str(job.threads), "--integrator"]
        usage = harness.run(command + self.flags)
        return Run(job.image, passes, usage.cpu, usage.wall)


class Peer:
    """Another renderer, driven by a script in its environment. The time excludes importing it, compiling
    kernels and reading the scene."""

    ours = False

    def __init__(self, name, package, environment, scenes="AB", **settings):
        self.name = name
        self.scenes = scenes
        self.package = package
        self.environment = environment
        self.settings = settings

    def problem(self, environment):
        """Returns the reason why it cannot run. None: it can."""
        if not environment.has(self.package):
            return "%s is not installed" % self.package
        if self.settings.get("variant", "").startswith("llvm") and environment.llvm() is None:
            return "there is no LLVM that Mitsuba can use"
        return None

    def render(self, job):
        script = os.path.join(HERE, "render_%s.py" % self.package)
        work = dict(job._asdict(), **self.settings)
        variables = self.environment.variables(self.package)
        done = subprocess.run([self.environment.python, script, json.dumps(work)], env=variables,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", check=False)
        # Some print other lines, too, and some crash at the end although the render succeeded.
        found = re.findall(r'\{"samples".*?\}', done.stdout)
        if not found:
            raise harness.Failed(done.stdout[-400:])
        return Run(image=job.image, **json.loads(found[-1]))


def all_renderers(program, environment, variants):
    """Returns bidir's integrators, first by default and then with other flags, and the peers."""
    def mitsuba(name, variant, integrator, scenes="AB"):
        return Peer(name, "mitsuba", environment, scenes, variant=variant, integrator=integrator)

    def luxcore(name, engine):
        return Peer(name, "pyluxcore", environment, engine=engine)

    return [
        *(Ours(program, flags) for flags in ["path", "light", "bdpt", "lvc", "auto"] + variants),
        mitsuba("Mitsuba path, LLVM", "llvm_ad_rgb", "path"),
        mitsuba("Mitsuba path, scalar", "scalar_rgb", "path"),
        mitsuba("Mitsuba ptracer, LLVM", "llvm_ad_rgb", "ptracer"),
        mitsuba("Mitsuba ptracer, scalar", "scalar_rgb", "ptracer"),
        mitsuba("Mitsuba volpath, LLVM", "llvm_ad_rgb", "volpath", "C"),
        mitsuba("Mitsuba volpath, scalar", "scalar_rgb", "volpath", "C"),
        mitsuba("Mitsuba volpathmis, LLVM", "llvm_ad_rgb", "volpathmis", "C"),
        luxcore("LuxCore PATHCPU", "PATHCPU"),
        luxcore("LuxCore BIDIRCPU", "BIDIRCPU"),
        Peer("Cycles path", "bpy", environment),
    ]


def pixels():
    return neutral.SIDE * neutral.SIDE
