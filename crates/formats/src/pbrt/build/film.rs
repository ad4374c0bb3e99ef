//! The film.

use super::camera::CameraSettings;
use super::context::Context;
use super::filter;
use super::reader::Reader;
use super::sensor;
use crate::import::Crop;
use crate::pbrt::parameters::{ParameterList, ParameterType, Values};
use crate::pbrt::scene::{ColorSpace, Entity, FilmDescription};
use crate::source::{Fault, SourceMap, Span};
use bidir::film::{Aov, FilmSettings};

/// A film, with the properties of its description that are not in [`FilmSettings`].
pub(super) struct BuiltFilm {
    /// The film.
    pub(super) settings: FilmSettings,
    /// Width and height in the file, which determine the camera's view, so that another size shows the same
    /// picture.
    pub(super) own_resolution: [u32; 2],
    /// The place in the file that gives the size. None: the caller's options give the size.
    pub(super) place: Option<Span>,
    /// The name of the image.
    pub(super) output: Option<String>,
    /// The layers.
    pub(super) aovs: Vec<Aov>,
}

/// Builds the film of `camera`.
pub(super) fn build(
    context: &mut Context<'_>,
    camera: &CameraSettings,
) -> Result<BuiltFilm, Fault> {
    let filter = filter::build(context, camera)?;
    let default = default_film();
    let film = context.document.film.as_ref().unwrap_or(&default);
    let span = film.entity.span;
    if film.color_space != ColorSpace::Srgb {
        let message = "the image has the primaries of sRGB, not those of its `ColorSpace`";
        context.warn(span, message);
    }
    let mut reader = Reader::new(context, &film.entity);
    let aovs = film_kind(&mut reader, &film.entity)?;
    let own = [
        reader.integer("xresolution", 1280, 1)?,
        reader.integer("yresolution", 720, 1)?,
    ];
    let size_span = size_place(&mut reader, own);
    let resolution = reader.context.options.resolution(own, size_span)?;
    let is_given = reader.context.options.resolution.is_some();
    let mut settings = FilmSettings::new(resolution, filter);
    let described = read_crop(&mut reader, own, resolution)?;
    settings.crop = reader.context.options.crop(described, resolution, span)?;
    settings.exposure = exposure(&mut reader, camera)?;
    settings.sensor = sensor::build(&mut reader, settings.exposure)?;
    let output = reader.string("filename")?.map(|(name, _)| name.to_owned());
    reader.ignore(ParameterType::Bool, "savefp16");
    reader.ignore(ParameterType::Float, "diagonal");
    reader.finish()?;
    warn_of_stretching(context, span, own, resolution);
    Ok(BuiltFilm {
        settings,
        own_resolution: own,
        place: (!is_given).then_some(size_span),
        output,
        aovs,
    })
}

/// Returns the place of the longer side of a film, else of the film.
fn size_place(reader: &mut Reader<'_, '_>, [width, height]: [u32; 2]) -> Span {
    let sides = ["xresolution", "yresolution"];
    let longer = usize::from(height > width);
    let mut place = |name| Some(reader.find(ParameterType::Integer, name)?.value_span);
    let found = place(sides[longer]).or_else(|| place(sides[1 - longer]));
    found.unwrap_or(reader.span())
}

/// Returns the film of a scene without one.
fn default_film() -> FilmDescription {
    FilmDescription {
        entity: Entity {
            kind: "rgb".into(),
            parameters: ParameterList::default(),
            span: SourceMap::BEGINNING,
        },
        color_space: ColorSpace::Srgb,
    }
}

/// Returns the factor on pixel values: exposure time (s) · ISO / 100. Errors: it is not finite.
fn exposure(reader: &mut Reader<'_, '_>, camera: &CameraSettings) -> Result<f32, Fault> {
    let iso = reader.float_within("iso", 100.0, [0.0, f32::MAX])?;
    let exposure = camera.exposure_time * iso / 100.0;
    if exposure.is_finite() {
        return Ok(exposure);
    }
    let given = reader.find(ParameterType::Float, "iso");
    let span = given.map_or(camera.span, |parameter| parameter.value_span);
    let time = camera.exposure_time;
    let message =
        format!("the exposure is not a finite number: {time:e} seconds · iso {iso:e} / 100");
    Err(Fault::scene(span, message))
}

