"""Damaged files of all kinds, read by the whole program: a message or a right result, within the means.

Scenes, images, meshes and descriptions get any changes. Films, references and records have checksums: a
changed byte of one is either found or changes no result.
"""

import os
import shutil

import commands
import harness
import part
import runs

NUMBERS = (b"0", b"-1", b"1", b"255", b"65536", b"2147483647", b"-2147483648", b"18446744073709551615", b"1e38",
           b"-1e38", b"1e-44", b"nan", b"inf", b"1e9999", b"4294967296")
LIMITS = runs.Limits(cpu=20, wall=300, memory=runs.GIB)
# Unit: seconds.
PATIENCE = 10
TINY = ("--size", "6x4", "--spp", "1", "-q", "--threads", "1", "--max-depth", "3")


def flip(random, data):
    """One bit is another."""
    data = bytearray(data)
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    return bytes(data)


def mutate(random, data):
    """A few places are changed."""
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(data) + 1)
        end = min(len(data), at + random.choice((1, 2, 4, 8, random.randint(1, 64))))
        kind = random.randrange(6)
        if kind == 0 and data:
            data = flip(random, data)
        elif kind == 1:
            data = data[:at] + data[end:]
        elif kind == 2:
            data = data[:at] + data[at:end] + data[at:]
        elif kind == 3:
            data = data[:at]
        elif kind == 4:
            data = data[:at] + bytes([random.choice((0, 0x7f, 0x80, 0xff))]) * (end - at) + data[end:]
        else:
            data = number(random, data, at)
    return data


def number(random, data, at):
    """The first number behind a place is another."""
    digits = b"0123456789+-."
    begin = next((i for i in range(at, len(data)) if data[i] in digits), len(data))
    end = next((i for i in range(begin, len(data)) if data[i] not in digits), len(data))
    return data[:begin] + random.choice(NUMBERS) + data[end:]


