//! Words for shells and for YAML.

/// Quotes a word for POSIX shells.
pub(super) fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Returns quoted arguments of a shell command, each after a space.
pub(super) fn arguments(words: &[String]) -> String {
    words
        .iter()
        .map(|word| " ".to_owned() + &quote(word))
        .collect()
}

/// Escapes a text for the double quotes of YAML, which reads the escapes of JSON.
///
/// `$$` is a dollar for Kubernetes, which would otherwise expand `$(…)` in a name.
pub(super) fn yaml(text: &str) -> String {
    let string = serde_json::Value::from(text.replace('$', "$$")).to_string();
    string[1..string.len() - 1].to_owned()
}

/// Returns items for the list of a container's command.
pub(super) fn items(words: &[String]) -> String {
    let item = |word: &String| format!("\n            - \"{}\"", yaml(word));
    words.iter().map(item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_words_with_special_characters_are_quoted() {
        for word in ["out/room-1.exr", "all,-s0"] {
            assert_eq!(quote(word), word);
        }
        for word in ["my room", "$(rm)", "~", "*", "a;b", ""] {
            assert_eq!(quote(word), format!("'{word}'"));
        }
        assert_eq!(quote("it's"), r"'it'\''s'");
    }

    #[test]
    fn dollars_and_quotes_are_escaped_in_yaml() {
        assert_eq!(yaml("$(HOME): \"b\"\n"), r#"$$(HOME): \"b\"\n"#);
    }
}
