//! Curves: functions of wavelength.

/// The value of a curve beyond its first and last wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// The value is 0.
    Zero,
    /// The value is the first or the last sample.
    Last,
}

/// A function of wavelength, linear between samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Pairs of wavelength (nm, increasing) and value.
    pub(super) samples: Vec<[f64; 2]>,
    pub(super) beyond: Beyond,
}

/// The reason why numbers are not a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CurveError {
    /// There are no samples.
    #[error("a spectrum needs at least one pair of wavelength and value")]
    Empty,
    /// A wavelength is not above the one before it.
    #[error("the wavelengths of a spectrum must increase")]
    NotIncreasing,
    /// A list of numbers ends with a wavelength.
    #[error("the last wavelength of the spectrum has no value")]
    NoLastValue,
}

impl Curve {
    /// Makes the curve of samples: wavelength (nm) and value. Errors: there are none, or their wavelengths do not
    /// increase.
    pub fn new(samples: Vec<[f64; 2]>, beyond: Beyond) -> Result<Self, CurveError> {
        if samples.is_empty() {
            return Err(CurveError::Empty);
        }
        if samples.windows(2).any(|pair| pair[0][0] >= pair[1][0]) {
            return Err(CurveError::NotIncreasing);
        }
        Ok(Self { samples, beyond })
    }

    /// Makes the curve of a flat list of wavelengths and values. Errors: those of [`new`](Self::new), and a
    /// wavelength without a value.
    pub fn from_pairs(numbers: &[f64], beyond: Beyond) -> Result<Self, CurveError> {
        let (pairs, rest) = numbers.as_chunks::<2>();
        if !rest.is_empty() {
            return Err(CurveError::NoLastValue);
        }
        Self::new(pairs.to_vec(), beyond)
    }

    /// Returns Planck's law at `kelvin`, relative to its peak.
    pub fn blackbody(kelvin: f64) -> Self {
        // c2 = h c / k. Unit: m K. Wien's displacement constant. Unit: nm K.
        const C2: f64 = 1.438776877e-2;
        const WIEN: f64 = 2.897771955e6;
        let planck = |nm: f64| {
            let metres = nm * 1e-9;
            1.0 / (libm::pow(metres, 5.0) * libm::expm1(C2 / (metres * kelvin)))
        };
        let peak = planck(WIEN / kelvin);
        let samples = (360..=830).map(|nm| [f64::from(nm), planck(f64::from(nm)) / peak]);
        Self {
            samples: samples.collect(),
            beyond: Beyond::Last,
        }
    }

    /// Returns the value at a wavelength. Unit of `nm`: nanometres.
    pub fn at(&self, nm: f64) -> f64 {
        let next = self.samples.partition_point(|&[x, _]| x < nm);
        let value = |i: usize| self.samples.get(i).copied();
        match (next.checked_sub(1).and_then(value), value(next)) {
            (_, Some([x, y])) if x <= nm => y,
            (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (nm - x0) / (x1 - x0),
            (None, Some([_, end])) | (Some([_, end]), None) => match self.beyond {
                Beyond::Zero => 0.0,
                Beyond::Last => end,
            },
            (None, None) => 0.0,
        }
    }

    /// Returns true if no sample is negative.
    pub fn is_positive(&self) -> bool {
        self.samples.iter().all(|&[_, value]| value >= 0.0)
    }

    /// Returns the largest sample.
    pub fn peak(&self) -> f64 {
        self.samples.iter().fold(0.0, |peak, &[_, y]| peak.max(y))
    }

    /// Returns `scale` times the curve.
    #[must_use]
    pub(super) fn scaled(mut self, scale: f64) -> Self {
        for [_, value] in &mut self.samples {
            *value *= scale;
        }
        self
    }
}
