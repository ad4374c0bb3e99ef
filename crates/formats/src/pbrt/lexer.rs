//! Splits a scene's text into words, quoted strings and brackets.

use crate::source::{Fault, FileId, Span};
use logos::{Lexer, Logos};
use std::borrow::Cow;
use std::ops::Range;

#[derive(Clone, Copy, Debug, Logos, PartialEq)]
#[logos(skip(r"[ \t\r\n]+"))]
// A comment begins between tokens; inside a word, `#` is an ordinary character.
#[logos(skip(r"#[^\r\n]*", allow_greedy = true))]
enum Raw {
    #[token("[")]
    Open,
    #[token("]")]
    Close,
    #[regex(r#""([^"\\\n]|\\[^\n])*""#)]
    Quoted,
    #[regex(r#""([^"\\\n]|\\[^\n])*\\?"#)]
    Unterminated,
    #[regex(r##"[^ \t\r\n"\[\]#][^ \t\r\n"\[\]]*"##)]
    Word,
}

/// Returns the range of bytes of each token, which comments and white space separate.
pub(super) fn spans(text: &str) -> impl Iterator<Item = Range<usize>> {
    lexer(text).spanned().map(|(_, span)| span)
}

/// Returns the lexer of a text, after its byte order mark.
fn lexer(text: &str) -> Lexer<'_, Raw> {
    let content = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lexer = Raw::lexer(text);
    lexer.bump(text.len() - content.len());
    lexer
}

/// The kind of a token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind<'t> {
    /// `[`
    Open,
    /// `]`
    Close,
    /// A quoted string, its escapes resolved.
    Quoted(Cow<'t, str>),
    /// A directive, a number, `true` or `false`.
    Word(&'t str),
}

/// A token and its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token<'t> {
    pub(super) kind: TokenKind<'t>,
    pub(super) span: Span,
}

impl Token<'_> {
    /// Describes the token for "expected …, found …".
    pub(super) fn describe(&self) -> String {
        match &self.kind {
            TokenKind::Open => "`[`".into(),
            TokenKind::Close => "`]`".into(),
            TokenKind::Quoted(text) => format!("the string \"{}\"", shorten(text)),
            TokenKind::Word(word) => format!("`{}`", shorten(word)),
        }
    }
}

/// Shortens a name for messages.
pub(super) fn shorten(text: &str) -> Cow<'_, str> {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]).into(),
        None => text.into(),
    }
}

/// The tokens of one text, with one token of look-ahead.
pub(super) struct Tokens<'t> {
    lexer: Lexer<'t, Raw>,
    file: FileId,
    ahead: Option<Token<'t>>,
    last: Span,
}

impl<'t> Tokens<'t> {
    pub(super) fn new(text: &'t str, file: FileId) -> Self {
        // A byte-order mark would become a part of the first word.
        let lexer = lexer(text);
        let begin = lexer.span().end;
        Self {
            lexer,
            file,
            ahead: None,
            last: Span::new(file, begin..begin),
        }
    }

