//! Decodes the bytes of a scene file to text.

use super::lexer::spans;
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
    let mut invalid = Vec::new();
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        for &byte in chunk.invalid() {
            invalid.push(text.len());
            text.push(char::from(byte));
        }
    }
    match first_in_token(&text, invalid) {
        Some(at) => Err(not_text(path, &text[..at])),
        None => Ok(text),
    }
}

/// Returns the first of these increasing offsets that is within a token, and not in a comment.
fn first_in_token(text: &str, offsets: Vec<usize>) -> Option<usize> {
    let mut tokens = spans(text).peekable();
    offsets.into_iter().find(|&at| {
        while tokens.next_if(|token| token.end <= at).is_some() {}
        tokens.peek().is_some_and(|token| token.start <= at)
    })
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
