use std::path::PathBuf;

/// An error of denoising.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DenoiseError {
    /// The system has no Open Image Denoise library.
    #[error("Open Image Denoise was not found (tried {}): {reason}", names.join(", "))]
    NotFound {
        /// The tried names.
        names: Vec<&'static str>,
        /// The system's error for the first name.
        reason: String,
    },
    /// The file is not a library, or is a library other than Open Image Denoise.
    #[error("{}: cannot be used as Open Image Denoise: {reason}", file.display())]
    Unusable {
        /// The file, or the folder that does not contain the library.
        file: PathBuf,
        /// The cause.
        reason: String,
    },
    /// The major version of the library is not 2.
    #[error("{}: Open Image Denoise {version}, where version 2 is needed", file.display())]
    Version {
        /// The file of the library.
        file: PathBuf,
        /// The version of the library.
        version: String,
    },
    /// The number of pixels of an image does not fit the size.
    #[error("the {image} has {pixels} pixels, not {} x {}", size[0], size[1])]
    Size {
        /// The name of the image.
        image: &'static str,
        /// The number of pixels of the image.
        pixels: usize,
        /// Width and height.
        size: [usize; 2],
    },
    /// Normals are given without albedo, which the filter does not support.
    #[error("normals can guide only together with albedo")]
    NormalAlone,
    /// The library fails.
    #[error("Open Image Denoise: {message}")]
    Library {
        /// The library's message.
        message: String,
    },
}

impl DenoiseError {
    /// Returns a remedy. None: the message implies it.
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

    /// Returns true if there is no usable library.
    pub fn is_missing(&self) -> bool {
        matches!(
            self,
            Self::NotFound { .. } | Self::Unusable { .. } | Self::Version { .. }
        )
    }
}
