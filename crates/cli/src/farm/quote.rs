//! Words for shells and for YAML.

/// A word that any POSIX shell takes as it is.
pub(super) fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// A string of YAML, in double quotes: those of JSON are such strings.
pub(super) fn yaml(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_words_stay_and_others_are_quoted() {
        assert_eq!(quote("out/room-1.exr"), "out/room-1.exr");
        assert_eq!(quote("all,-s0"), "all,-s0");
        assert_eq!(quote("my room"), "'my room'");
        assert_eq!(quote("it's"), r"'it'\''s'");
        assert_eq!(quote("$(rm)"), "'$(rm)'");
        assert_eq!(quote("~"), "'~'");
        assert_eq!(quote("*"), "'*'");
        assert_eq!(quote(""), "''");
    }

    #[test]
    fn strings_of_yaml_have_their_escapes() {
        assert_eq!(yaml("a: \"b\"\n"), r#""a: \"b\"\n""#);
    }
}
