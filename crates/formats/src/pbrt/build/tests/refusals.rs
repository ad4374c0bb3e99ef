use super::{LENIENT, LoadOptions, STRICT, build};
use crate::cases;
use crate::pbrt::parse_text;
use expect_test::expect_file;

/// Returns the error of a scene, or its warnings.
pub(super) fn outcome(text: &str, options: &LoadOptions) -> String {
    let loaded = parse_text("s.pbrt", text).and_then(|description| build(&description, options));
    cases::of_reading(loaded.map(|loaded| loaded.warnings))
}

#[test]
fn errors_and_warnings_of_scenes() {
    for file in [
        expect_file!["lights.txt"],
        expect_file!["materials.txt"],
        expect_file!["media.txt"],
        expect_file!["refusals.txt"],
    ] {
        cases::check(&file, |text| outcome(text, &STRICT));
    }
    cases::check(&expect_file!["lenient.txt"], |text| outcome(text, &LENIENT));
}
