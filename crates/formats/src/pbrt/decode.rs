//! Decodes the bytes of a scene file to text.

use crate::error::{Error, ErrorKind, Place, Result};
use crate::source::line_and_column;
use std::path::Path;

/// Decodes bytes as UTF-8. Bytes of comments that are not UTF-8 count as Latin-1. Errors: other bytes are not UTF-8,
/// or the text is UTF-16.
pub(super) fn decode(path: &Path, bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let error = Error::new(ErrorKind::Syntax, "the text is UTF-16").in_file(path);
        return Err(error.with_hint("save it as UTF-8"));
    }
    String::from_utf8(bytes).or_else(|error| decode_comments(path, error.as_bytes()))
}

fn decode_comments(path: &Path, bytes: &[u8]) -> Result<String> {
    let mut text = String::with_capacity(bytes.len() + bytes.len() / 8);
    let mut state = State::Between;
    for chunk in bytes.utf8_chunks() {
        // A byte-order mark is no word.
        let mark = if text.is_empty() { "\u{feff}" } else { "" };
        let words = chunk.valid().trim_start_matches(mark);
        state = words.bytes().fold(state, State::after);
        text.push_str(chunk.valid());
        let invalid = chunk.invalid();
        if !invalid.is_empty() && state != State::Comment {
            return Err(not_text(path, &text));
        }
        text.extend(invalid.iter().map(|&byte| char::from(byte)));
    }
    Ok(text)
}

/// Returns the error of a text whose byte after `before` is not UTF-8.
fn not_text(path: &Path, before: &str) -> Error {
    let (line, column) = line_and_column(before, before.len());
    let error = Error::new(ErrorKind::Syntax, "the text is not UTF-8").in_file(path);
    let place = Place {
        line,
        column,
        excerpt: None,
    };
    error.at(place).with_hint("save it as UTF-8")
}

/// The kind of token that a byte is part of, as the lexer splits the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Between,
    Word,
    Quoted,
    /// After a backslash in quotes.
    Escaped,
    Comment,
}

impl State {
    #[expect(clippy::match_same_arms, reason = "each state has its arms together")]
    fn after(self, byte: u8) -> Self {
        match (self, byte) {
            (Self::Comment, b'\r' | b'\n') => Self::Between,
            (Self::Comment, _) => Self::Comment,
            (Self::Quoted | Self::Escaped, b'\n') | (Self::Quoted, b'"') => Self::Between,
            (Self::Quoted, b'\\') => Self::Escaped,
            (Self::Quoted | Self::Escaped, _) => Self::Quoted,
            (_, b'"') => Self::Quoted,
            (_, b' ' | b'\t' | b'\r' | b'\n' | b'[' | b']') => Self::Between,
            (Self::Between, b'#') => Self::Comment,
            (Self::Between | Self::Word, _) => Self::Word,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(bytes: &[u8], expected: &str) {
        let text = decode(Path::new("a"), bytes.to_vec());
        let text = text.unwrap_or_else(|error| error.to_string());
        assert_eq!(text, expected);
    }

    #[test]
    fn bytes_of_comments_are_latin_1_where_they_are_not_utf_8() {
        check("µ".as_bytes(), "µ");
        check(b"# caf\xe9\nFilm", "# café\nFilm");
        check(b"a [1 2]#\xff\xfe", "a [1 2]#ÿþ");
        check(b"\"a#b\" # \xe9", "\"a#b\" # é");
        check(b"\"a\\\"b\"#\xe9 \"\xe9", "\"a\\\"b\"#é \"é");
        check(b"#\xc3\xa9 \xe9\r#\xe9", "#é é\r#é");
        check(b"\xef\xbb\xbf#\xe9", "\u{feff}#é");
    }

    #[test]
    fn bytes_of_words_and_strings_are_utf_8() {
        let expected = |place: &str| format!("a:{place}: the text is not UTF-8; save it as UTF-8");
        check(b"Film \xe9", &expected("1:6"));
        check(b"# ok \xe9\n\"caf\xe9.png\"", &expected("2:5"));
        check(b"1.0#\xe9", &expected("1:5"));
        check(b"\"a\\\xe9\"", &expected("1:4"));
        check(b"# \n\xe9", &expected("2:1"));
    }
}
