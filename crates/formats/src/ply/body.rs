//! Reads the numbers of a PLY file in sequence.

use super::Broken;
use super::header::{Element, Format, PropertyKind, Scalar};

/// The unread rest of the body.
pub(super) struct Body<'b> {
    format: Format,
    rest: &'b [u8],
    /// The line of the last word in an ASCII body, counted from 1.
    line: usize,
    /// The column of that word, counted from 1.
    column: usize,
    /// The column at which `rest` begins.
    next_column: usize,
}

impl<'b> Body<'b> {
    /// Returns the body after a header of `lines` lines.
    pub(super) fn new(format: Format, rest: &'b [u8], lines: usize) -> Self {
        Self {
            format,
            rest,
            line: lines + 1,
            column: 1,
            next_column: 1,
        }
    }

    /// Returns an error at the current place.
    pub(super) fn broken(&self, message: impl Into<String>) -> Broken {
        let is_text = self.format == Format::Ascii;
        Broken {
            place: is_text.then_some((self.line, self.column)),
            ..Broken::new(message)
        }
    }

    /// Refuses an element with more rows than the body has bytes for, before memory is reserved.
    pub(super) fn check_room(&self, element: &Element) -> Result<(), Broken> {
        let smallest = |scalar: Scalar| match self.format {
            // A digit and a separator.
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
            return Err(Broken::new(format!(
                "the element `{name}` has no properties"
            )));
        }
        // The last word needs no separator.
        if row > 0 && count > (self.rest.len() + 1) / row {
            let message = format!("the file is too short for {count} of the element `{name}`");
            return Err(Broken::new(message));
        }
        Ok(())
    }

    /// Reads the length of a list.
    pub(super) fn list_length(&mut self, kind: PropertyKind) -> Result<usize, Broken> {
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
    pub(super) fn skip(&mut self, kind: PropertyKind) -> Result<(), Broken> {
        match kind {
            PropertyKind::Scalar(scalar) => self.skip_scalars(scalar, 1),
            PropertyKind::List { item, .. } => {
                let length = self.list_length(kind)?;
                self.skip_scalars(item, length)
            }
        }
    }

    /// Skips `count` numbers.
    pub(super) fn skip_scalars(&mut self, scalar: Scalar, count: usize) -> Result<(), Broken> {
        for _ in 0..count {
            self.scalar(scalar)?;
        }
        Ok(())
    }

    /// Reads a number.
    #[inline]
    pub(super) fn scalar(&mut self, scalar: Scalar) -> Result<f64, Broken> {
        if self.format == Format::Ascii {
            return self.word();
        }
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// Takes the next `N` bytes of a binary body, and returns them in little-endian order.
    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        let Some((bytes, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(Broken::new("the file ends too early"));
        };
        self.rest = rest;
        let mut bytes = *bytes;
        if self.format == Format::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn word(&mut self) -> Result<f64, Broken> {
        let mut rest = self.rest;
        while let [space, after @ ..] = rest
            && space.is_ascii_whitespace()
        {
            self.next_column += 1;
            if *space == b'\n' {
                self.line += 1;
                self.next_column = 1;
            }
            rest = after;
        }
        self.column = self.next_column;
        let end = rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        self.next_column += end;
        self.rest = after;
        if word.is_empty() {
            return Err(self.broken("the file ends too early"));
        }
        let number = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok());
        number.ok_or_else(|| {
            self.broken(format!(
                "`{}` is not a number",
                String::from_utf8_lossy(word)
            ))
        })
    }
}
