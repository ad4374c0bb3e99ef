"""Tests of this tool: python3 tools/attack --self-test"""

import contextlib
import io
import os
import random
import struct
import sys
import tempfile
import unittest
import unittest.mock
import zlib

import exr
import extremes
import faults
import files
import kills
import mutations
import part
import runs
import scale
import tracer


def shell(text, **limits):
    with tempfile.TemporaryDirectory() as folder:
        return runs.run(["/bin/sh", "-c", text], folder, runs.Limits(**limits))


class Verdicts(unittest.TestCase):
    def test_documented_codes_with_a_message_pass(self):
        self.assertIsNone(shell("exit 0").fault())
        self.assertIsNone(shell("echo reason; exit 4").fault())
        self.assertIn("without a message", shell("exit 4").fault())
        self.assertIn("not 0", shell("echo reason; exit 4").wrong(0))

    def test_panics_signals_and_other_codes_fail(self):
        self.assertIn("panics", shell("echo \"thread 'main' panicked at x\"; exit 101").fault())
        self.assertIn("101", shell("echo reason; exit 101").fault())
        self.assertIn("SIGABRT", shell("kill -ABRT $$").fault())

    def test_time_and_memory_are_limited(self):
        self.assertIn("still runs", shell("sleep 9", wall=0.2).fault())
        self.assertIn("of processors", shell("i=0; while [ $i -lt 9999 ]; do i=$((i+1)); done", cpu=0.001).fault())
        self.assertIn("MiB", shell("exit 0", memory=1 << 10).fault())

    def test_a_killed_run_ends_by_the_signal(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(runs.run(["/bin/sleep", "9"], folder, kill_after=0.1).code, -9)


class Images(unittest.TestCase):
    def image(self, rows, packed):
        """A file with one channel of two values a row."""
        attributes = (
            (b"channels", b"chlist", b"R\0" + struct.pack("<IIII", 1, 0, 1, 1) + b"\0"),
            (b"compression", b"compression", bytes([3])),
            (b"dataWindow", b"box2i", struct.pack("<4i", 0, 0, 1, rows - 1)),
        )
        head = struct.pack("<II", 20000630, 2) + b"".join(
            b"%s\0%s\0%s%s" % (name, kind, struct.pack("<I", len(data)), data) for name, kind, data in attributes)
        data = packed(b"".join(struct.pack("<ee", y, 0.5) for y in range(rows)))
        return head + b"\0" + struct.pack("<QiI", len(head) + 9, 0, len(data)) + data

    def test_blocks_are_unpacked(self):
        def pack(data):
            halves = data[0::2] + data[1::2]
            steps = [halves[0]] + [(b - a + 128) & 255 for a, b in zip(halves, halves[1:])]
            return zlib.compress(bytes(steps))

        for packed, rows in ((pack, 16), (lambda data: data, 2)):
            with tempfile.NamedTemporaryFile() as file:
                file.write(self.image(rows, packed))
                file.flush()
                values = exr.read(file.name)["R"]
            self.assertEqual(list(values), [value for y in range(rows) for value in (y, 0.5)])


class Cases(unittest.TestCase):
    def test_the_same_seed_makes_the_same_mutations(self):
        first, second, other = ([files.mutate(random.Random(seed), b"film 12 34") for _ in range(9)]
                                for seed in (1, 1, 2))
        self.assertEqual(first, second)
        self.assertNotEqual(first, other)

    def test_points_are_scaled_and_the_rest_is_not(self):
        text = scale.points('"integer indices" [0 1 2] "point3 P" [1 2 -3]\n', 10.0)
        self.assertEqual(text, '"integer indices" [0 1 2] "point3 P" [10.0 20.0 -30.0]\n')

    def test_every_fault_is_of_a_call_that_is_traced(self):
        for name in (*faults.ERRORS, *kills.FILES):
            self.assertIn(name, tracer.NUMBERS)

    def test_names_of_targets_are_those_of_the_seeds(self):
        seeds = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "fuzz", "seeds")
        self.assertEqual(set(mutations.TARGETS), set(os.listdir(seeds)))

    def test_every_scene_is_whole(self):
        for name, text in extremes.SCENES.items():
            self.assertEqual(text.count("AttributeBegin"), text.count("AttributeEnd"), name)


# Stands in for the example: it panics at 3, is ended by a signal at 5, and never returns from 8.
READER = """#!%s
import os, sys
if len(sys.argv) == 5:
    open(sys.argv[4], "w").write("input " + sys.argv[3])
    sys.exit()
place = open(sys.argv[5], "w")
for number in range(int(sys.argv[3]), int(sys.argv[4])):
    place.seek(0)
    place.write("%%20d" %% number)
    place.flush()
    if number == 3:
        print(os.path.join(sys.argv[6], "pbrt-3"), flush=True)
    if number == 5:
        os.abort()
    while number == 8:
        pass
"""


class Options:
    """The options of the command line that a part needs."""
    seed, counts = 1, {}

    def __init__(self, folder):
        self.out = self.bidir = folder
        self.mutations = os.path.join(folder, "reader")
        with open(self.mutations, "w") as file:
            file.write(READER % sys.executable)
        os.chmod(self.mutations, 0o755)


class Readers(unittest.TestCase):
    def test_inputs_that_panic_abort_or_hang_are_found_and_the_others_read(self):
        with tempfile.TemporaryDirectory() as folder, \
                unittest.mock.patch.object(mutations, "SLOW", 0.3), \
                contextlib.redirect_stdout(io.StringIO()) as said:
            work = part.Part("mutations", Options(folder))
            os.mkdir(work.out)
            number = 0
            while number < 12:
                number = mutations.batch(work, "pbrt", number, 12)
            self.assertEqual((work.cases, work.failures), (12, 3))
            self.assertEqual(part.read(work.out, "pbrt-8"), b"input 8")
        for problem in ("pbrt-3: panics", "pbrt 5: ends the process", "pbrt 8: takes more"):
            self.assertIn(problem, said.getvalue())


class Tracing(unittest.TestCase):
    def test_a_call_can_be_made_to_fail(self):
        if tracer.absent():
            self.skipTest(tracer.absent())
        # Python does not set a stack for signals up, unless it is asked to find faults.
        program = "import os; f = os.open('x', os.O_CREAT | os.O_WRONLY); print(os.write(f, b'abcd'))"
        command = [sys.executable, "-X", "faulthandler", "-c", program]
        for action, said in ((None, "4"), (("short",), "2"), (("errno", 28), "Errno 28"), (("kill",), "")):
            with tempfile.TemporaryDirectory() as folder:
                action = action and tracer.Action("write", 1, *action)
                ended, counts = tracer.trace(command, folder, action, runs.Limits())
                self.assertIn(said, ended.said)
                self.assertGreaterEqual(counts["write"], 1)


if __name__ == "__main__":
    unittest.main()
