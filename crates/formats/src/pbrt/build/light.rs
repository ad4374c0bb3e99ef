//! Lights that are not shapes.

use super::color;
use super::context::Context;
use super::group;
use super::reader::Reader;
use crate::import::{self, vector};
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::LightDescription;
use crate::source::{Fault, Span};
use bidir::light::{DistantLight, InfiniteLight, Light, PointLight, SpotLight};
use bidir::math::{Mat3, PI, Vec2, Vec3, square_to_direction};
use bidir::spectrum::{Illuminant, Rgb, luminance};
use bidir::texture::Image;
use glam::{DAffine3, DMat3, DVec3};

/// Builds a light, with the name of its group if it has one. None: it is not supported and left out.
pub(super) fn build(
    context: &mut Context<'_>,
    light: &LightDescription,
) -> Result<Option<(Light, Option<String>)>, Fault> {
    let span = light.entity.span;
    if light.transforms.is_animated() {
        let message = "lights cannot move: the first position of the light is used";
        context.warn(span, message);
    }
    let world_from_light = &light.transforms.start;
    let mut reader = Reader::new(context, &light.entity);
    let built = match light.entity.kind.as_str() {
        "point" => Light::Point(point(&mut reader, world_from_light)?),
        "spot" => Light::Spot(spot(&mut reader, world_from_light)?),
        "distant" => Light::Distant(distant(&mut reader, world_from_light)?),
        "infinite" => Light::Infinite(infinite(&mut reader, world_from_light)?),
        kind => {
            let what = format!("the light source `{kind}`");
            (reader.context).unsupported(span, &what, "it is left out")?;
            return Ok(None);
        }
    };
    let group = group::read(&mut reader)?;
    reader.finish()?;
    Ok(Some((built, group)))
}

/// Reads the light `name` times `scale`, and times `power` / `per_unit` if the file gives power.
fn emission(
    reader: &mut Reader<'_, '_>,
    name: &'static str,
    power: &'static str,
    per_unit: f32,
) -> Result<Illuminant, Fault> {
    let light = color::read_light(reader, name)?.unwrap_or([1.0; 3].into());
    let factor = factor(reader, power, per_unit)?;
    color::scaled_light(reader.span(), light, factor)
}

fn factor(reader: &mut Reader<'_, '_>, power: &'static str, per_unit: f32) -> Result<f32, Fault> {
    let scale = reader.float_within("scale", 1.0, [0.0, f32::MAX])?;
    let power = reader.optional_float(power)?.filter(|&power| power > 0.0);
    Ok(power.map_or(scale, |power| scale * power / per_unit))
}

fn point(reader: &mut Reader<'_, '_>, world_from_light: &DAffine3) -> Result<PointLight, Fault> {
    let intensity = intensity(reader, 4.0 * PI)?;
    let from = vector(reader.point3("from", [0.0; 3])?);
    let position = world_from_light.transform_point3(from);
    Ok(PointLight {
        position: position_of(reader, position)?,
        intensity,
    })
}

/// Reads the intensity of a point light, whose power is spread over a solid angle.
fn intensity(reader: &mut Reader<'_, '_>, solid_angle: f32) -> Result<Illuminant, Fault> {
    let intensity = emission(reader, "I", "power", solid_angle)?;
    Ok(intensity.map(|channel| reader.context.layout.space.intensity(channel)))
}

/// Maps a point from the world to the render space.
fn position_of(reader: &Reader<'_, '_>, world: DVec3) -> Result<Vec3, Fault> {
    import::check_point(world, &reader.span())?;
    let from_world = reader.context.layout.render_from_world();
    Ok(from_world.transform_point3(world).as_vec3())
}

/// Reads the position of a light and the world direction of its axis.
fn aim(reader: &mut Reader<'_, '_>, world_from_light: &DAffine3) -> Result<(DVec3, Vec3), Fault> {
    let from = vector(reader.point3("from", [0.0; 3])?);
    let to = vector(reader.point3("to", [0.0, 0.0, 1.0])?);
    let axis = world_from_light.transform_vector3(to - from);
    let same = || reader.fault("`from` and `to` of the light are the same point");
    let direction = axis.try_normalize().ok_or_else(same)?.as_vec3();
    Ok((world_from_light.transform_point3(from), direction))
}

