//! Participating media, and the media on both sides of each shape.

mod cloud;
mod glow;
mod grid;
mod layer;
mod nanovdb;
pub(super) mod subsurface;

use super::color::{self, Purpose};
use super::context::Context;
use super::reader::Reader;
use crate::error::ErrorKind;
use crate::limits;
use crate::pbrt::lexer::shorten;
use crate::pbrt::scene::{MediumDescription, MediumInterface, MediumReference};
use crate::source::Fault;
use bidir::medium::{Coefficients, HenyeyGreenstein, Medium, MediumId, MediumSides};
use bidir::scene::SceneBuilder;
use bidir::spectrum::Rgb;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The media in use, by name.
#[derive(Default)]
pub(super) struct Media {
    built: BTreeMap<Arc<str>, MediumId>,
    clouds: usize,
}

const TOO_DENSE: &str = "the coefficients of the medium are too large";

/// Builds a medium whose parameters were read. Only media in use are built.
pub(super) type Recipe = Box<dyn FnOnce() -> Result<Medium, Fault>>;

impl Media {
    /// Returns the media on both sides of a shape.
    pub(super) fn sides(
        &mut self,
        context: &mut Context<'_>,
        builder: &mut SceneBuilder,
        interface: &MediumInterface,
    ) -> Result<MediumSides, Fault> {
        let mut find = |of: &Option<_>| self.find(context, builder, of.as_ref());
        Ok(MediumSides {
            outside: find(&interface.outside)?,
            inside: find(&interface.inside)?,
        })
    }

    /// Returns the medium of this name, and builds it for its first use. Without a name, returns vacuum.
    pub(super) fn find(
        &mut self,
        context: &mut Context<'_>,
        builder: &mut SceneBuilder,
        reference: Option<&MediumReference>,
    ) -> Result<MediumId, Fault> {
        let Some(MediumReference { name, span }) = reference else {
            return Ok(MediumId::VACUUM);
        };
        if let Some(&known) = self.built.get(name) {
            return Ok(known);
        }
        let media = &context.document.media;
        let Some(medium) = media.iter().find(|medium| medium.name == **name) else {
            let message = format!("the medium `{}` is not defined", shorten(name));
            let names = media.iter().map(|medium| medium.name.as_str());
            return Err(Fault::scene(*span, message).with_nearest(name, names));
        };
        self.clouds += usize::from(medium.entity.kind == "cloud");
        if self.clouds > limits::MOST_CLOUDS {
            let message = format!("there are more than {} clouds", limits::MOST_CLOUDS);
            return Err(Fault::new(ErrorKind::Limit, *span, message));
        }
        let built = builder.medium(read(context, medium)?()?);
        self.built.insert(Arc::clone(name), built);
        Ok(built)
    }

    /// Checks the parameters of unused media.
    pub(super) fn check_unused(&self, context: &mut Context<'_>) -> Result<(), Fault> {
        for medium in &context.document.media {
            if !self.built.contains_key(medium.name.as_str()) {
                context.unused(|context| read(context, medium))?;
            }
        }
        Ok(())
    }
}

/// Reads the parameters of a medium, whose type the parser has checked.
fn read(context: &mut Context<'_>, medium: &MediumDescription) -> Result<Recipe, Fault> {
    let mut reader = Reader::new(context, &medium.entity);
    let built = match medium.entity.kind.as_str() {
        "uniformgrid" => ready(grid::uniform(&mut reader, &medium.transforms)?),
        "rgbgrid" => ready(grid::rgb(&mut reader, &medium.transforms)?),
        "cloud" => cloud::read(&mut reader, &medium.transforms)?,
        "nanovdb" => nanovdb::read(&mut reader, &medium.transforms)?,
        _ => ready(homogeneous(&mut reader)?),
    };
    reader.finish()?;
    Ok(built)
}

fn ready(medium: Medium) -> Recipe {
    Box::new(|| Ok(medium))
}

fn homogeneous(reader: &mut Reader<'_, '_>) -> Result<Medium, Fault> {
    let given = coefficients(reader)?;
    let scale = scale(reader)?;
    let coefficients = scaled(reader, given, scale)?;
    let light = glow::even(reader)?;
    let medium = Medium::homogeneous(coefficients, phase(reader)?);
    glow::add(reader.span(), medium, light)
}

/// Reads the factor on all coefficients.
fn scale(reader: &mut Reader<'_, '_>) -> Result<f32, Fault> {
    reader.float_within("scale", 1.0, [0.0, f32::MAX])
}

fn phase(reader: &mut Reader<'_, '_>) -> Result<HenyeyGreenstein, Fault> {
    let g = reader.float_within("g", 0.0, [-1.0, 1.0])?;
    HenyeyGreenstein::new(g).ok_or_else(|| {
        let message = "the medium scatters in one direction alone: g is 1 or -1";
        reader.fault(message)
    })
}

/// Returns σ_a and σ_s times `scale`, in the render space. Unit: 1 / its unit of length.
fn scaled(reader: &Reader<'_, '_>, given: [Rgb; 2], scale: f32) -> Result<Coefficients, Fault> {
    let scale = scale * reader.context.layout.space.unit as f32;
    let [absorption, scattering] = given.map(|sigma| sigma.map(|channel| channel * scale));
    Coefficients::new(absorption, scattering).ok_or_else(|| reader.fault(TOO_DENSE))
}

/// Reads `sigma_a` and `sigma_s`. None: the file does not have it. Unit: 1 / the scene's unit of length.
fn own_coefficients(reader: &mut Reader<'_, '_>) -> Result<[Option<Rgb>; 2], Fault> {
    Ok([
        color::read(reader, "sigma_a", Purpose::Unbounded)?,
        color::read(reader, "sigma_s", Purpose::Unbounded)?,
    ])
}

/// Reads σ_a and σ_s: the preset's, if there is one, else the file's or 1. Unit: 1 / the scene's unit of length.
fn coefficients(reader: &mut Reader<'_, '_>) -> Result<[Rgb; 2], Fault> {
    let given = own_coefficients(reader)?;
    if let Some(known) = preset(reader, "preset")? {
        return Ok(known);
    }
    Ok(given.map(|given| given.unwrap_or([1.0; 3])))
}

/// Reads the name of a substance, and returns its σ_a and σ_s. None: the file names none.
fn preset(reader: &mut Reader<'_, '_>, parameter: &'static str) -> Result<Option<[Rgb; 2]>, Fault> {
    let named = reader.string(parameter)?;
    let Some((name, span)) = named.filter(|(name, _)| !name.is_empty()) else {
        return Ok(None);
    };
    let known = PRESETS.iter().find(|(known, ..)| *known == name);
    if let Some(&(_, scattering, absorption)) = known {
        return Ok(Some([absorption, scattering]));
    }
    let what = format!("the {parameter} `{}`", shorten(name));
    let substitute = "the other coefficients are used instead";
    reader.context.unsupported(span, &what, substitute)?;
    Ok(None)
}

/// Substances, each with its reduced scattering coefficient and its absorption coefficient, in 1/mm \[Jensen01\].
const PRESETS: [(&str, Rgb, Rgb); 12] = [
    ("Apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]),
    ("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    ("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20]),
    ("Cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("Marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]),
    ("Potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]),
    ("Skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
    ("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("Skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("Spectralon", [11.6, 20.4, 14.9], [0.0; 3]),
    ("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
];
