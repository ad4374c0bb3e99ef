"""Tests of what benches share: python3 tools/tests.py"""

import sys
import tempfile
import unittest
import unittest.mock

sys.dont_write_bytecode = True

import harness


class Runs(unittest.TestCase):
    def test_usage_is_that_of_the_child_alone(self):
        usage = harness.run([sys.executable, "-c", "bytes(range(256)) * 400_000"])
        self.assertGreater(usage.peak, 1e8)
        self.assertGreater(usage.wall, 0)

    def test_settings_of_the_caller_are_left_out_and_failures_have_the_output(self):
        program = "import os, sys; sys.exit('got ' + os.environ.get('BIDIR_A', '-') + os.environ['BIDIR_ISA'])"
        with unittest.mock.patch.dict("os.environ", BIDIR_A="b"), self.assertRaisesRegex(harness.Failed, "got -sse2"):
            harness.run([sys.executable, "-c", program], BIDIR_ISA="sse2")

    def test_numbers_of_a_render_are_read(self):
        # It stands in for the program: its arguments are those of `render`.
        program = "import sys; open(sys.argv[sys.argv.index('--stats') + 1], 'w').write('{\"samples\": 3}')"
        with tempfile.TemporaryDirectory() as folder:
            stats, _ = harness.render([sys.executable, "-c", program], folder, "a.pbrt", "--spp", "3")
        self.assertEqual(stats, {"samples": 3})


class Figures(unittest.TestCase):
    def test_every_second_round_is_in_reverse(self):
        self.assertEqual(list(harness.turns("abc", 3)), list("abccbaabc"))

    def test_the_interval_of_a_median_is_that_of_the_binomial_distribution(self):
        # Of twelve values the third and the tenth: 1 - 2 (1 + 12 + 66) / 4096 = 0.961.
        self.assertEqual(harness.median_interval(range(1, 13)), (3, 10))
        # Of six the first and the last, of less no such bounds.
        self.assertEqual(harness.median_interval([3, 1, 2, 6, 5, 4]), (1, 6))
        self.assertEqual(harness.median_interval([2, 1]), (1, 2))
        self.assertEqual(harness.interval([0.99, 0.9, 0.96]), "0.960 (0.900 to 0.990)")

    def test_tables_are_markdown(self):
        self.assertEqual(harness.table(["a", "b"], [["c", 1], ["d", 2]]), "| a | b |\n|---|---:|\n| c | 1 |\n| d | 2 |")


if __name__ == "__main__":
    unittest.main()
