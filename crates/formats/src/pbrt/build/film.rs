//! The film and its filter.

use super::LoadOptions;
use super::context::Context;
use super::reader::Reader;
use crate::error::ErrorKind;
use crate::pbrt::parameters::{ParameterType, Values};
use crate::pbrt::scene::{ColorSpace, Entity};
use crate::source::{Fault, Span};
use bidir::film::{FilmSettings, Filter, FilterKind, PixelRect};
use bidir::math::Vec2;

/// The most pixels along one side.
const LARGEST_SIDE: u32 = 1 << 16;

/// The widest filter, as a half width. Unit: pixels.
const WIDEST_FILTER: f32 = 32.0;

/// The part of a film that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crop {
    /// Left, right, top and bottom as fractions of the film.
    Fractions([f32; 4]),
    /// Left, right (exclusive), top and bottom (exclusive). Unit: pixels.
    Pixels([u32; 4]),
}

impl Crop {
    fn pixels(self, [width, height]: [u32; 2]) -> PixelRect {
        let [left, right, top, bottom] = match self {
            Self::Pixels(bounds) => bounds,
            Self::Fractions([x0, x1, y0, y1]) => {
                let [x0, x1] = [x0, x1].map(|x| (x * width as f32).ceil() as u32);
                let [y0, y1] = [y0, y1].map(|y| (y * height as f32).ceil() as u32);
                [x0, x1, y0, y1]
            }
        };
        PixelRect {
            min: [left, top],
            max: [right.min(width), bottom.min(height)],
        }
    }
}

/// A film with what its description says beside.
pub(super) struct BuiltFilm {
    /// The film.
    pub(super) settings: FilmSettings,
    /// Width and height as the file has them: the view of the camera goes by them, so that another
    /// size shows the same picture.
    pub(super) own_resolution: [u32; 2],
    /// The name of the image.
    pub(super) output: Option<String>,
}

/// Builds the film. `exposure_time` is that of the camera.
pub(super) fn build(
    context: &mut Context<'_>,
    options: &LoadOptions,
    exposure_time: f32,
) -> Result<BuiltFilm, Fault> {
    let filter = filter(context)?;
    let Some(film) = &context.description.film else {
        let own_resolution = [1280, 720];
        let mut settings = FilmSettings::new(options.resolution.unwrap_or(own_resolution), filter);
        settings.exposure = exposure_time;
        if let Some(crop) = options.crop {
            settings.crop = crop.pixels(settings.resolution);
        }
        return Ok(BuiltFilm {
            settings,
            own_resolution,
            output: None,
        });
    };
    let span = film.entity.span;
    let mut reader = Reader::new(&film.entity);
    if film.color_space != ColorSpace::Srgb {
        context.warn(
            span,
            "the image has the primaries of sRGB, not those of its `ColorSpace`",
        );
    }
    film_kind(context, &mut reader, &film.entity)?;
    let own = [
        reader.integer("xresolution", 1280, 1)?,
        reader.integer("yresolution", 720, 1)?,
    ];
    let resolution = options.resolution.unwrap_or(own);
    if resolution
        .iter()
        .any(|side| !(1..=LARGEST_SIDE).contains(side))
    {
        let [width, height] = resolution;
        let message = format!("a film of {width} × {height} pixels is empty or too large");
        return Err(Fault::new(ErrorKind::Limit, span, message));
    }
    let crop = read_crop(&mut reader, own, resolution)?;
    let mut settings = FilmSettings::new(resolution, filter);
    if let Some(crop) = options.crop.or(crop) {
        settings.crop = crop.pixels(resolution);
    }
    if settings.crop.area() == 0 {
        return Err(Fault::scene(span, "the crop leaves no pixels of the film"));
    }
    settings.exposure = exposure_time * reader.float_within("iso", 100.0, [0.0, f32::MAX])? / 100.0;
    let output = reader.string("filename")?.map(|(name, _)| name.to_owned());
    film_details(context, &mut reader)?;
    reader.finish()?;
    warn_of_stretching(context, span, own, resolution);
    Ok(BuiltFilm {
        settings,
        own_resolution: own,
        output,
    })
}

/// Says so where another size than the file's has another shape: its pixels are not square.
fn warn_of_stretching(context: &mut Context<'_>, span: Span, own: [u32; 2], resolution: [u32; 2]) {
    let aspect = |[width, height]: [u32; 2]| f64::from(width) / f64::from(height);
    let stretch = aspect(own) / aspect(resolution);
    if !(0.98..1.02).contains(&stretch) {
        let [width, height] = own;
        let message = format!(
            "the view of this film of {width} × {height} pixels is kept, so the pixels of the size \
             asked for are {stretch:.3} times as wide as high"
        );
        context.warn(span, message);
    }
}

