//! Texts, places in them, and excerpts for messages.

use crate::error::{Error, ErrorKind, Place};
use crate::text::{printable, printable_lines};
use bidir::names::nearest;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One of the texts of a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileId(u32);

/// A range of bytes of one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// The first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    pub(crate) fn new(file: FileId, range: Range<usize>) -> Self {
        // Texts are below 4 GiB: `SourceMap::add` refuses longer ones.
        Self {
            file,
            start: range.start as u32,
            end: range.end as u32,
        }
    }

    /// Returns the span from the beginning of this one to the end of `last`, which must be in the same text.
    pub(crate) fn to(self, last: Self) -> Self {
        debug_assert_eq!(self.file, last.file);
        Self {
            end: last.end.max(self.end),
            ..self
        }
    }
}

/// An error at a place, which becomes an [`Error`] with the help of the [`SourceMap`].
#[derive(Debug)]
pub(crate) struct Fault<P = Span> {
    pub(crate) kind: ErrorKind,
    pub(crate) place: P,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
}

impl<P> Fault<P> {
    pub(crate) fn new(kind: ErrorKind, place: P, message: impl Into<String>) -> Self {
        Self {
            kind,
            place,
            message: message.into(),
            hint: None,
        }
    }

    pub(crate) fn syntax(place: P, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Syntax, place, message)
    }

    pub(crate) fn scene(place: P, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Scene, place, message)
    }

    /// Returns the fault for an error of another file, at the place that names the file.
    pub(crate) fn from_error(place: P, error: &Error) -> Self {
        Self::new(error.kind(), place, error.to_string())
    }

    pub(crate) fn with_hint(self, hint: impl Into<String>) -> Self {
        Self {
            hint: Some(hint.into()),
            ..self
        }
    }

    /// Adds the name of `known` that is nearest to `name` as a hint, if one is near.
    pub(crate) fn with_nearest<'a>(
        mut self,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        if self.hint.is_none() {
            self.hint = nearest(name, known).map(|known| format!("did you mean `{known}`?"));
        }
        self
    }
}

/// The texts that a scene was read from.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<(PathBuf, Arc<str>)>,
}

impl SourceMap {
    /// The beginning of the first text: the place of errors that concern the whole scene.
    pub(crate) const BEGINNING: Span = Span {
        file: FileId(0),
        start: 0,
        end: 0,
    };

    /// Adds a text under its name in messages.
    pub(crate) fn add(&mut self, name: &Path, text: String) -> Result<FileId, Error> {
        if u32::try_from(text.len()).is_err() {
            let message = "longer than 4 GiB";
            return Err(Error::new(ErrorKind::Limit, message).in_file(name));
        }
        self.files.push((name.to_owned(), text.into()));
        Ok(FileId(self.files.len() as u32 - 1))
    }

    /// Returns the name of a text.
    pub fn name(&self, file: FileId) -> &Path {
        &self.files[file.0 as usize].0
    }

    /// Returns a text.
    pub(crate) fn text(&self, file: FileId) -> Arc<str> {
        Arc::clone(&self.files[file.0 as usize].1)
    }

    /// Returns all texts in the order of reading.
    pub(crate) fn texts(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(_, text)| &**text)
    }

    /// Returns line and column of the beginning of `span`, both counted from 1.
    pub fn line_and_column(&self, span: Span) -> (usize, usize) {
        line_and_column(&self.files[span.file.0 as usize].1, span.start as usize)
    }

    pub(crate) fn error(&self, fault: Fault) -> Error {
        let (name, text) = &self.files[fault.place.file.0 as usize];
        let (line, column) = self.line_and_column(fault.place);
        let marked = fault.place.start as usize..fault.place.end as usize;
        let excerpt = Some(Excerpt::new(name, text, line, marked));
        let error = Error::new(fault.kind, fault.message)
            .in_file(name)
            .at(Place {
                line,
                column,
                excerpt,
            });
        match fault.hint {
            Some(hint) => error.with_hint(hint),
            None => error,
        }
    }
}

/// Returns line and column of a byte, both counted from 1.
pub(crate) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
    (line, 1 + before[line_start..].chars().count())
}

/// The lines around a place, as [`printable_lines`] writes them. Long lines are cut, so that a mesh on one line
/// does not fill the screen.
#[derive(Clone, Debug)]
pub(crate) struct Excerpt {
    name: String,
    text: String,
    marked: Range<usize>,
    /// The number of the first line of `text`, counted from 0.
    first_line: usize,
    /// The number of characters that were cut off before `text`.
    cut: usize,
}

impl Excerpt {
    /// Number of bytes shown on either side of the mark in a line that is cut.
    const MARGIN: usize = 60;
    /// Maximum number of bytes that are shown uncut, or marked.
    const WHOLE: usize = 400;

