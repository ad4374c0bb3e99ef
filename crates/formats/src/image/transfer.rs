//! Conversions between stored numbers and linear light.

/// The encoding of linear numbers in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// The transfer curve of sRGB.
    #[default]
    Srgb,
    /// Stored numbers are linear.
    Linear,
    /// Linear values are stored values to this power.
    Gamma(f32),
}

impl Encoding {
    /// Returns the linear value of a stored one in `[0, 1]`.
    pub fn decode(self, stored: f64) -> f64 {
        match self {
            Self::Srgb if stored <= 0.04045 => stored / 12.92,
            Self::Srgb => libm::pow((stored + 0.055) / 1.055, 2.4),
            Self::Linear => stored,
            Self::Gamma(gamma) => libm::pow(stored, f64::from(gamma)),
        }
    }

    /// Returns the linear values of the stored integers from 0 to `max`, which stands for 1.
    pub(super) fn table(self, max: u16) -> Vec<f32> {
        (0..=max)
            .map(|stored| self.decode(f64::from(stored) / f64::from(max)) as f32)
            .collect()
    }
}

/// Returns the eight bits of a linear value in sRGB; values outside `[0, 1]` are clamped.
pub(super) fn srgb_byte(linear: f32) -> u8 {
    let linear = if linear.is_nan() {
        0.0
    } else {
        f64::from(linear.clamp(0.0, 1.0))
    };
    let encoded = if linear <= 0.0031308 {
        linear * 12.92
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}
