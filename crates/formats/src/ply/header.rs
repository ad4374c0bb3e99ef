//! Reads the text at the beginning of a PLY file.

use super::{broken, place};
use crate::error::Result;
use crate::scalar::Scalar;

/// The encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyKind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A named column of an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

/// A table of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// The description of the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
}

impl Header {
    /// Reads the header. Returns it with the bytes of the body.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8])> {
        let mut format = None;
        let mut elements = Vec::new();
        let mut rest = bytes;
        loop {
            let begin = bytes.len() - rest.len();
            let is_first = begin == 0;
            let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
                return Err(broken(if is_first { NOT_PLY } else { "no `end_header`" }));
            };
            let line = String::from_utf8_lossy(&rest[..end]);
            rest = &rest[end + 1..];
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let read = match words[..] {
                ["ply"] if is_first => Ok(()),
                _ if is_first => return Err(broken(NOT_PLY)),
                ["end_header"] => {
                    let format = format.ok_or_else(|| broken("no `format`"))?;
                    return Ok((Self { format, elements }, rest));
                }
                ["format", name, "1.0"] => parse_format(name).map(|known| format = Some(known)),
                ref words => header_line(&mut elements, words),
            };
            read.map_err(|error| error.at(place(&bytes[..begin])))?;
        }
    }
}

const NOT_PLY: &str = "not a PLY file: it does not begin with a line `ply`";

fn parse_format(name: &str) -> Result<Format> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::LittleEndian),
        "binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(broken(format!("unknown format `{name}`"))),
    }
}

fn parse_scalar(word: &str) -> Result<Scalar> {
    Ok(match word {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return Err(broken(format!("unknown type `{word}`"))),
    })
}

fn header_line(elements: &mut Vec<Element>, words: &[&str]) -> Result<()> {
    match *words {
        [] | ["comment" | "obj_info", ..] => {}
        ["element", name, count] => {
            let wrong = |_| broken(format!("`{count}` is not a count"));
            elements.push(Element {
                name: name.into(),
                count: count.parse().map_err(wrong)?,
                properties: Vec::new(),
            });
        }
        ["property", "list", count, item, name] => {
            let (count, item) = (parse_scalar(count)?, parse_scalar(item)?);
            push_property(elements, name, PropertyKind::List { count, item })?;
        }
        ["property", kind, name] => {
            push_property(elements, name, PropertyKind::Scalar(parse_scalar(kind)?))?;
        }
        _ => return Err(broken("the header has an unknown line")),
    }
    Ok(())
}

fn push_property(elements: &mut [Element], name: &str, kind: PropertyKind) -> Result<()> {
    let element = elements
        .last_mut()
        .ok_or_else(|| broken("a property before the first element"))?;
    element.properties.push(Property {
        name: name.into(),
        kind,
    });
    Ok(())
}
