//! Words for shells and for YAML.

/// Returns a word that any POSIX shell takes as it is.
pub(super) fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Returns more words of a shell's command, each after a space.
pub(super) fn arguments(words: &[String]) -> String {
    words
        .iter()
        .map(|word| " ".to_owned() + &quote(word))
        .collect()
}

/// Returns a text as it stands between the double quotes of YAML, which reads the escapes of JSON.
///
/// `$$` is a dollar for Kubernetes, so that `$(…)` in a name stays as it is.
pub(super) fn yaml(text: &str) -> String {
    let string = serde_json::Value::from(text.replace('$', "$$")).to_string();
    string[1..string.len() - 1].to_owned()
}

/// Returns more items of the list that is the command of a container.
pub(super) fn items(words: &[String]) -> String {
    let item = |word: &String| format!("\n            - \"{}\"", yaml(word));
    words.iter().map(item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_words_stay_and_others_are_quoted() {
        for word in ["out/room-1.exr", "all,-s0"] {
            assert_eq!(quote(word), word);
        }
        for word in ["my room", "$(rm)", "~", "*", "a;b", ""] {
            assert_eq!(quote(word), format!("'{word}'"));
        }
        assert_eq!(quote("it's"), r"'it'\''s'");
    }

    #[test]
    fn strings_of_yaml_have_their_escapes() {
        assert_eq!(yaml("$(HOME): \"b\"\n"), r#"$$(HOME): \"b\"\n"#);
    }
}