fn film_kind(
    context: &mut Context<'_>,
    reader: &mut Reader<'_>,
    film: &Entity,
) -> Result<(), Fault> {
    if film.kind == "rgb" {
        return Ok(());
    }
    context.unsupported(
        film.span,
        &format!("the film `{}`", film.kind),
        "`rgb` stands in",
    )?;
    reader.ignore(context, ParameterType::String, "coordinatesystem");
    reader.ignore(context, ParameterType::Integer, "nbuckets");
    reader.ignore(context, ParameterType::Float, "lambdamin");
    reader.ignore(context, ParameterType::Float, "lambdamax");
    Ok(())
}

/// The parameters of all films that concern neither their size nor their brightness.
fn film_details(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<(), Fault> {
    reader.ignore(context, ParameterType::Bool, "savefp16");
    reader.ignore(context, ParameterType::Float, "diagonal");
    let clamp = (ParameterType::Float, "maxcomponentvalue");
    reader.unsupported(context, clamp, "nothing is clamped")?;
    let balance = (ParameterType::Float, "whitebalance");
    reader.unsupported(context, balance, "the colours stay as they are")?;
    match reader.string("sensor")? {
        None | Some(("cie1931", _)) => Ok(()),
        Some((name, span)) => {
            context.unsupported(span, &format!("the sensor `{name}`"), "`cie1931` stands in")
        }
    }
}

/// `cropwindow`, else `pixelbounds`, which count pixels of the film's `own` resolution.
fn read_crop(
    reader: &mut Reader<'_>,
    own: [u32; 2],
    resolution: [u32; 2],
) -> Result<Option<Crop>, Fault> {
    let bounds = reader.find(ParameterType::Integer, "pixelbounds");
    let window = reader.find(ParameterType::Float, "cropwindow");
    let Some(parameter) = window.or(bounds) else {
        return Ok(None);
    };
    let wrong = || {
        let message = format!(
            "`{}` is left, right, top and bottom of a part of the film",
            parameter.name
        );
        Fault::scene(parameter.value_span, message)
    };
    if let Values::Floats(values) = &parameter.values {
        let window: [f32; 4] = values.as_slice().try_into().map_err(|_| wrong())?;
        let inside = window.iter().all(|edge| (0.0..=1.0).contains(edge));
        return if inside {
            Ok(Some(Crop::Fractions(window)))
        } else {
            Err(wrong())
        };
    }
    let Values::Integers(values) = &parameter.values else {
        return Err(wrong());
    };
    let values: Vec<u32> = values
        .iter()
        .filter_map(|&edge| u32::try_from(edge).ok())
        .collect();
    let [x0, x1, y0, y1] = values.try_into().map_err(|_| wrong())?;
    if own == resolution {
        return Ok(Some(Crop::Pixels([x0, x1, y0, y1])));
    }
    let [width, height] = own.map(|side| side as f32);
    let fractions = [
        x0 as f32 / width,
        x1 as f32 / width,
        y0 as f32 / height,
        y1 as f32 / height,
    ];
    Ok(Some(Crop::Fractions(fractions)))
}

fn filter(context: &mut Context<'_>) -> Result<Filter, Fault> {
    let gaussian = FilterKind::Gaussian { sigma: 0.5 };
    let Some(entity) = &context.description.filter else {
        return Ok(Filter::new(gaussian, Vec2::splat(1.5)));
    };
    let mut reader = Reader::new(entity);
    // Beyond these a filter is a point, or flat, and its integral not to be computed.
    let positive = [0.05, 100.0];
    let (kind, radius) = match entity.kind.as_str() {
        "box" => (FilterKind::Box, 0.5),
        "triangle" => (FilterKind::Triangle, 2.0),
        "mitchell" => {
            let third = 1.0 / 3.0;
            let (b, c) = (reader.float("B", third)?, reader.float("C", third)?);
            (FilterKind::Mitchell { b, c }, 2.0)
        }
        "sinc" => (
            FilterKind::Sinc {
                tau: reader.float_within("tau", 3.0, positive)?,
            },
            4.0,
        ),
        _ => {
            let sigma = reader.float_within("sigma", 0.5, positive)?;
            (FilterKind::Gaussian { sigma }, 1.5)
        }
    };
    let range = [1e-3, WIDEST_FILTER];
    let radius = Vec2::new(
        reader.float_within("xradius", radius, range)?,
        reader.float_within("yradius", radius, range)?,
    );
    reader.finish()?;
    Ok(Filter::new(kind, radius))
}