    /// Takes the next token. None: the text has ended.
    pub(super) fn next(&mut self) -> Result<Option<Token<'t>>, Fault> {
        self.peek()?;
        let token = self.ahead.take();
        self.last = token.as_ref().map_or(self.last, |token| token.span);
        Ok(token)
    }

    /// Returns the next token without taking it.
    pub(super) fn peek(&mut self) -> Result<Option<&Token<'t>>, Fault> {
        if self.ahead.is_none() {
            self.ahead = self.read()?;
        }
        Ok(self.ahead.as_ref())
    }

    /// Takes the next token if it is a quoted string.
    pub(super) fn next_if_quoted(&mut self) -> Result<Option<(Cow<'t, str>, Span)>, Fault> {
        let ahead = self.peek()?.map(|token| &token.kind);
        if matches!(ahead, Some(TokenKind::Quoted(_))) {
            return self.expect_quoted("a string").map(Some);
        }
        Ok(None)
    }

    /// Takes the next token. Errors: the text has ended.
    pub(super) fn expect(&mut self, what: &str) -> Result<Token<'t>, Fault> {
        let last = self.last;
        let missing = || Fault::syntax(last, format!("expected {what}, found the end of the file"));
        self.next()?.ok_or_else(missing)
    }

    /// Takes the next token. Errors: it is not a quoted string.
    pub(super) fn expect_quoted(&mut self, what: &str) -> Result<(Cow<'t, str>, Span), Fault> {
        let token = self.expect(what)?;
        if let TokenKind::Quoted(text) = token.kind {
            return Ok((text, token.span));
        }
        let message = format!("expected {what} in quotes, found {}", token.describe());
        Err(Fault::syntax(token.span, message))
    }

    fn read(&mut self) -> Result<Option<Token<'t>>, Fault> {
        let Some(raw) = self.lexer.next() else {
            return Ok(None);
        };
        let span = Span::new(self.file, self.lexer.span());
        let text = self.lexer.slice();
        let kind = match raw {
            Ok(Raw::Open) => TokenKind::Open,
            Ok(Raw::Close) => TokenKind::Close,
            Ok(Raw::Word) => TokenKind::Word(text),
            Ok(Raw::Quoted) => {
                let inside = &text[1..text.len() - 1];
                if is_unclosed(inside, self.lexer.remainder()) {
                    return Err(unclosed(inside, span));
                }
                TokenKind::Quoted(unescape(inside, span)?)
            }
            Ok(Raw::Unterminated) => {
                let fault = Fault::syntax(span, "the string does not end on its line");
                return Err(fault.with_hint("add the closing `\"`"));
            }
            Err(()) => return Err(Fault::syntax(span, "unreadable text")),
        };
        Ok(Some(Token { kind, span }))
    }
}

/// Returns true if the quote between `inside` and `after` probably opens the next string, so that the string of
/// `inside` is not closed: `inside` ends with a blank, and a word follows the quote directly.
fn is_unclosed(inside: &str, after: &str) -> bool {
    inside.ends_with([' ', '\t']) && after.starts_with(|next: char| next.is_ascii_alphabetic())
}

fn unclosed(inside: &str, span: Span) -> Fault {
    let fault = Fault::syntax(span, "the string has no closing quote");
    let text = shorten(inside.trim_end());
    fault.with_hint(format!("write `\"{text}\"`"))
}

/// Resolves the escapes of the text between quotes.
fn unescape(text: &str, span: Span) -> Result<Cow<'_, str>, Fault> {
    if !text.contains('\\') {
        return Ok(text.into());
    }
    let mut resolved = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\\') {
        resolved.push_str(&rest[..at]);
        let mut after = rest[at + 1..].chars();
        resolved.push(match after.next() {
            Some('b') => '\u{8}',
            Some('f') => '\u{c}',
            Some('n') => '\n',
            Some('r') => '\r',
            Some('t') => '\t',
            Some(same @ ('\\' | '\'' | '"')) => same,
            other => {
                let escape = other.map(String::from).unwrap_or_default();
                let message = format!("unknown escape `\\{escape}` in a string");
                let fault = Fault::syntax(span, message);
                return Err(fault.with_hint("write `\\\\` for a backslash, `/` in paths"));
            }
        });
        rest = after.as_str();
    }
    resolved.push_str(rest);
    Ok(resolved.into())
}

/// Reads a number in the syntax of the format: no `inf`, no `nan`, nothing after it.
pub(super) fn parse_float(word: &str) -> Option<f64> {
    let digits = word.trim_start_matches(['+', '-']);
    let hex = digits
        .strip_prefix("0x")
        .or_else(|| digits.strip_prefix("0X"));
    if let Some(hex) = hex {
        let value = u64::from_str_radix(hex, 16)
            .ok()
            .filter(|_| !hex.starts_with('+'))? as f64;
        return Some(if word.starts_with('-') { -value } else { value });
    }
    if !digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') {
        return None;
    }
    word.parse().ok()
}

