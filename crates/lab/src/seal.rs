//! Checksums of JSON objects: the last member, `checksum`, is the SHA-256 of the text before it.

use sha2::{Digest, Sha256};

/// The result of checking an object's checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seal {
    /// The checksum fits the text.
    Whole,
    /// The checksum does not fit the text.
    Broken,
    /// There is no checksum.
    Missing,
}

/// Computes the SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    let digits = Sha256::digest(bytes);
    let digit = |nibble: u8| char::from_digit(nibble.into(), 16);
    let pairs = digits.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    pairs.filter_map(digit).collect()
}

/// The name of the member, in quotes.
const KEY: &str = "\"checksum\"";

/// Adds the checksum to an object with at least one member.
pub(crate) fn sealed(object: &str) -> String {
    let object = object.trim_end();
    let body = object.strip_suffix('}').unwrap_or(object).trim_end();
    let sum = sha256(body.as_bytes());
    if body.contains('\n') {
        format!("{body},\n  {KEY}: \"{sum}\"\n}}")
    } else {
        format!("{body},{KEY}:\"{sum}\"}}")
    }
}

/// Checks the checksum of an object.
pub(crate) fn check(object: &str) -> Seal {
    // Within a string, its quotes would be escaped.
    let Some((before, after)) = object.rsplit_once(KEY) else {
        return Seal::Missing;
    };
    let is_whole = before.trim_end().strip_suffix(',').is_some_and(|body| {
        let member = after.trim().strip_prefix(':').map(str::trim_start);
        let sum = member.and_then(|sum| sum.strip_suffix('}'));
        sum.is_some_and(|sum| sum.trim_end() == format!("\"{}\"", sha256(body.as_bytes())))
    });
    if is_whole { Seal::Whole } else { Seal::Broken }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_breaks_the_seal_or_the_json() {
        for object in [
            r#"{"a":1,"b":"\"checksum\""}"#,
            "{\n  \"a\": [\n    1\n  ]\n}\n",
        ] {
            assert_eq!(check(object), Seal::Missing);
            let text = sealed(object);
            assert_eq!(check(&text), Seal::Whole);
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert_eq!(value["checksum"].as_str().map(str::len), Some(64));
            for bit in 0..8 * text.len() {
                let mut bytes = text.clone().into_bytes();
                bytes[bit / 8] ^= 1 << (bit % 8);
                let Ok(flipped) = String::from_utf8(bytes) else {
                    continue;
                };
                let is_json = serde_json::from_str::<serde_json::Value>(&flipped).is_ok();
                assert!(check(&flipped) != Seal::Whole || !is_json, "{flipped}");
            }
        }
    }
}
