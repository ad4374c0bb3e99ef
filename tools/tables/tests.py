"""Tests of this tool: python3 tools/tables --self-test"""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import __main__ as tables

DATA = """# command: bidir render a.pbrt
# date: 2026-01-02
# version: bidir 0.1.0
# machine: two cores
# note: one more comment
scene,path,low,high
a,2.5,2,3
b,10,,
c,0.25,a|b,1
"""
PAGE = "# Page\n\n<!-- table: a.csv%s -->\nold\n<!-- end of table -->\n\nText.\n"


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = Path(folder.name, "page.md")
        self.data = Path(folder.name, "a.csv")
        self.data.write_text(DATA, encoding="utf-8")

    def made(self, options=""):
        self.page.write_text(PAGE % options, encoding="utf-8")
        return tables.rewritten(self.page)[1]

    def run_it(self, *flags):
        said = io.StringIO()
        line = ["tables", str(self.page), *flags]
        with mock.patch.object(sys, "argv", line), contextlib.redirect_stderr(said):
            return tables.main(), said.getvalue()

    def test_a_table_has_all_columns_and_its_source(self):
        page = self.made()
        self.assertIn("| scene | path | low | high |\n|---|---:|---|---:|\n| a | 2.5 | 2 | 3 |\n", page)
        self.assertIn("| c | 0.25 | a\\|b | 1 |\n\n`bidir render a.pbrt`, 2026-01-02 ([data](a.csv))\n", page)
        self.assertTrue(page.startswith("# Page\n\n<!-- table: a.csv -->\n\n"))
        self.assertTrue(page.endswith("\n\n<!-- end of table -->\n\nText.\n"))

    def test_columns_are_templates_and_rows_are_chosen(self):
        page = self.made("\n  columns: Scene = `{scene}` | Range = {low} to {high} | P = {path:.2f}"
                         "\n  rows: scene = b, a\n  source: no")
        self.assertIn("-->\n\n| Scene | Range | P |\n|---|---:|---:|\n", page)
        self.assertIn("\n| `b` |  | 10.00 |\n| `a` | 2 to 3 | 2.50 |\n\n<!-- end", page)

    def test_a_table_made_again_is_the_same(self):
        once = self.made("\n  rows: path = 10")
        self.page.write_text(once, encoding="utf-8")
        self.assertEqual(tables.rewritten(self.page), (once, once))

    def test_a_page_that_is_out_of_date_is_found_and_rewritten(self):
        new = self.made()
        self.assertEqual(self.run_it("--check")[0], 1)
        self.assertIn("\nold\n", self.page.read_text(encoding="utf-8"))
        self.assertEqual(self.run_it(), (0, ""))
        self.assertEqual(self.page.read_text(encoding="utf-8"), new)
        self.assertEqual(self.run_it("--check"), (0, ""))

    def test_mistakes_are_named(self):
        for options, text in [
            ("columns: A = {nothing}", "nothing"),
            ("columns: A = {scene:.2f}", "does not fit"),
            ("columns: A", "does not fit"),
            ("rows: scene = z", "scene = z"),
            ("rows: nothing = z", "nothing"),
            ("colums: A = {scene}", "options"),
        ]:
            self.page.write_text(PAGE % ("\n  " + options), encoding="utf-8")
            self.assertRegex(self.run_it("--check")[1], text)
        self.page.write_text("<!-- table: a.csv -->\n", encoding="utf-8")
        self.assertRegex(self.run_it()[1], "no end")
        self.page.write_text((PAGE % "").replace("a.csv", "b.csv"), encoding="utf-8")
        self.assertRegex(self.run_it()[1], "No such file.*b.csv")

    def test_data_without_its_origin_is_refused(self):
        for key in tables.KEYS:
            self.data.write_text(DATA.replace("# %s:" % key, "# other:"), encoding="utf-8")
            with self.assertRaisesRegex(tables.Fault, "lacks `# %s" % key):
                self.made()
        self.data.write_text(DATA + "d,1\n", encoding="utf-8")
        with self.assertRaisesRegex(tables.Fault, "different lengths"):
            self.made()
