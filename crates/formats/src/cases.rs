//! Test cases in text files: inputs, each with its outcome.
//!
//! Empty lines separate cases. Lines after `=> ` are the outcome of a case, which `UPDATE_EXPECT=1` writes anew; blocks
//! that begin with `##` are headings.

use crate::error::Result;
use expect_test::ExpectFile;

const MARK: &str = "=> ";

/// Checks the outcome of every case of a file.
#[track_caller]
pub(crate) fn check(file: &ExpectFile, outcome: impl Fn(&str) -> String) {
    let text = file.data();
    let is_case = |block: &str| !block.is_empty() && !block.starts_with("##");
    assert!(text.split("\n\n").any(is_case), "no case");
    let run = |block: &str| {
        if !is_case(block) {
            return block.to_owned();
        }
        let input: Vec<_> = block
            .lines()
            .filter(|line| !line.starts_with(MARK))
            .collect();
        let outcome = outcome(&input.join("\n"));
        let outcome = outcome.lines().map(|line| format!("{MARK}{line}"));
        let lines = input.iter().map(|&line| line.to_owned()).chain(outcome);
        lines.collect::<Vec<_>>().join("\n")
    };
    let blocks: Vec<_> = text.trim_end().split("\n\n").map(run).collect();
    file.assert_eq(&(blocks.join("\n\n") + "\n"));
}

/// Returns the outcome of reading as text: the error with its kind, or the warnings.
pub(crate) fn of_reading(read: Result<Vec<String>>) -> String {
    match read {
        Err(error) => format!("{:?}: {error}", error.kind()),
        Ok(warnings) if warnings.is_empty() => "accepted".into(),
        Ok(warnings) => warnings.join("\n"),
    }
}

/// Replaces the JSON escapes of a line by the characters they stand for.
pub(crate) fn unescaped(line: &str) -> String {
    serde_json::from_str(&format!("\"{line}\"")).unwrap()
}

/// Parses `NAME: CONTENT`, with escapes, and returns the name of the file and its bytes, one for each character.
pub(crate) fn file(line: &str) -> (&str, Vec<u8>) {
    let (name, content) = line.split_once(": ").unwrap();
    let content = unescaped(content);
    let bytes = content.chars().map(|c| u8::try_from(c).unwrap());
    (name, bytes.collect())
}
