//! The spectra that pbrt-v4 knows by name.

use super::table::{self, DAYLIGHT, FLUORESCENT, METALS};
use super::{Beyond, Curve};

/// Returns the wavelengths at which formulas of glasses and illuminants are tabulated. Unit: nm.
fn visible(step: usize) -> impl Iterator<Item = f64> {
    (360..=830).step_by(step).map(f64::from)
}

/// Returns the spectrum of this name. None: there is none.
pub fn named(name: &str) -> Option<Curve> {
    if let Some(metal) = name.strip_prefix("metal-") {
        return METALS.column(metal);
    }
    if let Some(glass) = name.strip_prefix("glass-") {
        return table::glass(glass).map(|coefficients| sellmeier(&coefficients));
    }
    match name {
        "stdillum-A" => Some(incandescent()),
        "stdillum-D50" => Some(daylight([0.34567, 0.35850])),
        "stdillum-D65" => Some(daylight([0.31272, 0.32903])),
        "illum-acesD60" => Some(daylight([0.32168, 0.33767])),
        _ => FLUORESCENT.column(name.strip_prefix("stdillum-")?),
    }
}

/// Returns all names.
pub fn names() -> impl Iterator<Item = String> {
    let metals = METALS.names().map(|metal| format!("metal-{metal}"));
    let glasses = table::glasses().map(|(glass, _)| format!("glass-{glass}"));
    let lamps = FLUORESCENT.names().map(|lamp| format!("stdillum-{lamp}"));
    let formulas = [
        "stdillum-A",
        "stdillum-D50",
        "stdillum-D65",
        "illum-acesD60",
    ];
    let formulas = formulas.map(str::to_owned);
    metals.chain(glasses).chain(lamps).chain(formulas)
}

/// Returns Sellmeier's index n² = 1 + Σ B λ² / (λ² - C), λ in micrometres.
fn sellmeier(coefficients: &[f64; 6]) -> Curve {
    let index = |nm: f64| {
        let square = nm * nm * 1e-6;
        let terms = coefficients.as_chunks::<2>().0.iter();
        let sum: f64 = terms.map(|[b, c]| b * square / (square - c)).sum();
        libm::sqrt(1.0 + sum)
    };
    tabulated(visible(5), index)
}

/// Returns CIE standard illuminant A: Planck's law at 2848 K with c2 = 1.435e7 nm K.
fn incandescent() -> Curve {
    let exponent = |nm: f64| libm::expm1(1.435e7 / (2848.0 * nm));
    tabulated(visible(5), |nm| {
        libm::pow(560.0 / nm, 5.0) * exponent(560.0) / exponent(nm)
    })
}

/// Returns the daylight of this chromaticity: S0 + M1 S1 + M2 S2 (CIE 15).
pub(super) fn daylight([x, y]: [f64; 2]) -> Curve {
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    let [s0, s1, s2] = ["S0", "S1", "S2"].map(|name| DAYLIGHT.column(name));
    let at = |s: &Option<Curve>, nm| s.as_ref().map_or(0.0, |s| s.at(nm));
    tabulated(visible(10), |nm| {
        at(&s0, nm) + m1 * at(&s1, nm) + m2 * at(&s2, nm)
    })
}

fn tabulated(wavelengths: impl Iterator<Item = f64>, value: impl Fn(f64) -> f64) -> Curve {
    Curve {
        samples: wavelengths.map(|nm| [nm, value(nm)]).collect(),
        beyond: Beyond::Last,
    }
}
