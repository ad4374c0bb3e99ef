//! The identity of a scene: a hash of everything that was read.

use sha2::{Digest, Sha256};
use std::fmt;

/// The first bytes that are hashed. The number changes with the layout of the hashed bytes.
const VERSION: &[u8] = b"bidir scene digest 1\n";

/// The identity of a scene: SHA-256 of all texts, then all meshes, images and spectra, in the
/// order read.
///
/// Of each file, its kind, its length and its unpacked bytes are hashed, but not its name and time. So a
/// copied or packed scene has the same identity, and a scene with one other byte has another. Files that are
/// not read, such as the images of unused textures, have no part in it, nor have
/// [`LoadOptions`](super::LoadOptions).
///
/// Its text is lower-case hexadecimal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SceneDigest([u8; 32]);

impl fmt::Display for SceneDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The kind of a file's contents. The numbers are hashed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    Text = 0,
    Mesh = 1,
    Image = 2,
    Spectrum = 3,
    Grid = 4,
}

/// A digest under construction.
#[derive(Clone)]
pub(crate) struct DigestBuilder(Sha256);

impl DigestBuilder {
    pub(crate) fn new() -> Self {
        Self(Sha256::new_with_prefix(VERSION))
    }

    pub(crate) fn add(&mut self, content: Content, bytes: &[u8]) {
        self.0.update([content as u8]);
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    pub(crate) fn finish(self) -> SceneDigest {
        SceneDigest(self.0.finalize().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(parts: &[(Content, &str)]) -> SceneDigest {
        let mut builder = DigestBuilder::new();
        for (content, text) in parts {
            builder.add(*content, text.as_bytes());
        }
        builder.finish()
    }

    #[test]
    fn no_two_of_these_are_the_same() {
        use Content::{Image, Mesh, Text};
        let digests = [
            digest(&[]),
            digest(&[(Text, "")]),
            digest(&[(Text, ""), (Text, "")]),
            digest(&[(Text, "abc")]),
            digest(&[(Mesh, "abc")]),
            digest(&[(Image, "abc")]),
            digest(&[(Text, "ab"), (Text, "c")]),
            digest(&[(Text, "a"), (Text, "bc")]),
            digest(&[(Text, "bc"), (Text, "a")]),
            digest(&[(Text, "a"), (Mesh, "bc")]),
            // The bytes between two texts may stand in one.
            digest(&[(Text, "a\0bc")]),
            digest(&[(Text, "a\0\x02\0\0\0\0\0\0\0bc")]),
        ];
        for (i, a) in digests.iter().enumerate() {
            assert!(!digests[..i].contains(a), "{i}");
        }
    }

    #[test]
    fn the_layout_stays_as_it_is() {
        // Of another implementation, on the bytes that the documentation describes.
        assert_eq!(
            digest(&[(Content::Text, "WorldBegin"), (Content::Mesh, "ply")]).to_string(),
            "5db43942de8b5f0193b1815f519197c468eb26b8b6aeab371c5ae7663097d21f"
        );
    }
}
