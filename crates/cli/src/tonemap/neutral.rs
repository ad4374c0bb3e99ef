//! PBR Neutral by the Khronos Group [Khronos24, PBR Neutral Specification].
//!
//! With x the least channel, p the greatest one less f, and out = in - f up to p = K_s:
//!
//!     f   = x - x² / (4 F_90)   up to x = 2 F_90, then F_90
//!     p_n = 1 - (1 - K_s)² / (p + 1 - 2 K_s)
//!     g   = 1 / (K_d (p - p_n) + 1)
//!     out = (in - f) p_n/p g + p_n (1 - g)   beyond
//!
//! f subtracts the light that a shiny surface of index 1.5 reflects of white surroundings, so that base
//! colours from 0.08 to 0.8 appear unchanged on the screen.

/// Reflectance of a surface of index 1.5 at normal incidence.
const F_90: f32 = 0.04;
/// Value above which highlights are compressed.
const K_S: f32 = 0.8 - F_90;
/// Rate at which highlights lose saturation.
const K_D: f32 = 0.15;

/// Applies the operator. Range: finite and not negative; the result is in `[0, 1]`.
pub(super) fn apply(color: [f32; 3]) -> [f32; 3] {
    let [r, g, b] = color;
    let f = offset(r.min(g).min(b));
    let color = color.map(|channel| channel - f);
    let p = r.max(g).max(b) - f;
    if p <= K_S {
        return color;
    }
    let p_n = 1.0 - (1.0 - K_S) * (1.0 - K_S) / (p + 1.0 - 2.0 * K_S);
    let g = 1.0 / (K_D * (p - p_n) + 1.0);
    // The greatest channel becomes p_n; the bound keeps rounding errors below it.
    color.map(|channel| (channel / p * p_n * g + p_n * (1.0 - g)).min(p_n))
}

/// Returns f for the least channel `x`. Range: at most `x`.
fn offset(x: f32) -> f32 {
    if x <= 2.0 * F_90 {
        x - x * x / (4.0 * F_90)
    } else {
        F_90
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(color: [f32; 3], expected: [f32; 3]) {
        let shown = apply(color);
        let is_close = shown
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(is_close, "{color:?}: {shown:?}, not {expected:?}");
    }

    #[test]
    fn base_colours_lose_only_the_reflection() {
        check([0.1, 0.5, 0.8], [0.06, 0.46, 0.76]);
        check([0.08; 3], [0.04; 3]);
        check([0.8, 0.3, 0.09], [0.76, 0.26, 0.05]);
    }

    #[test]
    fn darkness_is_compressed_without_a_step() {
        check([0.04; 3], [0.01; 3]);
        // If the least channel is 0, the others stay.
        check([0.0, 0.3, 0.7], [0.0, 0.3, 0.7]);
        assert!((offset(0.08 - 1e-6) - offset(0.08 + 1e-6)).abs() < 1e-6);
    }

    #[test]
    fn highlights_are_as_in_the_specification() {
        // Computed independently of this program.
        check([1.0; 3], [0.869_090_909; 3]);
        check([2.0, 0.5, 0.1], [0.96, 0.321_135_76, 0.150_771_96]);
    }
}
