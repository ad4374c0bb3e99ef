//! The groups of lights: `string lightgroup`, a parameter of our own of every light.
//!
//! As `Attribute "light" "string lightgroup" "lamps"` it stays a scene of the format: parameters of
//! an attribute that nobody asks for are no error.

use super::reader::Reader;
use crate::source::Fault;

/// The longest name: channels of image files are named after it.
const LONGEST: usize = 64;

/// The name of the light's group. None: it is in that of its kind.
pub(super) fn read(reader: &mut Reader<'_>) -> Result<Option<String>, Fault> {
    let Some((name, span)) = reader.string("lightgroup")? else {
        return Ok(None);
    };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_ ".contains(c);
    if !name.is_empty() && name.len() <= LONGEST && name.chars().all(is_plain) {
        return Ok(Some(name.to_owned()));
    }
    let message = "the name of a light group becomes the name of a layer";
    let hint = format!("use at most {LONGEST} letters, digits, `-`, `_` and spaces");
    Err(Fault::scene(span, message).with_hint(hint))
}
