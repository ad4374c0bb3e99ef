//! Cases of tests in files: a line of input, and below it, indented, what the code says to it.
//!
//! The input is the inside of a string of JSON, of which each character is a byte.

use expect_test::ExpectFile;

/// Checks that `say` says to each input what the file has.
pub(crate) fn check(file: &ExpectFile, say: impl Fn(&str) -> String) {
    let text = file.data();
    let mut said = String::new();
    for line in text.lines().filter(|line| !line.starts_with(' ')) {
        said += &format!("{line}\n");
        if !line.is_empty() {
            let input: String = serde_json::from_str(&format!("\"{line}\"")).unwrap();
            said += &format!("    {}\n", say(&input).replace('\n', "\n    "));
        }
    }
    assert!(!said.is_empty(), "there is no case");
    file.assert_eq(&said);
}

/// Returns each character as a byte.
pub(crate) fn bytes(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(c).unwrap()).collect()
}
