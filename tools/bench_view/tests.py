"""Tests of this tool: python3 tools/bench_view --self-test"""

import struct
import unittest

import figures
import server


class Streams(unittest.TestCase):
    def test_messages_are_counted_however_they_are_cut(self):
        text = b"\x81\x05hello"
        small = b"\x82\x7e" + struct.pack(">H", 300) + bytes(300)
        large = b"\x82\x7f" + struct.pack(">Q", 70000) + b"\x82" * 70000
        data = (text + small + large) * 3
        for step in (1, 7, 4096, len(data)):
            stream = server.Stream()
            for begin in range(0, len(data), step):
                stream.take(data[begin:begin + step])
            self.assertEqual((stream.frames, stream.left, stream.head), (6, 0, b""))


class Figures(unittest.TestCase):
    def test_the_interval_of_a_median_is_that_of_the_binomial_distribution(self):
        # Of twelve values the third and the tenth: 1 - 2 (1 + 12 + 66) / 4096 = 0.961.
        self.assertEqual(figures.median_interval(range(1, 13)), (3, 10))
        # Of six the first and the last, of less no such bounds.
        self.assertEqual(figures.median_interval([3, 1, 2, 6, 5, 4]), (1, 6))
        self.assertEqual(figures.median_interval([2, 1]), (1, 2))

    def test_the_table_has_medians_of_pairs(self):
        pairs = [figures.Pair(1e6, 1e6 * ratio) for ratio in (0.9, 0.96, 0.99)]
        table = figures.table(pairs, (1e8, 2e8, 3e8), 5)
        self.assertIn("| 3 pairs |", table)
        self.assertIn("0.960 (0.900 to 0.990)", table)
        self.assertIn("| 100 MB | 200 MB, 300 MB |", table)


if __name__ == "__main__":
    unittest.main()
