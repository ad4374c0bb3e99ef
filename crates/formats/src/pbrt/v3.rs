//! The words by which files for version 3 (or older) of the format are recognised.

use crate::source::{Fault, Span};

/// Returns the error for a mark of version 3; `hint` names the replacement in version 4.
pub(super) fn fault(span: Span, mark: &str, hint: &str) -> Fault {
    let message = format!("this is a pbrt-v3 file: {mark} is not part of version 4");
    Fault::scene(span, message)
        .with_hint(format!("{hint}, or convert the file with `pbrt --upgrade`"))
}

/// Returns the replacement for an old directive.
pub(super) fn directive(word: &str) -> Option<&'static str> {
    match word {
        "WorldEnd" => Some("leave it out: the world ends with the file"),
        "SurfaceIntegrator" => Some("write `Integrator`"),
        "VolumeIntegrator" | "Renderer" => Some("leave it out"),
        "Volume" => Some("write `MakeNamedMedium` and `MediumInterface`"),
        _ => None,
    }
}

/// Returns the replacement for an old type word.
pub(super) fn type_word(word: &str) -> Option<&'static str> {
    match word {
        "color" => Some("write `rgb`"),
        "xyz" => Some("write `rgb` with converted values"),
        "point" => Some("write `point3`"),
        "vector" => Some("write `vector3`"),
        _ => None,
    }
}

/// Returns the replacement for an old parameter; version 4 uses none of these names.
pub(super) fn parameter(name: &str) -> Option<&'static str> {
    match name {
        "xwidth" => Some("write `xradius`"),
        "ywidth" => Some("write `yradius`"),
        "Kd" => Some("write `reflectance`"),
        "index" => Some("write `eta`"),
        "bumpmap" => Some("write `displacement`"),
        "mapname" => Some("write `filename`"),
        "maxsampleluminance" => Some("write `maxcomponentvalue`"),
        "lightsamplestrategy" => Some("write `lightsampler`"),
        "nlevels" => Some("write `levels`"),
        "namedmaterial1" | "namedmaterial2" => {
            Some("write `\"string materials\" [ second first ]`")
        }
        "trilinear" => Some("write `\"string filter\" \"trilinear\"`"),
        "shadowalpha" => Some("write `alpha`"),
        "Ks" | "Kr" | "Kt" | "opacity" | "discarddegenerateUVs" | "rrthreshold" => {
            Some("leave it out")
        }
        "st" => Some("write `point2 uv`"),
        _ => None,
    }
}