    fn new(name: &Path, text: &str, line: usize, marked: Range<usize>) -> Self {
        let name = printable(&name.to_string_lossy()).into_owned();
        let line_start = text[..marked.start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[marked.start..]
            .find('\n')
            .map_or(text.len(), |i| marked.start + i);
        // One line of context before and after.
        let start = text[..line_start.saturating_sub(1)]
            .rfind('\n')
            .map_or(0, |i| i + 1);
        let next = text.get(line_end + 1..).and_then(|rest| rest.find('\n'));
        let end = next.map_or(text.len(), |i| line_end + 1 + i);
        let mut mark_end = marked.end.min(line_end.max(marked.start));
        let mut around = start..end;
        if around.len() > Self::WHOLE {
            let before = marked.start.saturating_sub(Self::MARGIN);
            mark_end = boundary_before(text, mark_end.min(marked.start + Self::WHOLE));
            around = line_start.max(boundary_before(text, before))
                ..line_end.min(boundary_before(text, mark_end + Self::MARGIN));
        }
        let before = text.get(line_start..around.start).unwrap_or_default();
        let cut = before.chars().count();
        let first_line = line - 1 - usize::from(around.start < line_start);
        let mark = marked.start - around.start..mark_end - around.start;
        let (text, marked) = shown(&text[around], mark);
        Self {
            name,
            text,
            marked,
            first_line,
            cut,
        }
    }

    pub(crate) fn marked(&self) -> SourceSpan {
        self.marked.clone().into()
    }
}

/// Returns a printable text, and the range of the `marked` characters in it. Carriage returns at line ends
/// are removed.
fn shown(text: &str, marked: Range<usize>) -> (String, Range<usize>) {
    let text = text.strip_suffix('\r').unwrap_or(text);
    let given = marked.end.min(text.len());
    let is_between = text[..given].ends_with('\r') && text[given..].starts_with('\n');
    let end = given - usize::from(is_between);
    // The mark may be at the carriage return that is removed.
    let start = marked.start.min(end);
    let parts = [&text[..start], &text[start..end], &text[end..]];
    let [before, mark, after] =
        parts.map(|part| printable_lines(&part.replace("\r\n", "\n")).into_owned());
    let place = before.len()..before.len() + mark.len();
    (before + &mark + &after, place)
}

/// Returns the last byte offset at or before `offset` where a character begins.
pub(crate) fn boundary_before(text: &str, offset: usize) -> usize {
    let offset = offset.min(text.len());
    (0..=offset)
        .rev()
        .find(|&i| text.is_char_boundary(i))
        .unwrap_or(0)
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let inner = self
            .text
            .as_str()
            .read_span(span, lines_before, lines_after)?;
        let cut = if inner.line() == 0 { self.cut } else { 0 };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line() + self.first_line,
            inner.column() + cut,
            inner.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_nearest(name: &str, expected: Option<&str>) {
        let known = ["diffuse", "dielectric", "conductor", "fov", "L"];
        assert_eq!(nearest(name, known), expected);
    }

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        check_nearest("difuse", Some("diffuse"));
        check_nearest("dieletcric", Some("dielectric"));
        check_nearest("FOV", Some("fov"));
        check_nearest("l", Some("L"));
        check_nearest("velvet", None);
        check_nearest("", None);
    }

    #[track_caller]
    fn check_place(text: &str, offset: usize, expected: (usize, usize)) {
        assert_eq!(line_and_column(text, offset), expected);
    }

    #[test]
    fn lines_and_columns_count_from_one_in_characters() {
        check_place("abc", 0, (1, 1));
        check_place("abc", 3, (1, 4));
        check_place("a\nbc", 2, (2, 1));
        check_place("a\nµm x", 6, (2, 4));
        check_place("", 0, (1, 1));
    }

    #[test]
    fn a_long_line_is_cut_around_the_mark() {
        let text = format!("first\n{} here {}\n", "1 ".repeat(1000), "2 ".repeat(1000));
        let start = text.find("here").unwrap();
        let excerpt = Excerpt::new(Path::new("a"), &text, 2, start..start + 4);
        assert!(excerpt.text.len() < 150);
        assert_eq!(&excerpt.text[excerpt.marked.clone()], "here");
        let contents = excerpt.read_span(&excerpt.marked(), 0, 0).unwrap();
        assert_eq!(
            (contents.line(), contents.column()),
            (1, start - "first\n".len())
        );
    }

    #[test]
    fn control_characters_in_an_excerpt_are_escaped() {
        let text = "Film \x1b[2J\r\nShape \"\u{202e}ab\"\r\nnext\r\n";
        let start = text.find("\"\u{202e}").unwrap();
        let excerpt = Excerpt::new(Path::new("a\x07"), text, 2, start..start + 8);
        assert_eq!(excerpt.name, r"a\u{7}");
        let lines: Vec<_> = excerpt.text.split('\n').collect();
        assert_eq!(lines, [r"Film \u{1b}[2J", r#"Shape "\u{202e}ab""#, "next"]);
        assert_eq!(&excerpt.text[excerpt.marked], r#""\u{202e}ab""#);
    }

    #[test]
    fn a_mark_at_a_carriage_return_is_where_the_line_ends() {
        for (text, at) in [
            ("a\r", 1..2),
            ("a\r", 2..2),
            ("a\r\nb", 1..2),
            ("a\r\nb", 2..2),
        ] {
            let excerpt = Excerpt::new(Path::new("a"), text, 1, at);
            assert_eq!(excerpt.marked, 1..1, "{text:?}");
        }
        // A file of carriage returns that ends in the middle of a directive.
        let text = "a ci\r\r\r\n\r\r";
        for i in 0..=text.len() {
            Excerpt::new(Path::new("a"), text, 1, i..text.len());
        }
    }

    #[test]
    fn marks_that_span_lines_end_with_their_first_line() {
        let text = "a [1\n2\n3]\nb";
        let excerpt = Excerpt::new(Path::new("a"), text, 1, 2..9);
        assert_eq!(&excerpt.text[excerpt.marked], "[1");
    }
}
