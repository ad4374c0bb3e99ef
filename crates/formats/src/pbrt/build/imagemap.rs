//! Textures that look up an image.

use super::context::Context;
use super::mapping;
use super::reader::Reader;
use crate::image::{Encoding, ImageData};
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::TextureDescription;
use crate::source::{Fault, Span};
use bidir::texture::{Beyond, Change, Image, ImageFilter, ImageMap, Mapping, Wrap};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The parameters of an `imagemap`.
pub(super) struct ImageSettings {
    file: ImageFile,
    change: Change,
    wrap: Wrap,
    filter: ImageFilter,
    mapping: Mapping,
}

/// An image file and its encoding.
pub(super) struct ImageFile {
    path: PathBuf,
    /// The place of the file's name.
    span: Span,
    encoding: Option<Encoding>,
}

impl ImageSettings {
    pub(super) fn read(
        texture: &TextureDescription,
        reader: &mut Reader<'_, '_>,
    ) -> Result<Self, Fault> {
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
        let scale = reader.float("scale", 1.0)?;
        let change = if reader.bool("invert", false)? {
            Change::ScaleAndInvert(scale)
        } else {
            Change::Scale(scale)
        };
        let wrap = read_wrap(reader)?;
        let filter = read_filter(reader)?;
        reader.ignore(ParameterType::Float, "maxanisotropy");
        let file = ImageFile {
            path: reader.context.document.resolve(name),
            span,
            encoding,
        };
        let mapping = mapping::read(texture, reader)?;
        Ok(Self {
            file,
            change,
            wrap,
            filter,
            mapping,
        })
    }

    /// Returns the settings of a normal map.
    pub(super) fn of_normals(context: &Context<'_>, name: &str, span: Span) -> Self {
        Self {
            file: ImageFile {
                path: context.document.resolve(name),
                span,
                encoding: Some(Encoding::Linear),
            },
            change: Change::Scale(1.0),
            wrap: Wrap::all(Beyond::Repeat),
            filter: ImageFilter::Bilinear,
            mapping: Mapping::IDENTITY,
        }
    }

    fn map<const N: usize>(&self, image: Arc<Image<N>>) -> ImageMap<N> {
        ImageMap {
            image,
            wrap: self.wrap,
            filter: self.filter,
            change: self.change,
            mapping: self.mapping,
        }
    }
}

fn parse_encoding(name: &str, span: Span) -> Result<Encoding, Fault> {
    match name.split_once(' ') {
        None if name.eq_ignore_ascii_case("srgb") => Ok(Encoding::Srgb),
        None if name == "linear" => Ok(Encoding::Linear),
        Some(("gamma", gamma)) => {
            let gamma = gamma.trim().parse().ok().filter(|&gamma: &f32| gamma > 0.0);
            let wrong = || Fault::scene(span, "the exponent of `gamma` is not a positive number");
            gamma.map(Encoding::Gamma).ok_or_else(wrong)
        }
        _ => {
            let fault = Fault::scene(span, format!("unknown encoding `{}`", shorten(name)));
            Err(fault.with_hint("write `sRGB`, `linear` or `gamma 2.2`"))
        }
    }
}

fn read_wrap(reader: &mut Reader<'_, '_>) -> Result<Wrap, Fault> {
    let Some((name, span)) = reader.string("wrap")? else {
        return Ok(Wrap::all(Beyond::Repeat));
    };
    match name {
        "repeat" => Ok(Wrap::all(Beyond::Repeat)),
        "clamp" => Ok(Wrap::all(Beyond::Clamp)),
        "black" => Ok(Wrap::all(Beyond::Black)),
        "octahedralsphere" => Ok(Wrap::OctahedralSphere),
        _ => {
            let fault = Fault::scene(span, format!("unknown wrap mode `{}`", shorten(name)));
            Err(fault.with_nearest(name, ["repeat", "clamp", "black", "octahedralsphere"]))
        }
    }
}

fn read_filter(reader: &mut Reader<'_, '_>) -> Result<ImageFilter, Fault> {
    let Some((name, span)) = reader.string("filter")? else {
        return Ok(ImageFilter::Bilinear);
    };
    match name {
        "point" => Ok(ImageFilter::Point),
        "bilinear" => Ok(ImageFilter::Bilinear),
        "trilinear" => Ok(ImageFilter::Trilinear),
        "ewa" | "EWA" => {
            let message = format!("the texture filter `{name}` is replaced by `trilinear`");
            reader.context.warn(span, message);
            Ok(ImageFilter::Trilinear)
        }
        _ => {
            let fault = Fault::scene(span, format!("unknown texture filter `{}`", shorten(name)));
            Err(fault.with_nearest(name, ["point", "bilinear", "trilinear", "ewa"]))
        }
    }
}

/// The file and the encoding: image textures with equal keys share their texels.
type Key = (PathBuf, String);

/// The images that were read: each file once for colours and once for numbers.
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
    ) -> Result<ImageMap<3>, Fault> {
        let texels = |data: ImageData| data.rgb().collect();
        let image = shared(&mut self.colors, context, settings, texels)?;
        Ok(settings.map(image))
    }

    pub(super) fn float(
        &mut self,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<ImageMap<1>, Fault> {
        let texels = |data: ImageData| numbers(&data).into_iter().map(|value| [value]).collect();
        let image = shared(&mut self.floats, context, settings, texels)?;
        Ok(settings.map(image))
    }
}

/// Returns the numbers of an image: alpha if any pixel is not opaque, else the mean of the colours.
fn numbers(data: &ImageData) -> Vec<f32> {
    let alpha = data.data.chunks_exact(4).map(|pixel| pixel[3]);
    if data.channels == 4 && alpha.clone().any(|alpha| alpha < 1.0) {
        return alpha.collect();
    }
    data.rgb().map(|[r, g, b]| (r + g + b) / 3.0).collect()
}

/// Returns the image of a file, with a pyramid of smaller copies if the filter needs one.
fn shared<const N: usize>(
    images: &mut BTreeMap<Key, Arc<Image<N>>>,
    context: &mut Context<'_>,
    settings: &ImageSettings,
    texels: impl FnOnce(ImageData) -> Vec<[f32; N]>,
) -> Result<Arc<Image<N>>, Fault> {
    let file = &settings.file;
    let key = (file.path.clone(), format!("{:?}", file.encoding));
    let mut image = match images.get(&key) {
        Some(image) => Arc::clone(image),
        None => Arc::new(read_image(context, file, texels)?),
    };
    if settings.filter == ImageFilter::Trilinear && image.copies() == 0 {
        image = Arc::new(Arc::unwrap_or_clone(image).with_copies());
    }
    images.insert(key, Arc::clone(&image));
    Ok(image)
}

fn read_image<const N: usize>(
    context: &mut Context<'_>,
    file: &ImageFile,
    texels: impl FnOnce(ImageData) -> Vec<[f32; N]>,
) -> Result<Image<N>, Fault> {
    let data = context.read_image(&file.path, file.encoding, file.span)?;
    let width = data.width;
    let mut texels = texels(data);
    let replaced = texels
        .iter_mut()
        .flatten()
        .filter(|value| !value.is_finite());
    let count = replaced.map(|value| *value = 0.0).count();
    if count > 0 {
        let message = format!("{count} values of the image are not finite and count as 0");
        context.warn(file.span, message);
    }
    Image::new(width, texels).ok_or_else(|| Fault::scene(file.span, "the image has no pixels"))
}
