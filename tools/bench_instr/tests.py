"""Tests of this tool: python3 tools/bench_instr --self-test"""

import copy
import unittest

import callgrind
import figures
import harness
import measure

# As callgrind writes it, with and without compressed names; lines inlined into `b` count as `b`'s.
PROFILE = """\
# callgrind format
version: 1
positions: line
events: Ir
summary: 1234

ob=(1) /bin/program
fl=(1) a.rs
fn=(1) crate::a
10 5
+2 7
cfi=(2) b.rs
cfn=(2) crate::b
calls=3 20
+1 300
* 1

fn=(2)
20 100
fi=(3) inlined.rs
5 150
cfn=plain
calls=1 0
-5 50

fn=plain
0 40
cfn=plain
calls=2 0
0 9
totals: 1234
"""


class Parsing(unittest.TestCase):
    def setUp(self):
        self.profile = callgrind.parse(PROFILE.splitlines(keepends=True))

    def test_own_instructions_are_those_of_cost_lines_but_calls(self):
        self.assertEqual(dict(self.profile.own), {"crate::a": 13, "crate::b": 250, "plain": 40})
        self.assertEqual(self.profile.total(), 303)

    def test_callees_belong_to_the_whole_and_recursion_does_not(self):
        whole = {name: self.profile.inclusive(name) for name in self.profile.own}
        self.assertEqual(whole, {"crate::a": 313, "crate::b": 300, "plain": 40})

    def test_counts_of_both_runs_cancel(self):
        twice = callgrind.parse((PROFILE + PROFILE[PROFILE.index("fn=(2)\n"):]).splitlines())
        difference = twice.minus(self.profile)
        self.assertEqual(dict(difference.own), {"crate::b": 250, "plain": 40})
        self.assertEqual(difference.inclusive("crate::b"), 300)
        self.assertEqual(difference.find("^crate"), ["crate::b"])


class Stages(unittest.TestCase):
    def lines(self, names):
        return callgrind.parse(line for name, count in names
                               for line in ("fn=%s" % name, "0 %d" % count))

    NAMES = [
        ("bidir::integrator::stages::walk::walk_camera", 100),
        ("bidir::integrator::stages::walk::walk_light", 60),
        ("bidir::integrator::stages::walk::hits", 10),
        ("bidir::integrator::stages::light_image::light_image", 50),
        ("bidir::integrator::stages::connect::connect", 200),
        ("<bidir::select::simple::All as bidir::select::Selector>::select", 8),
        ("bidir::integrator::stages::trace::shadow_rays", 120),
        ("bidir::driver::deposit::Deposit::take", 20),
        ("bidir::driver::session::Session::step", 32),
    ]

    def test_stages_are_found_and_the_rest_is_other(self):
        found = measure.stages(self.lines(self.NAMES), 2)
        self.assertEqual(found, {"walk": 80, "hits": 5, "light_image": 25, "candidates": 100,
                                 "select": 4, "shadow": 60, "film": 10, "other": 16})

    def test_a_stage_without_function_is_an_error(self):
        for i in range(2, 8):
            names = self.NAMES[:i] + self.NAMES[i + 1:]
            with self.assertRaisesRegex(harness.Failed, "no function is"):
                measure.stages(self.lines(names), 2)

    def test_names_are_short(self):
        self.assertEqual(measure.short("bidir::path::scatter::<impl bidir::path::vertex::Vertex>"
                                       "::pdf"), "Vertex::pdf")
        self.assertEqual(measure.short(self.NAMES[5][0]), "All::select")
        self.assertEqual(measure.short("bidir_accel::traverse::traverse"), "traverse::traverse")


class Comparing(unittest.TestCase):
    KEPT = {
        "made_with": "valgrind-1",
        "samples": {"room, path": {"instructions": 10000, "rays": 2.0, "instructions_per_ray": 5000}},
        "stages": {"walk": 6000, "select": 100, "other": 500},
        "functions": [["traverse", 2000, 3000]],
    }

    def check(self, part, key, factor, *changed):
        """Compares figures of which one is multiplied, and expects the names of those that changed."""
        new = copy.deepcopy(self.KEPT)
        (new[part]["room, path"] if part == "samples" else new[part])[key] *= factor
        self.assertEqual([name for name, _, _ in figures.changes(new, self.KEPT)], list(changed))
        self.assertIn("%+.1f %%" % (100 * (factor - 1)) if changed else "than 3 %: nothing.",
                      figures.report(new, self.KEPT))

    def test_three_percent_are_shown_in_both_directions(self):
        for factor in (0.969, 1.031):
            self.check("samples", "instructions", factor, "room, path: instructions")
            self.check("stages", "walk", factor, "stage walk")
        for factor in (0.971, 1.0, 1.029):
            self.check("samples", "instructions", factor)

    def test_rays_count_and_small_stages_do_not(self):
        self.check("samples", "rays", 1.1, "room, path: rays")
        self.check("stages", "select", 1.5)
        self.check("stages", "select", 3, "stage select")
        self.check("stages", "other", 3)

    def test_new_rows_are_listed_but_are_no_change(self):
        empty = {"made_with": "", "samples": {}, "stages": {}, "functions": []}
        self.assertEqual(figures.changes(self.KEPT, empty), [])
        self.assertIn("room, path: rays: new", figures.report(self.KEPT, empty))

    def test_tables_have_a_cell_for_each_method(self):
        sample = measure.sample(12345.6, 2.5)
        new = dict(self.KEPT, samples={"room, path": sample, "hall, bdpt": sample})
        text = figures.report(new, self.KEPT)
        self.assertIn("| `room` | 12.3 (2.50, 4938) | - |", text)
        self.assertIn("| `hall` | - | 12.3 (2.50, 4938) |", text)
