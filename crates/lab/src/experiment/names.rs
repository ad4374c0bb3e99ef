//! Names of values, and names as parts of file names.

use bidir::names::UnknownName;

/// Returns the value of the name `given`. Errors: the name is not in the list.
pub(super) fn value_of<T: Copy>(names: &[(&str, T)], given: &str) -> Result<T, UnknownName> {
    let found = names.iter().find(|(name, _)| *name == given);
    let known: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
    let value = found.map(|(_, value)| *value);
    value.ok_or_else(|| UnknownName::new(given, &known))
}

/// Turns a name into a part of a file name: lower case, with `-` for everything but letters and digits.
pub(super) fn file_name(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<_> = parts.filter(|word| !word.is_empty()).collect();
    words.join("-").to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_have_hyphens_for_blanks_and_signs() {
        assert_eq!(file_name("Room A: 64 spp"), "room-a-64-spp");
    }
}
