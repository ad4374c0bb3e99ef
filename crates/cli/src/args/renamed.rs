//! Older names of flags and values, which are accepted with a warning until version 1.0.

use std::ffi::OsString;

/// The older name of --light-start.
const FLAG: &str = "--emission";
/// The older name of the value `auto`.
const VALUE: &str = "suited";
/// The flags that accept [`VALUE`].
const RULES: [&str; 3] = ["--candidates", "--path-roulette", "--shadow-rays"];
/// The variable that accepts [`VALUE`].
const VARIABLE: &str = "BIDIR_SHADOW_RAYS";

/// Returns a warning for each older name on a command line and in the environment.
pub(super) fn warnings(
    arguments: &[OsString],
    variable: impl Fn(&str) -> Option<String>,
) -> Vec<String> {
    // Flags may stand in quotes, as in `bidir reference --estimator`.
    let arguments = arguments.iter().filter_map(|argument| argument.to_str());
    let words: Vec<_> = arguments.flat_map(str::split_whitespace).collect();
    let has_flag = words
        .iter()
        .any(|word| word.split('=').next() == Some(FLAG));
    let given = |word: &str, next: Option<&&str>| match word.split_once('=') {
        Some((flag, value)) => RULES.contains(&flag) && value == VALUE,
        None => RULES.contains(&word) && next == Some(&VALUE),
    };
    let mut places = words.iter().enumerate();
    let has_value = places.any(|(at, word)| given(word, words.get(at + 1)))
        || variable(VARIABLE).is_some_and(|value| value == VALUE);
    let flag = has_flag.then(|| format!("{FLAG} is now --light-start"));
    let value = has_value.then(|| format!("the value `{VALUE}` is now `auto`"));
    flag.into_iter().chain(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns whether there is a warning about the flag, and whether there is one about the value.
    fn warned(words: &[&str], rule: Option<&str>) -> [bool; 2] {
        let words: Vec<_> = words.iter().map(OsString::from).collect();
        let all = warnings(&words, |name| {
            assert_eq!(name, VARIABLE);
            rule.map(str::to_owned)
        });
        ["--light-start", "`auto`"].map(|name| all.iter().any(|text| text.contains(name)))
    }

    #[test]
    fn older_names_are_found_wherever_they_stand() {
        assert_eq!(
            warned(&["render", "--light-start", "power"], None),
            [false; 2]
        );
        assert_eq!(
            warned(&["render", "--emission", "power"], None),
            [true, false]
        );
        assert_eq!(warned(&["--emission=power"], None), [true, false]);
        assert_eq!(warned(&["--candidates", "suited"], None), [false, true]);
        assert_eq!(warned(&["--path-roulette=suited"], None), [false, true]);
        let quoted = "lvc --emission power --shadow-rays suited";
        assert_eq!(warned(&["--estimator", quoted], None), [true, true]);
        assert_eq!(warned(&["render"], Some("suited")), [false, true]);
        assert_eq!(warned(&["render", "suited"], Some("all")), [false; 2]);
    }
}
