//! Reads the text at the beginning of a PLY file.

use super::Broken;

/// The encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Returns the size of a number in a binary body. Unit: bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn parse(word: &str) -> Result<Self, Broken> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(Broken::new(format!("unknown type `{word}`"))),
        })
    }
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
    /// The number of lines of the header.
    pub(super) lines: usize,
}

impl Header {
    /// Reads the header. Returns it with the bytes of the body.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), Broken> {
        let mut rest = bytes;
        let mut format = None;
        let mut elements = Vec::new();
        for line_number in 1.. {
            let end = rest.iter().position(|&byte| byte == b'\n');
            let Some(end) = end else {
                return Err(Broken::new(if line_number == 1 {
                    NOT_PLY
                } else {
                    "no `end_header`"
                }));
            };
            let (line, after) = (&rest[..end], &rest[end + 1..]);
            rest = after;
            let at_line = |broken| Broken {
                place: Some((line_number, 1)),
                ..broken
            };
            // Comments and names may be in any encoding.
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match (line_number, words.as_slice()) {
                (1, ["ply"]) => {}
                (1, _) => return Err(Broken::new(NOT_PLY)),
                (_, ["end_header"]) => {
                    let format = format.ok_or_else(|| Broken::new("no `format`"))?;
                    return Ok((
                        Self {
                            format,
                            elements,
                            lines: line_number,
                        },
                        rest,
                    ));
                }
                (_, ["format", name, "1.0"]) => format = Some(parse_format(name).map_err(at_line)?),
                (_, words) => header_line(&mut elements, words).map_err(at_line)?,
            }
        }
        Err(Broken::new("no `end_header`"))
    }
}

const NOT_PLY: &str = "not a PLY file: it does not begin with a line `ply`";

fn parse_format(name: &str) -> Result<Format, Broken> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::LittleEndian),
        "binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(Broken::new(format!("unknown format `{name}`"))),
    }
}

fn header_line(elements: &mut Vec<Element>, words: &[&str]) -> Result<(), Broken> {
    match *words {
        [] | ["comment" | "obj_info", ..] => {}
        ["element", name, count] => {
            let count = count
                .parse()
                .map_err(|_| Broken::new(format!("`{count}` is not a count")))?;
            elements.push(Element {
                name: name.into(),
                count,
                properties: Vec::new(),
            });
        }
        ["property", "list", count, item, name] => {
            let (count, item) = (Scalar::parse(count)?, Scalar::parse(item)?);
            push_property(elements, name, PropertyKind::List { count, item })?;
        }
        ["property", kind, name] => {
            push_property(elements, name, PropertyKind::Scalar(Scalar::parse(kind)?))?;
        }
        _ => return Err(Broken::new("the header has an unknown line")),
    }
    Ok(())
}

fn push_property(elements: &mut [Element], name: &str, kind: PropertyKind) -> Result<(), Broken> {
    let element = elements
        .last_mut()
        .ok_or_else(|| Broken::new("a property before the first element"))?;
    element.properties.push(Property {
        name: name.into(),
        kind,
    });
    Ok(())
}
