//! Stored numbers to linear light and back.

/// How stored numbers relate to linear ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// The curve of sRGB.
    #[default]
    Srgb,
    /// Linear as stored.
    Linear,
    /// Linear = stored to this power.
    Gamma(f32),
}

impl Encoding {
    /// The linear value of a stored one in `[0, 1]`.
    pub fn decode(self, stored: f64) -> f64 {
        match self {
            Self::Srgb if stored <= 0.04045 => stored / 12.92,
            Self::Srgb => libm::pow((stored + 0.055) / 1.055, 2.4),
            Self::Linear => stored,
            Self::Gamma(gamma) => libm::pow(stored, f64::from(gamma)),
        }
    }

    /// The linear values of all stored values from 0 to `max`.
    pub(super) fn table(self, max: u16) -> Vec<f32> {
        (0..=max)
            .map(|stored| self.decode(f64::from(stored) / f64::from(max)) as f32)
            .collect()
    }
}

/// The eight bits that stand for a linear value in sRGB; what is outside `[0, 1]` is clamped.
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