/// Warns if `resolution` has another aspect ratio than the file's: pixels are not square.
fn warn_of_stretching(context: &mut Context<'_>, span: Span, own: [u32; 2], resolution: [u32; 2]) {
    let aspect = |[width, height]: [u32; 2]| f64::from(width) / f64::from(height);
    let stretch = aspect(own) / aspect(resolution);
    if !(0.98..1.02).contains(&stretch) {
        let [width, height] = own;
        let message = format!(
            "the scene's film has another aspect ratio, {width} × {height}: the image is stretched, \
             as pixels are {stretch:.3} times as wide as high"
        );
        context.warn(span, message);
    }
}

/// The layers of a film of type `gbuffer`.
const GBUFFER: [Aov; 5] = [
    Aov::Albedo,
    Aov::Position,
    Aov::Normal,
    Aov::ShadingNormal,
    Aov::Variance,
];

/// Returns the layers of this type of film.
fn film_kind(reader: &mut Reader<'_, '_>, film: &Entity) -> Result<Vec<Aov>, Fault> {
    match film.kind.as_str() {
        "rgb" => Ok(Vec::new()),
        "gbuffer" => {
            let spaces = [("camera", false), ("world", true)];
            if !reader.choice("coordinatesystem", "coordinate system", &spaces)? {
                let given = reader.string("coordinatesystem")?;
                let span = given.map_or(film.span, |(_, span)| span);
                let message = "positions and normals of the image are in world space";
                reader.context.warn(span, message);
            }
            let message = "the image has no channels `dzdx`, `dzdy`, `u` and `v`";
            reader.context.warn(film.span, message);
            Ok(GBUFFER.to_vec())
        }
        kind => {
            let what = format!("the film `{kind}`");
            (reader.context).unsupported(film.span, &what, "`rgb` is used instead")?;
            reader.ignore(ParameterType::Integer, "nbuckets");
            reader.ignore(ParameterType::Float, "lambdamin");
            reader.ignore(ParameterType::Float, "lambdamax");
            Ok(Vec::new())
        }
    }
}

/// Reads `cropwindow`, else `pixelbounds`, which counts pixels of the film's `own` resolution. None: the
/// file has neither.
fn read_crop(
    reader: &mut Reader<'_, '_>,
    own: [u32; 2],
    resolution: [u32; 2],
) -> Result<Option<Crop>, Fault> {
    let bounds = reader.find(ParameterType::Integer, "pixelbounds");
    let window = reader.find(ParameterType::Float, "cropwindow");
    let Some(parameter) = window.or(bounds) else {
        return Ok(None);
    };
    let crop = match &parameter.values {
        Values::Floats(values) => window_crop(values),
        Values::Integers(values) => bounds_crop(values, own, resolution),
        _ => None,
    };
    crop.map(Some).ok_or_else(|| {
        let name = &parameter.name;
        let message = format!("`{name}` needs left, right, top and bottom of a part of the film");
        Fault::scene(parameter.value_span, message)
    })
}

/// Reads the crop of `cropwindow`. None: it is not four valid fractions.
fn window_crop(values: &[f32]) -> Option<Crop> {
    let window: [f32; 4] = values.try_into().ok()?;
    let inside = window.iter().all(|edge| (0.0..=1.0).contains(edge));
    inside.then_some(Crop::Fractions(window))
}

fn bounds_crop(values: &[i32], own: [u32; 2], resolution: [u32; 2]) -> Option<Crop> {
    let values = values.iter().filter_map(|&edge| u32::try_from(edge).ok());
    let bounds: [u32; 4] = values.collect::<Vec<_>>().try_into().ok()?;
    if own == resolution {
        return Some(Crop::Pixels(bounds));
    }
    let [width, height] = own.map(|side| side as f32);
    let [x0, x1, y0, y1] = bounds.map(|edge| edge as f32);
    let fractions = [x0 / width, x1 / width, y0 / height, y1 / height];
    Some(Crop::Fractions(fractions))
}
