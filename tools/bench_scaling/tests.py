"""Tests of this tool: python3 tools/bench_scaling --self-test"""

import itertools
import os
import struct
import tempfile
import unittest

import runs
import sweeps
import worlds


class Worlds(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.worlds = worlds.Folder(self.folder.name)

    def mesh(self, name):
        """Points and triangles of a PLY file."""
        with open(os.path.join(self.folder.name, name), "rb") as file:
            head, body = file.read().split(b"end_header\n")
        counts = [int(line.split()[2]) for line in head.splitlines() if b"element" in line]
        points = [struct.unpack_from("<3f", body, 12 * i) for i in range(counts[0])]
        rows = [struct.unpack_from("<B3i", body, 12 * counts[0] + 13 * i)
                for i in range(counts[1])]
        self.assertEqual(len(body), 12 * counts[0] + 13 * counts[1])
        self.assertTrue(all(row[0] == 3 and max(row[1:]) < counts[0] for row in rows))
        return points, [row[1:] for row in rows]

    def test_counts_are_near_the_requested_ones(self):
        for asked in (100, 1000, 10000):
            _, count = self.worlds.triangles(asked)
            _, faces = self.mesh("terrain-%d.ply" % asked)
            self.assertEqual(len(faces), count)
            self.assertLess(abs(count / asked - 1), 0.1)
        scene, count = self.worlds.instances(100)
        with open(scene, encoding="utf-8") as file:
            self.assertEqual(968 * file.read().count("ObjectInstance"), count)

    def test_lamps_have_the_same_area_and_face_down(self):
        makers = ((self.worlds.lamps, 0.5), (self.worlds.hall, 72.0))
        for (make, whole), asked in itertools.product(makers, (1, 10, 100, 1000)):
            _, count = make(asked)
            points, faces = self.mesh("lamps-%d.ply" % round(count ** 0.5))
            self.assertEqual(len(faces), count)
            area = 0.0
            for face in faces:
                a, b, c = [points[i] for i in face]
                u, v = [[q[k] - a[k] for k in range(3)] for q in (b, c)]
                normal = u[2] * v[0] - u[0] * v[2]
                self.assertLess(normal, 0)
                area -= normal / 2
            self.assertAlmostEqual(area / whole, 1.0, places=4)


class Tables(unittest.TestCase):
    STATS = {"samples_per_second": 2000.0, "rays": {"total": 60}, "samples": 20,
             "load_seconds": 0.5, "film_bytes": 100, "bvh_bytes": 400}

    def test_a_table_has_ratios_to_its_first_row(self):
        cases = [runs.Case(size, method, "a.pbrt") for size in (10, 1000) for method in sweeps.METHODS]
        fast = runs.cost(self.STATS, 5e6)
        slow = fast._replace(samples_per_second=500.0)
        costs = {(case.size, case.method): fast if case.size == 10 else slow for case in cases}
        lines = sweeps.Sweep("A", "things", cases, sweeps.LOAD).table(costs).splitlines()
        self.assertEqual(lines[2], "| 10 | 2 k | 1.00 | 2 k | 1.00 | 0.50 |")
        self.assertEqual(lines[3], "| 1 k | 500 | 0.25 | 500 | 0.25 | 0.50 |")
        self.assertEqual({line.count("|") for line in lines}, {7})
        self.assertEqual(fast.rays_per_sample, 3.0)

    def test_amounts_have_three_digits(self):
        for number, text in ((7.0, "7"), (968, "968"), (999698, "1 M"), (99856, "99.9 k")):
            self.assertEqual(sweeps.amount(number), text)
