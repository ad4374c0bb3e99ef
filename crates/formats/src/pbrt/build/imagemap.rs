//! Textures that look up an image.

use super::context::Context;
use super::reader::Reader;
use crate::image::{Encoding, ImageData};
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::ParameterType;
use crate::source::{Fault, Span};
use bidir::math::Vec2;
use bidir::texture::{Image, ImageFilter, ImageMap, Wrap};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The parameters of an `imagemap`.
pub(super) struct ImageSettings {
    path: PathBuf,
    /// Of the file's name.
    span: Span,
    encoding: Option<Encoding>,
    change: Change,
    wrap: Wrap,
    filter: ImageFilter,
    scale: Vec2,
    offset: Vec2,
}

impl ImageSettings {
    pub(super) fn read(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let Some((name, span)) = reader.string("filename")? else {
            return Err(Fault::scene(
                reader.span(),
                "the parameter `string filename` is missing",
            ));
        };
        let encoding = reader.string("encoding")?;
        let encoding = encoding
            .map(|(name, span)| parse_encoding(name, span))
            .transpose()?;
        let change = Change {
            scale: reader.float("scale", 1.0)?,
            invert: reader.bool("invert", false)?,
        };
        let wrap = read_wrap(context, reader)?;
        let filter = read_filter(context, reader)?;
        reader.ignore(context, ParameterType::Float, "maxanisotropy");
        let (scale, offset) = read_mapping(context, reader)?;
        let path = context.description.resolve(name);
        Ok(Self {
            path,
            span,
            encoding,
            change,
            wrap,
            filter,
            scale,
            offset,
        })
    }

    pub(super) fn map<const N: usize>(&self, image: Arc<Image<N>>) -> ImageMap<N> {
        let Self {
            wrap,
            filter,
            scale,
            offset,
            ..
        } = *self;
        ImageMap {
            image,
            wrap,
            filter,
            scale,
            offset,
        }
    }
}

fn parse_encoding(name: &str, span: Span) -> Result<Encoding, Fault> {
    match name.split_once(' ') {
        None if name.eq_ignore_ascii_case("srgb") => Ok(Encoding::Srgb),
        None if name == "linear" => Ok(Encoding::Linear),
        Some(("gamma", gamma)) => {
            let gamma = gamma.trim().parse().ok().filter(|&gamma: &f32| gamma > 0.0);
            let wrong = || Fault::scene(span, "the exponent of `gamma` is no positive number");
            gamma.map(Encoding::Gamma).ok_or_else(wrong)
        }
        _ => {
            let fault = Fault::scene(span, format!("unknown encoding `{}`", shorten(name)));
            Err(fault.with_hint("write `sRGB`, `linear` or `gamma 2.2`"))
        }
    }
}