fn spot(reader: &mut Reader<'_, '_>, world_from_light: &DAffine3) -> Result<SpotLight, Fault> {
    let end = reader.float_within("coneangle", 30.0, [1e-3, 180.0])?;
    let full = (end - reader.float_within("conedeltaangle", 5.0, [0.0, 180.0])?).max(0.0);
    let [full, end] = [full, end].map(f32::to_radians);
    let (cos_full, cos_end) = (libm::cosf(full), libm::cosf(end));
    let solid_angle = 2.0 * PI * ((1.0 - cos_full) + (cos_full - cos_end) / 2.0);
    let intensity = intensity(reader, solid_angle)?;
    let (position, axis) = aim(reader, world_from_light)?;
    let position = position_of(reader, position)?;
    Ok(SpotLight::new(position, axis, intensity, [full, end]))
}

fn distant(
    reader: &mut Reader<'_, '_>,
    world_from_light: &DAffine3,
) -> Result<DistantLight, Fault> {
    let irradiance = emission(reader, "L", "illuminance", 1.0)?;
    let (_, direction) = aim(reader, world_from_light)?;
    Ok(DistantLight {
        to_light: -direction,
        irradiance,
    })
}

fn infinite(
    reader: &mut Reader<'_, '_>,
    world_from_light: &DAffine3,
) -> Result<InfiniteLight, Fault> {
    let everywhere = "light comes from everywhere";
    reader.unsupported(ParameterType::Point3, "portal", everywhere)?;
    let Some((name, span)) = reader.string("filename")? else {
        let radiance = emission(reader, "L", "illuminance", PI)?;
        return Ok(InfiniteLight::constant(radiance));
    };
    if color::read_light(reader, "L")?.is_some() {
        return Err(reader.fault("an infinite light has `L` or `filename`, not both"));
    }
    let image = environment(reader.context, name, span)?;
    let scale = factor(reader, "illuminance", illuminance(&image))?;
    let brightest = image.texels().iter().flatten().copied().fold(0.0, f32::max);
    color::check_emission(reader.span(), [brightest * scale; 3])?;
    let rotation = rotation(reader, &world_from_light.matrix3)?;
    Ok(InfiniteLight::image(image, scale, rotation))
}

/// Reads an equal-area image of the sphere.
fn environment(context: &mut Context<'_>, name: &str, span: Span) -> Result<Image<3>, Fault> {
    let image = radiance_image(context, name, span)?;
    let (width, height) = (image.width(), image.height());
    if width != height {
        let message = format!(
            "the image of an environment is square; this one has {width} × {height} pixels"
        );
        let hint = "convert longitude and latitude with `imgtool makeequiarea`";
        return Err(Fault::scene(span, message).with_hint(hint));
    }
    Ok(image)
}

/// Reads an image of radiance.
pub(super) fn radiance_image(
    context: &mut Context<'_>,
    name: &str,
    span: Span,
) -> Result<Image<3>, Fault> {
    let path = context.document.resolve(name);
    let data = context.read_image(&path, None, span)?;
    let is_radiance = |channel: f32| channel.is_finite() && channel >= 0.0;
    let mut texels: Vec<Rgb> = data.rgb().collect();
    let count = import::replace_invalid(&mut texels, is_radiance);
    if count > 0 {
        let message = format!("{count} values of the image are not radiances and count as 0");
        context.warn(span, message);
    }
    import::image(data.width, texels, &span)
}

/// Computes the illuminance of an environment as the format defines it: (2π/N) Σ luminance · cosθ over the
/// upper half.
fn illuminance(image: &Image<3>) -> f32 {
    let (width, height) = (image.width(), image.height());
    let mut sum = 0.0;
    for (y, row) in image.texels().chunks_exact(width).enumerate() {
        for (x, &texel) in row.iter().enumerate() {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let direction = square_to_direction(p / Vec2::new(width as f32, height as f32));
            sum += f64::from(luminance(texel) * direction.z.max(0.0));
        }
    }
    2.0 * PI * (sum / (width * height) as f64) as f32
}

/// Returns the rotation or reflection of a map, without its uniform scale, which does not change directions.
fn rotation(reader: &mut Reader<'_, '_>, matrix: &DMat3) -> Result<Mat3, Fault> {
    let scale = matrix.x_axis.length();
    let scaled = *matrix * (1.0 / scale);
    let difference = scaled.transpose() * scaled - DMat3::IDENTITY;
    if difference
        .to_cols_array()
        .iter()
        .any(|entry| entry.abs() > 1e-3)
    {
        let what = "an environment that is sheared";
        (reader.context).unsupported(reader.span(), what, "it is not rotated")?;
        return Ok(Mat3::IDENTITY);
    }
    Ok(scaled.as_mat3())
}
