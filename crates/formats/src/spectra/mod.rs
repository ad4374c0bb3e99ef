//! Spectra and their colours: functions of wavelength, given by samples, temperature or name.
//!
//! The renderer computes with linear Rec. 709, so spectra are converted to three numbers here: the colour
//! of a reflectance under daylight ([`reflectance`]), the hue of a light ([`emission`]), the index of a
//! metal with the reflectance of its spectrum ([`conductor`]).

mod color;
mod named;
mod table;

pub(crate) use color::{
    LUMINANCE_OF_ONE, Primaries, adapted, black_body, conductor, daylight_white, emission,
    planckian_white, reflectance, rgb_from_rgb,
};
pub(crate) use named::{metal, named, names};

/// The value of a sampled spectrum beyond its first and last wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beyond {
    /// The value is 0.
    Zero,
    /// The value is the first or the last sample.
    Last,
}

/// A function of wavelength, linear between samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// Pairs of wavelength (nm, increasing) and value.
    samples: Vec<[f64; 2]>,
    beyond: Beyond,
}

/// The reason why numbers are not a spectrum.
type Reason = String;

impl Spectrum {
    /// Returns the spectrum of samples: wavelength (nm) and value.
    pub(crate) fn new(samples: Vec<[f64; 2]>, beyond: Beyond) -> Result<Self, Reason> {
        if samples.is_empty() {
            return Err("a spectrum needs at least one pair of wavelength and value".into());
        }
        if samples.windows(2).any(|pair| pair[0][0] >= pair[1][0]) {
            return Err("the wavelengths of a spectrum must increase".into());
        }
        Ok(Self { samples, beyond })
    }

    /// Returns the spectrum of a flat list of wavelengths and values.
    pub(crate) fn from_pairs(numbers: &[f64], beyond: Beyond) -> Result<Self, Reason> {
        let (pairs, rest) = numbers.as_chunks::<2>();
        if !rest.is_empty() {
            return Err("the last wavelength of the spectrum has no value".into());
        }
        Self::new(pairs.to_vec(), beyond)
    }

    /// Reads a text of pairs; `#` begins a comment.
    pub(crate) fn parse(text: &str) -> Result<Self, Reason> {
        let mut numbers = Vec::new();
        for (line, content) in text.lines().enumerate() {
            let content = content.split('#').next().unwrap_or_default();
            for word in content.split(|c: char| c.is_whitespace() || c == ',') {
                if word.is_empty() {
                    continue;
                }
                let number = word.parse().ok().filter(|number: &f64| number.is_finite());
                let line = line + 1;
                let wrong =
                    || format!("line {line} of the spectrum has something that is not a number");
                numbers.push(number.ok_or_else(wrong)?);
            }
        }
        Self::from_pairs(&numbers, Beyond::Zero)
    }

    /// Returns Planck's law at `kelvin`, relative to its peak.
    pub(crate) fn blackbody(kelvin: f64) -> Self {
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
    pub(crate) fn at(&self, nm: f64) -> f64 {
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

    /// Returns the index of refraction at the d line of helium, by which glasses are specified.
    pub(crate) fn index(&self) -> f32 {
        const D_LINE: f64 = 587.56;
        self.at(D_LINE) as f32
    }

    /// Returns true if no sample is negative.
    pub(crate) fn is_positive(&self) -> bool {
        self.samples.iter().all(|&[_, value]| value >= 0.0)
    }

    /// Returns the largest sample.
    pub(crate) fn peak(&self) -> f64 {
        self.samples.iter().fold(0.0, |peak, &[_, y]| peak.max(y))
    }
}

#[cfg(test)]
mod tests;