fn read_wrap(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<Wrap, Fault> {
    let Some((name, span)) = reader.string("wrap")? else {
        return Ok(Wrap::Repeat);
    };
    match name {
        "repeat" => Ok(Wrap::Repeat),
        "clamp" => Ok(Wrap::Clamp),
        "black" => Ok(Wrap::Black),
        "octahedralsphere" => {
            context.unsupported(
                span,
                "the wrap mode `octahedralsphere`",
                "`clamp` stands in",
            )?;
            Ok(Wrap::Clamp)
        }
        _ => {
            let fault = Fault::scene(span, format!("unknown wrap mode `{}`", shorten(name)));
            Err(fault.with_nearest(name, ["repeat", "clamp", "black", "octahedralsphere"]))
        }
    }
}

fn read_filter(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<ImageFilter, Fault> {
    let Some((name, span)) = reader.string("filter")? else {
        return Ok(ImageFilter::Bilinear);
    };
    match name {
        "point" => Ok(ImageFilter::Point),
        "bilinear" => Ok(ImageFilter::Bilinear),
        "trilinear" | "ewa" | "EWA" => {
            context.warn(
                span,
                format!("the texture filter `{name}` is taken as `bilinear`"),
            );
            Ok(ImageFilter::Bilinear)
        }
        _ => {
            let fault = Fault::scene(span, format!("unknown texture filter `{}`", shorten(name)));
            Err(fault.with_nearest(name, ["point", "bilinear", "trilinear", "ewa"]))
        }
    }
}

fn read_mapping(context: &mut Context<'_>, reader: &mut Reader<'_>) -> Result<(Vec2, Vec2), Fault> {
    match reader.string("mapping")? {
        None | Some(("uv", _)) => {}
        Some((mapping @ ("spherical" | "cylindrical" | "planar"), span)) => {
            context.unsupported(span, &format!("the mapping `{mapping}`"), "`uv` stands in")?;
            for name in ["v1", "v2"] {
                reader.ignore(context, ParameterType::Vector3, name);
            }
        }
        Some((name, span)) => {
            let fault = Fault::scene(span, format!("unknown mapping `{}`", shorten(name)));
            return Err(fault.with_nearest(name, ["uv", "spherical", "cylindrical", "planar"]));
        }
    }
    let scale = Vec2::new(reader.float("uscale", 1.0)?, reader.float("vscale", 1.0)?);
    let offset = Vec2::new(reader.float("udelta", 0.0)?, reader.float("vdelta", 0.0)?);
    Ok((scale, offset))
}

/// What happens to stored values: multiplied first, inverted then.
#[derive(Clone, Copy)]
struct Change {
    scale: f32,
    invert: bool,
}

impl Change {
    fn apply(self, value: f32) -> f32 {
        let scaled = value * self.scale;
        if self.invert {
            (1.0 - scaled).max(0.0)
        } else {
            scaled
        }
    }
}

/// What makes two image textures share their texels.
type Key = (PathBuf, String);

/// Images that are read already.
#[derive(Default)]
pub(super) struct Files {
    colors: BTreeMap<Key, Arc<Image<3>>>,
    floats: BTreeMap<Key, Arc<Image<1>>>,
}

impl Files {
    pub(super) fn color(
        &mut self,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<Arc<Image<3>>, Fault> {
        let change = |data: ImageData| {
            data.rgb()
                .map(|rgb| rgb.map(|value| settings.change.apply(value)))
                .collect()
        };
        shared(&mut self.colors, context, settings, change)
    }

    pub(super) fn float(
        &mut self,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<Arc<Image<1>>, Fault> {
        let change = |data: ImageData| {
            numbers(&data)
                .into_iter()
                .map(|value| [settings.change.apply(value)])
                .collect()
        };
        shared(&mut self.floats, context, settings, change)
    }
}

/// The numbers of an image: alpha where it says something, else the mean of the colours.
fn numbers(data: &ImageData) -> Vec<f32> {
    let alpha = data.data.chunks_exact(4).map(|pixel| pixel[3]);
    if data.channels == 4 && alpha.clone().any(|alpha| alpha < 1.0) {
        return alpha.collect();
    }
    data.rgb().map(|[r, g, b]| (r + g + b) / 3.0).collect()
}

fn shared<const N: usize>(
    images: &mut BTreeMap<Key, Arc<Image<N>>>,
    context: &mut Context<'_>,
    settings: &ImageSettings,
    texels: impl FnOnce(ImageData) -> Vec<[f32; N]>,
) -> Result<Arc<Image<N>>, Fault> {
    let Change { scale, invert } = settings.change;
    let key = (
        settings.path.clone(),
        format!("{:?} {scale} {invert}", settings.encoding),
    );
    if let Some(image) = images.get(&key) {
        return Ok(Arc::clone(image));
    }
    let data = context.read_image(&settings.path, settings.encoding, settings.span)?;
    let width = data.width;
    let mut texels = texels(data);
    let replaced = texels
        .iter_mut()
        .flatten()
        .filter(|value| !value.is_finite());
    let count = replaced.map(|value| *value = 0.0).count();
    if count > 0 {
        let message = format!("{count} numbers of the image are not finite and taken as 0");
        context.warn(settings.span, message);
    }
    let image = Image::new(width, texels)
        .ok_or_else(|| Fault::scene(settings.span, "the image has no pixels"))?;
    let image = Arc::new(image);
    images.insert(key, Arc::clone(&image));
    Ok(image)
}
