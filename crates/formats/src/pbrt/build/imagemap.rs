//! Textures that look up an image.

use super::context::Context;
use super::mapping;
use super::reader::Reader;
use crate::image::{Encoding, ImageData};
use crate::import::{self, Images};
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::TextureDescription;
use crate::source::{Fault, Span};
use bidir::texture::{Beyond, Change, ImageFilter, ImageMap, Mapping, Wrap};
use std::path::PathBuf;

/// The file and the encoding: image textures with equal keys share their texels.
pub(super) type Key = (PathBuf, String);

/// The parameters of an `imagemap`.
pub(super) struct ImageSettings {
    path: PathBuf,
    /// The place of the image file's name.
    span: Span,
    encoding: Option<Encoding>,
    change: Change,
    wrap: Wrap,
    filter: ImageFilter,
    mapping: Mapping,
}

impl ImageSettings {
    pub(super) fn read(
        texture: &TextureDescription,
        reader: &mut Reader<'_, '_>,
    ) -> Result<Self, Fault> {
        let Some((name, span)) = reader.string("filename")? else {
            return Err(reader.missing("string filename"));
        };
        let given = reader.string("encoding")?;
        let encoding = given.map(|(name, span)| parse_encoding(name, span));
        let scale = reader.float("scale", 1.0)?;
        let change = if reader.bool("invert", false)? {
            Change::ScaleAndInvert(scale)
        } else {
            Change::Scale(scale)
        };
        let wrap = read_wrap(reader)?;
        let filter = read_filter(reader)?;
        reader.ignore(ParameterType::Float, "maxanisotropy");
        let mapping = mapping::read(texture, reader)?;
        Ok(Self {
            path: reader.context.document.resolve(name),
            span,
            encoding: encoding.transpose()?,
            change,
            wrap,
            filter,
            mapping,
        })
    }

    /// Returns the settings of a normal map.
    pub(super) fn of_normals(context: &Context<'_>, name: &str, span: Span) -> Self {
        Self {
            path: context.document.resolve(name),
            span,
            encoding: Some(Encoding::Linear),
            change: Change::Scale(1.0),
            wrap: Wrap::all(Beyond::Repeat),
            filter: ImageFilter::Bilinear,
            mapping: Mapping::IDENTITY,
        }
    }

    /// Returns the texture of these settings. `texels` converts the image to texels.
    pub(super) fn map<const N: usize>(
        &self,
        context: &mut Context<'_>,
        images: &mut Images<Key, N>,
        texels: fn(&ImageData) -> Vec<[f32; N]>,
    ) -> Result<ImageMap<N>, Fault> {
        let (path, span, encoding) = (&self.path, self.span, self.encoding);
        let key = (path.clone(), format!("{encoding:?}"));
        let image = images.get(key, self.filter, &span, || {
            let data = context.read_image(path, encoding, span)?;
            let mut texels = texels(&data);
            let count = import::replace_invalid(&mut texels, f32::is_finite);
            if count > 0 {
                let message = format!("{count} values of the image are not finite and count as 0");
                context.warn(span, message);
            }
            Ok((data.width, texels))
        })?;
        Ok(ImageMap {
            image,
            wrap: self.wrap,
            filter: self.filter,
            change: self.change,
            mapping: self.mapping,
        })
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
    let modes = [
        ("repeat", Wrap::all(Beyond::Repeat)),
        ("clamp", Wrap::all(Beyond::Clamp)),
        ("black", Wrap::all(Beyond::Black)),
        ("octahedralsphere", Wrap::OctahedralSphere),
    ];
    reader.choice("wrap", "wrap mode", &modes)
}

fn read_filter(reader: &mut Reader<'_, '_>) -> Result<ImageFilter, Fault> {
    let filters = [
        ("bilinear", ImageFilter::Bilinear),
        ("point", ImageFilter::Point),
        ("trilinear", ImageFilter::Trilinear),
        ("ewa", ImageFilter::Trilinear),
        ("EWA", ImageFilter::Trilinear),
    ];
    if let Some((name @ ("ewa" | "EWA"), span)) = reader.string("filter")? {
        let message = format!("the texture filter `{name}` is replaced by `trilinear`");
        reader.context.warn(span, message);
    }
    reader.choice("filter", "texture filter", &filters)
}

/// Returns the numbers of an image: alpha if any pixel is not opaque, else the mean of the colours.
pub(super) fn numbers(data: &ImageData) -> Vec<[f32; 1]> {
    let alpha = data.data.chunks_exact(4).map(|pixel| [pixel[3]]);
    if data.channels == 4 && alpha.clone().any(|[alpha]| alpha < 1.0) {
        return alpha.collect();
    }
    data.rgb().map(|[r, g, b]| [(r + g + b) / 3.0]).collect()
}