class Kinds:
    """A method for each kind of file. Each returns the title, the fault and the command."""

    def __init__(self, work, prepared):
        self.work, self.random, self.prepared = work, work.random, prepared
        self.seeds = harness.ROOT / "fuzz" / "seeds"
        for name in ("reference", "experiment"):
            commands.must(work, prepared, *commands.COMMANDS[name][0])
        self.right = commands.figures(os.path.join(prepared, "out-results", "results.json"))

    def seed(self, kind):
        folder = os.path.join(self.seeds, kind)
        name = self.random.choice(sorted(os.listdir(folder)))
        return name, part.read(folder, name)

    def run(self, title, folder, *arguments, **means):
        """Returns the title, how the program ended, and the command."""
        command = self.work.bidir(*arguments)
        return title, runs.run(command, folder, LIMITS, **means), command

    def ends(self, *case):
        title, ended, command = self.run(*case)
        return title, ended.fault(), command

    def refused(self, *case):
        """Damage has to be found."""
        title, ended, command = self.run(*case)
        return title, ended.fault() or (None if ended.code else "the damage is not found"), command

    def mutated(self, folder, kind, begin=0):
        """Writes a mutated seed, without its first bytes. Returns its name."""
        name, data = self.seed(kind)
        part.write(folder, name, mutate(self.random, data[begin:]))
        return name

    def rendered(self, folder, name, body):
        """Renders a scene that names a file."""
        part.write(folder, "s.pbrt", 'Camera "perspective" WorldBegin ' + body.replace("FILE", name))
        return self.ends(name, folder, "render", "s.pbrt", *TINY, "-o", "out.exr")

    def scene(self, folder):
        name = self.mutated(folder, self.random.choice(("pbrt", "gltf")))
        lenient = self.random.choice(([], ["--lenient"]))
        if self.random.random() < 0.5:
            return self.ends(name, folder, "info", name, *lenient)
        return self.ends(name, folder, "render", name, *TINY, "-o", "out.exr", *lenient)

    def mesh(self, folder):
        name = self.mutated(folder, "ply")
        return self.rendered(folder, name, 'LightSource "infinite" Shape "plymesh" "string filename" "FILE"')

    def spectrum(self, folder):
        name = self.mutated(folder, "spectrum")
        return self.rendered(folder, name, 'LightSource "infinite" "spectrum L" "FILE" '
                             'Material "conductor" "spectrum eta" "FILE" Shape "sphere"')

    def image(self, folder):
        # The first byte of a seed names the format.
        name = self.mutated(folder, "image", begin=1)
        kind = self.random.choice(("tonemap", "compare", "texture", "sky"))
        if kind == "tonemap":
            return self.ends(name, folder, "tonemap", name, "-o", "out.png")
        if kind == "compare":
            return self.ends(name, folder, "compare", name, name)
        if kind == "sky":
            return self.rendered(folder, name, 'LightSource "infinite" "string filename" "FILE"')
        return self.rendered(folder, name, 'LightSource "infinite" Texture "t" "spectrum" "imagemap" "string filename" '
                             '"FILE" Material "diffuse" "texture reflectance" "t" Shape "sphere"')

    def description(self, folder):
        self.copy(folder, ("room.pbrt",))
        text = mutate(self.random, commands.EXPERIMENT.encode())
        part.write(folder, "small.toml", text)
        title, ended, command = self.run("small.toml", folder, "experiment", "small.toml", "-o", "out", "-q", "--quick",
                                         "--threads", "1", kill_after=PATIENCE)
        # A valid description may take unlimited time.
        return title, None if ended.code == -9 else ended.fault(), command

    def copy(self, folder, names):
        for name in names:
            source = os.path.join(self.prepared, name)
            if os.path.isdir(source):
                shutil.copytree(source, os.path.join(folder, name))
            else:
                shutil.copy(source, os.path.join(folder, name))

    def damage(self, folder, names):
        """Damages one of these files: flips a bit, cuts, or removes it. Returns a description."""
        name = self.random.choice(names)
        data = part.read(folder, name)
        kind = self.random.choice(("flip", "flip", "flip", "cut"))
        changed = flip(self.random, data) if kind == "flip" else data[:self.random.randrange(len(data) - 1)]
        part.write(folder, name, changed)
        return "%s of %s" % (kind, name)

    def film(self, folder):
        """Damage is found by every command that reads the film."""
        self.copy(folder, ("a.film", "b.film", "room.pbrt"))
        title = self.damage(folder, ("a.film",))
        arguments = self.random.choice((("film", "verify", "a.film"), ("film", "develop", "a.film", "-o", "o.exr"),
                                        ("merge", "a.film", "b.film", "-o", "o.film")))
        return self.refused(title, folder, *arguments)

    def records(self, folder):
        """A resumed experiment has the same results, or is refused."""
        self.copy(folder, ("room.pbrt", "small.toml", "out-results"))
        os.remove(os.path.join(folder, "out-results", "results.json"))
        title = self.damage(folder, ("out-results/records.ndjson",))
        title, fault, command = self.ends(title, folder, *commands.COMMANDS["experiment"][0])
        results = os.path.join(folder, "out-results", "results.json")
        if not fault and os.path.exists(results) and commands.figures(results) != self.right:
            fault = "the damage changes the results"
        return title, fault, command

    def reference(self, folder):
        """A reference that is damaged is refused."""
        self.copy(folder, ("room.pbrt", "small.toml", "out-reference"))
        title = self.damage(folder, ("out-reference/picture.exr", "out-reference/against.exr",
                                     "out-reference/provenance.json"))
        text = commands.EXPERIMENT.replace("reference-spp = 32", 'size = "8x6"\nreference = "out-reference"')
        part.write(folder, "small.toml", text)
        return self.refused(title, folder, "experiment", "small.toml", "-o", "out", "-q")


def run(work):
    with work.folder() as prepared:
        commands.prepare(work, prepared)
        kinds = Kinds(work, prepared)
        methods = (kinds.scene, kinds.mesh, kinds.spectrum, kinds.image, kinds.description, kinds.film,
                   kinds.records, kinds.reference)
        for number in range(work.count()):
            with work.folder() as folder:
                method = methods[number % len(methods)]
                title, fault, command = method(folder)
                work.case("%s: %s" % (method.__name__, title), fault, folder, command)
