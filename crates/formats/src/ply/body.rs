//! Reads the numbers of a PLY file in sequence.

use super::header::{Element, Format, PropertyKind};
use super::{broken, place};
use crate::error::{Error, Result};
use crate::scalar::Scalar;

/// The unread rest of the body.
pub(super) struct Body<'b> {
    format: Format,
    /// The whole file.
    file: &'b [u8],
    rest: &'b [u8],
    /// The offset of the last word of an ASCII body in the file. Unit: bytes.
    word: usize,
}

impl<'b> Body<'b> {
    /// Returns the body `rest` of a file.
    pub(super) fn new(format: Format, file: &'b [u8], rest: &'b [u8]) -> Self {
        let word = file.len() - rest.len();
        Self {
            format,
            file,
            rest,
            word,
        }
    }

    /// Returns an error at the current place.
    pub(super) fn broken(&self, message: impl Into<String>) -> Error {
        match self.format {
            Format::Ascii => broken(message).at(place(&self.file[..self.word])),
            Format::LittleEndian | Format::BigEndian => broken(message),
        }
    }

    /// Refuses an element with more rows than the body has bytes for, before memory is reserved.
    pub(super) fn check_room(&self, element: &Element) -> Result<()> {
        let smallest = |scalar: Scalar| match self.format {
            Format::Ascii => 2,
            _ => scalar.size(),
        };
        let row: usize = element
            .properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Scalar(scalar) => smallest(scalar),
                PropertyKind::List { count, .. } => smallest(count),
            })
            .sum();
        let (name, count) = (&element.name, element.count);
        if row == 0 && count > 0 {
            return Err(broken(format!("the element `{name}` has no properties")));
        }
        if row > 0 && count > (self.rest.len() + 1) / row {
            let message = format!("the file is too short for {count} of the element `{name}`");
            return Err(broken(message));
        }
        Ok(())
    }

    /// Reads the length of a list.
    pub(super) fn list_length(&mut self, kind: PropertyKind) -> Result<usize> {
        let PropertyKind::List { count, .. } = kind else {
            return Ok(1);
        };
        let length = self.scalar(count)?;
        if length >= 0.0 && length.fract() == 0.0 {
            Ok(length as usize)
        } else {
            Err(self.broken(format!("{length} is not the length of a list")))
        }
    }

    /// Skips a property.
    pub(super) fn skip(&mut self, kind: PropertyKind) -> Result<()> {
        let count = self.list_length(kind)?;
        let (PropertyKind::Scalar(scalar) | PropertyKind::List { item: scalar, .. }) = kind;
        for _ in 0..count {
            self.scalar(scalar)?;
        }
        Ok(())
    }

    /// Reads a number.
    #[inline]
    pub(super) fn scalar(&mut self, scalar: Scalar) -> Result<f64> {
        if self.format == Format::Ascii {
            return self.word();
        }
        let ends = || broken("the file ends too early");
        let (bytes, rest) = self.rest.split_at_checked(scalar.size()).ok_or_else(ends)?;
        self.rest = rest;
        let number = if self.format == Format::BigEndian {
            let mut little = [0; 8];
            for (to, from) in little.iter_mut().zip(bytes.iter().rev()) {
                *to = *from;
            }
            scalar.read(&little)
        } else {
            scalar.read(bytes)
        };
        number.ok_or_else(ends)
    }

    fn word(&mut self) -> Result<f64> {
        let rest = self.rest.trim_ascii_start();
        self.word = self.file.len() - rest.len();
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
        self.rest = after;
        if word.is_empty() {
            return Err(self.broken("the file ends too early"));
        }
        let text = String::from_utf8_lossy(word);
        let number = text.parse();
        number.map_err(|_| self.broken(format!("`{text}` is not a number")))
    }
}
