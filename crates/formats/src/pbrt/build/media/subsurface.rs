//! The media within surfaces of the material `subsurface`.
//!
//! Light walks through them as through any medium. Where the file asks for a reflectance, the albedo of the medium is
//! that of a deep layer that returns this part of the diffuse light which enters.

use super::super::reader::Reader;
use super::layer::Layer;
use super::{color, preset, scaled};
use crate::source::Fault;
use bidir::medium::{HenyeyGreenstein, Medium};
use bidir::spectrum::Rgb;
use color::Purpose;

/// σ_a and σ_s of whole milk, 1/mm: those of the format where the file says nothing.
const ABSORPTION: Rgb = [0.0011, 0.0024, 0.014];
const SCATTERING: Rgb = [2.55, 3.21, 3.77];

/// Reads the medium within a surface of this relative index of refraction.
pub(in super::super) fn read(reader: &mut Reader<'_, '_>, eta: f32) -> Result<Medium, Fault> {
    let scale = super::scale(reader)?;
    let phase = super::phase(reader)?;
    let name = preset(reader, "name")?;
    let mut read = |name| color::read(reader, name, Purpose::Unbounded);
    let [absorption, scattering, mean_free_path] =
        [read("sigma_a")?, read("sigma_s")?, read("mfp")?];
    let reflectance = color::read(reader, "reflectance", Purpose::Albedo)?;
    let (given, phase) = match (name, absorption, scattering, reflectance) {
        (Some(named), ..) => (named, HenyeyGreenstein::ISOTROPIC),
        (None, Some(absorption), Some(scattering), _) => ([absorption, scattering], phase),
        (None, None, None, Some(reflectance)) => {
            let length = mean_free_path.unwrap_or([1.0; 3]);
            (of_reflectance(reflectance, length, eta, phase), phase)
        }
        (None, None, None, None) => ([ABSORPTION, SCATTERING], phase),
        _ => {
            let message = "a subsurface material has `sigma_a` and `sigma_s`, or neither";
            return Err(Fault::scene(reader.span(), message));
        }
    };
    let coefficients = scaled(reader, given, scale)?;
    Ok(Medium::homogeneous(coefficients, phase))
}

/// σ_a and σ_s with which a deep layer returns this part of the diffuse light that enters. Scattering that is not even
/// counts like even scattering with 1 - g of the coefficient.
fn of_reflectance(
    reflectance: Rgb,
    mean_free_path: Rgb,
    eta: f32,
    phase: HenyeyGreenstein,
) -> [Rgb; 2] {
    /// The shortest path, so that coefficients stay finite.
    const SHORTEST: f32 = 1e-6;
    let (layer, g) = (Layer::new(eta), phase.mean_cosine());
    let albedos = reflectance.map(|part| {
        let even = layer.albedo(f64::from(part)) as f32;
        even / (1.0 - g + even * g)
    });
    let extinction = mean_free_path.map(|length| 1.0 / length.max(SHORTEST));
    [
        std::array::from_fn(|i| extinction[i] * (1.0 - albedos[i])),
        std::array::from_fn(|i| extinction[i] * albedos[i]),
    ]
}
