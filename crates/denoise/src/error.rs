use std::path::PathBuf;

/// Why a picture cannot be denoised.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DenoiseError {
    /// The system has no such library.
    #[error("Open Image Denoise was not found by the names {}; the system says: {reason}", names.join(", "))]
    NotFound {
        /// The names that were tried.
        names: Vec<&'static str>,
        /// What the system says of the first.
        reason: String,
    },
    /// A file is no library, or another one.
    #[error("{}: cannot be used as Open Image Denoise: {reason}", file.display())]
    Unusable {
        /// The file, or the folder where it should be.
        file: PathBuf,
        /// Why not.
        reason: String,
    },
    /// The library has another major version than 2.
    #[error("{}: Open Image Denoise {version}, where version 2 is needed", file.display())]
    Version {
        /// The library.
        file: PathBuf,
        /// Its version.
        version: String,
    },
    /// An image has not the number of pixels that its size tells.
    #[error("the {image} has {pixels} pixels, not {} x {}", size[0], size[1])]
    Size {
        /// Which image.
        image: &'static str,
        /// How many pixels it has.
        pixels: usize,
        /// Width and height of the picture.
        size: [usize; 2],
    },
    /// There are normals and no albedo, for which the filter is not made.
    #[error("normals can guide only together with albedo")]
    NormalAlone,
    /// The library refuses or fails.
    #[error("Open Image Denoise: {message}")]
    Library {
        /// What it says.
        message: String,
    },
}

impl DenoiseError {
    /// What to do about it. None: where the message says all there is to say.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotFound { .. } => Some(
                "`pip install pyoidn` brings the library, as do the archives of \
                 https://www.openimagedenoise.org; set BIDIR_OIDN to its file or folder",
            ),
            Self::Unusable { .. } | Self::Version { .. } => Some(
                "set BIDIR_OIDN to the library of Open Image Denoise 2 or to its folder; \
                 `pip install pyoidn` brings it, as do the archives of \
                 https://www.openimagedenoise.org",
            ),
            Self::Size { .. } | Self::NormalAlone | Self::Library { .. } => None,
        }
    }

    /// True where there is no library that can be used, whatever the picture.
    pub fn is_missing(&self) -> bool {
        matches!(
            self,
            Self::NotFound { .. } | Self::Unusable { .. } | Self::Version { .. }
        )
    }
}
