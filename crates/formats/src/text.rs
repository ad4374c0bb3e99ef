//! Formats texts and numbers for messages. Control characters are escaped.

use std::borrow::Cow;
use std::fmt;

/// Returns one line that shows `text`: every character that [`is_obeyed`] is written as its escape,
/// such as `\n` or `\u{1b}`.
///
/// A text that is printable already stays as it is.
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

/// Returns lines that show `text`: as [`printable`], but with line feeds and tabs unescaped.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'))
}

/// Returns true for characters that make a terminal move, colour or reorder text: control characters
/// of both sets (C0 and C1), and marks of lines and of writing direction.
pub fn is_obeyed(c: char) -> bool {
    // The property Bidi_Control of Unicode, and the separators of lines and paragraphs.
    let is_mark = matches!(
        c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    c.is_control() || is_mark
}

/// Formats a number in the shorter of decimal and scientific notation: `0.5`, `1e30`.
pub fn number(value: impl Into<f64> + Copy + fmt::Display + fmt::LowerExp) -> String {
    let size = value.into().abs();
    if size == 0.0 || (1e-5..1e7).contains(&size) || !size.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_escaped(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_short_form() {
        assert_eq!(number(f32::MIN_POSITIVE), "1.1754944e-38");
        assert_eq!(number(1e30), "1e30");
        assert_eq!([number(-0.1_f32), number(12.0)], ["-0.1", "12"]);
        assert_eq!([number(0.0), number(f64::INFINITY)], ["0", "inf"]);
    }

    #[track_caller]
    fn check(text: &str, line: &str, lines: &str) {
        assert_eq!(printable(text), line);
        assert_eq!(printable_lines(text), lines);
        assert_eq!(printable(line), line);
    }

    #[test]
    fn every_control_character_is_escaped() {
        check("room µ 🏠.pbrt", "room µ 🏠.pbrt", "room µ 🏠.pbrt");
        check("a\x1b[31mb", r"a\u{1b}[31mb", r"a\u{1b}[31mb");
        check("a\x7f\u{9b}2J", r"a\u{7f}\u{9b}2J", r"a\u{7f}\u{9b}2J");
        check(
            "a\u{202e}b\u{2066}",
            r"a\u{202e}b\u{2066}",
            r"a\u{202e}b\u{2066}",
        );
        check("a\r\n\tb", r"a\r\n\tb", "a\\r\n\tb");
        check("a\u{2028}\u{61c}", r"a\u{2028}\u{61c}", r"a\u{2028}\u{61c}");
        for c in (0..=0x9f).filter_map(char::from_u32) {
            assert_eq!(is_obeyed(c), !(' '..='~').contains(&c), "{c:?}");
        }
    }
}
