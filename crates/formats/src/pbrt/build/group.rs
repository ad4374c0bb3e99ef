//! Light groups: `string lightgroup`, our own parameter of every light.
//!
//! With `Attribute "light" "string lightgroup" "lamps"`, the scene stays valid for other programs:
//! unused parameters of an `Attribute` are not an error.

use super::reader::Reader;
use crate::source::Fault;

/// Maximum length of a name, which becomes part of the names of channels.
const LONGEST: usize = 64;

/// Reads the name of the light's group. None: the light is in the default group of its kind.
pub(super) fn read(reader: &mut Reader<'_, '_>) -> Result<Option<String>, Fault> {
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
