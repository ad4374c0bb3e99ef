//! The media within surfaces of the material `subsurface`.
//!
//! Paths scatter in them as in any medium. If the file gives a reflectance, the albedo of the medium is chosen so
//! that a deep layer returns this part of the diffuse light that enters.

use super::super::reader::Reader;
use super::layer::Layer;
use super::{Recipe, TOO_DENSE, color, preset};
use crate::pbrt::parameters::ParameterType;
use crate::source::Fault;
use bidir::medium::{Coefficients, HenyeyGreenstein, Medium};
use bidir::spectrum::Rgb;
use color::Purpose;

/// σ_a of whole milk, the format's default, with [`SCATTERING`], its σ_s. Unit: 1/mm.
const ABSORPTION: Rgb = [0.0011, 0.0024, 0.014];
const SCATTERING: Rgb = [2.55, 3.21, 3.77];

/// The coefficients as a file gives them, per unit of length.
#[derive(Clone, Copy)]
enum Given {
    /// σ_a and σ_s.
    Coefficients([Rgb; 2]),
    /// The part of diffuse light that comes back, and the mean free path 1/σ_t.
    Reflectance(Rgb, Rgb),
}

/// Reads the medium inside a surface of the relative index of refraction `eta`.
pub(in super::super) fn read(reader: &mut Reader<'_, '_>, eta: f32) -> Result<Recipe, Fault> {
    for name in ["sigma_a", "sigma_s", "reflectance", "mfp"] {
        let constant = "its default is used instead";
        reader.unsupported(ParameterType::Texture, name, constant)?;
    }
    let scale = super::scale(reader)?;
    let mut phase = super::phase(reader)?;
    let name = preset(reader, "name")?;
    let mut read = |name| color::read(reader, name, Purpose::Unbounded);
    let [absorption, scattering, mean_free_path] =
        [read("sigma_a")?, read("sigma_s")?, read("mfp")?];
    let reflectance = color::read(reader, "reflectance", Purpose::Albedo)?;
    let given = match (name, absorption, scattering, reflectance) {
        (Some(named), ..) => {
            phase = HenyeyGreenstein::ISOTROPIC;
            Given::Coefficients(named)
        }
        (None, Some(absorption), Some(scattering), None) => {
            Given::Coefficients([absorption, scattering])
        }
        (None, None, None, Some(reflectance)) => {
            Given::Reflectance(reflectance, mean_free_path.unwrap_or([1.0; 3]))
        }
        (None, None, None, None) => Given::Coefficients([ABSORPTION, SCATTERING]),
        _ => {
            return Err(
                reader.fault("a subsurface material has `sigma_a` and `sigma_s`, or `reflectance`")
            );
        }
    };
    // Paths are divided by what coefficients are multiplied with.
    let (unit, span) = (reader.context.layout.space.unit as f32, reader.span());
    let factor = match given {
        Given::Coefficients(_) => unit * scale,
        Given::Reflectance(..) => unit / scale,
    };
    Ok(Box::new(move || {
        let sigmas = match given {
            Given::Coefficients(sigmas) => sigmas,
            Given::Reflectance(part, length) => of_reflectance(part, length, eta, phase),
        };
        let [absorption, scattering] = sigmas.map(|sigma| sigma.map(|channel| channel * factor));
        let coefficients = Coefficients::new(absorption, scattering);
        let medium = coefficients.map(|known| Medium::homogeneous(known, phase));
        medium.ok_or_else(|| Fault::scene(span, TOO_DENSE))
    }))
}

/// Returns the σ_a and σ_s for which a deep layer returns the part `reflectance` of the diffuse light that enters.
/// By similarity, anisotropic scattering counts as isotropic scattering with (1 - g) σ_s.
fn of_reflectance(
    reflectance: Rgb,
    mean_free_path: Rgb,
    eta: f32,
    phase: HenyeyGreenstein,
) -> [Rgb; 2] {
    let (layer, g) = (Layer::new(eta), f64::from(phase.mean_cosine()));
    // 1 - α of even scattering, and of the phase function.
    let absorbed = reflectance.map(|part| {
        let even = layer.absorption(f64::from(part));
        (1.0 - g) * even / (1.0 - g * even)
    });
    let times = |part: f64, length: f32| (part / f64::from(length)) as f32;
    [
        std::array::from_fn(|i| times(absorbed[i], mean_free_path[i])),
        std::array::from_fn(|i| times(1.0 - absorbed[i], mean_free_path[i])),
    ]
}