/// Returns the fault of a token in the place of a number.
pub(super) fn not_a_number(token: &Token<'_>) -> Fault {
    let message = format!("expected a number, found {}", token.describe());
    Fault::syntax(token.span, message)
}

/// Returns the fault of a number that is too large for its type.
pub(super) fn too_large(word: &str, span: Span) -> Fault {
    let message = format!("the number `{}` is too large", shorten(word));
    Fault::scene(span, message)
}

/// Reads an integer of 32 bits: a sign and digits only.
pub(super) fn parse_integer(word: &str) -> Option<i32> {
    word.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceMap;
    use std::path::Path;

    fn lex(text: &str) -> String {
        let mut sources = SourceMap::default();
        let file = sources.add(Path::new("t"), text.into()).unwrap();
        let mut tokens = Tokens::new(text, file);
        let mut texts = Vec::new();
        loop {
            match tokens.next() {
                Ok(Some(token)) => texts.push(match token.kind {
                    TokenKind::Quoted(text) => format!("<{text}>"),
                    TokenKind::Word(word) => word.into(),
                    TokenKind::Open => "[".into(),
                    TokenKind::Close => "]".into(),
                }),
                Ok(None) => break,
                Err(fault) => {
                    texts.push(format!("error {}", sources.error(fault)));
                    break;
                }
            }
        }
        texts.join(" ")
    }

    #[track_caller]
    fn check(text: &str, expected: &str) {
        assert_eq!(lex(text), expected);
    }

    #[test]
    fn tokens_are_split_as_the_format_says() {
        check("", "");
        check(" \t\r\n", "");
        check("Shape\"sphere\"[1]2", "Shape <sphere> [ 1 ] 2");
        check("a,b -.5e3", "a,b -.5e3");
        check("a # b \"c\n d", "a d");
        check("1.0#x # y", "1.0#x");
        check("\"a#b\"#c\n]#d", "<a#b> ]");
        check("a #b\rc", "a c");
        check("\u{feff}Camera", "Camera");
        check("\"µ\" µ", "<µ> µ");
        check("# the whole file", "");
    }

    #[test]
    fn strings_have_escapes_and_end_on_their_line() {
        check(r#""a\\b\"c\'\n""#, "<a\\b\"c'\n>");
        check(r#""""#, "<>");
        check(
            r#""a\qb""#,
            "error t:1:1: unknown escape `\\q` in a string; write `\\\\` for a backslash, `/` in paths",
        );
        let unterminated = "the string does not end on its line; add the closing `\"`";
        check("x \"a\nb\"", &format!("x error t:1:3: {unterminated}"));
        check("\"a\\\n\"", &format!("error t:1:1: {unterminated}"));
        check("\"", &format!("error t:1:1: {unterminated}"));
    }

    #[track_caller]
    fn check_float(word: &str, expected: Option<f64>) {
        assert_eq!(parse_float(word), expected, "{word}");
    }

    #[test]
    fn numbers_are_plain_numbers() {
        for (word, value) in [
            ("1", 1.0),
            ("-.5", -0.5),
            ("5.", 5.0),
            ("+1e-3", 1e-3),
            ("0x1F", 31.0),
        ] {
            check_float(word, Some(value));
        }
        for word in [
            "inf", "nan", "-inf", "Infinity", "1.0#x", "1,", "", "-", "1e", "0x", "0x+1", "--1",
        ] {
            check_float(word, None);
        }
        assert_eq!(parse_integer("-12"), Some(-12));
        assert_eq!(parse_integer("5.0"), None);
        assert_eq!(parse_integer("3000000000"), None);
    }

    #[test]
    fn long_tokens_need_no_deep_stack() {
        let long = format!(
            "#{}\n\"{}\" {}",
            "c".repeat(1 << 22),
            "s".repeat(1 << 22),
            "w".repeat(1 << 22)
        );
        assert_eq!(lex(&long).len(), 2 * (1 << 22) + 3);
    }
}
