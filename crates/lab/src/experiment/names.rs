//! Names that people misspell, and names that files can have.

/// The name that `name` was probably meant to be. None: where nothing is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A third of the letters may be wrong; two words of three letters are not each other.
    let letters = name.chars().count();
    let allowed = letters.div_ceil(3).min(4);
    // Comparing takes the product of the lengths.
    let known = known
        .into_iter()
        .filter(|known| known.len() <= 100 && letters <= 100);
    let distances = known.map(|known| {
        let distance = strsim::osa_distance(&name.to_ascii_lowercase(), known);
        (distance, known)
    });
    let near = distances.filter(|&(distance, _)| distance <= allowed);
    near.min_by_key(|&(distance, _)| distance)
        .map(|(_, known)| known)
}

/// A name as part of a file's name: lower case, with `-` for everything but letters and digits.
pub(super) fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
    words.join("-").to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_made() {
        assert_eq!(nearest("metod", ["scene", "method"]), Some("method"));
        assert_eq!(nearest("budget", ["scene", "method"]), None);
        assert_eq!(file_name("Room A: 64 spp"), "room-a-64-spp");
    }
}
