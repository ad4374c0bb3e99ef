//! The exact messages of errors.

use crate::cases;
use crate::pbrt::parse_text;
use expect_test::expect_file;
use miette::{GraphicalReportHandler, GraphicalTheme};

#[test]
fn errors_of_texts() {
    cases::check(&expect_file!["errors.txt"], |text| {
        cases::of_reading(parse_text("s.pbrt", text).map(|_| Vec::new()))
    });
}

#[test]
fn the_fancy_report_marks_the_place() {
    let text = "WorldBegin\n# walls\nMaterial \"difuse\" # red\nShape \"sphere\"\n";
    let error = parse_text("box.pbrt", text).unwrap_err();
    let mut report = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .render_report(&mut report, &error)
        .unwrap();
    let expected = "  × box.pbrt:3:10: unknown material `difuse`; did you mean `diffuse`?
   ╭─[box.pbrt:3:10]
 2 │ # walls
 3 │ Material \"difuse\" # red
   ·          ────────
 4 │ Shape \"sphere\"
   ╰────
";
    assert_eq!(report, expected);
}
