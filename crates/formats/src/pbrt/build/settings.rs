//! Sampler, integrator and options.

use super::context::Context;
use super::film::BuiltFilm;
use super::reader::Reader;
use crate::import::SceneSettings;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::SceneDescription;
use crate::source::Fault;
use bidir::integrator::IntegratorKind;
use bidir::sampler::SamplerKind;
use bidir::view::TextureFiltering;

/// Builds the settings of a render: integrator, sampler, seed, and the film's output and layers.
pub(super) fn build(context: &mut Context<'_>, film: &BuiltFilm) -> Result<SceneSettings, Fault> {
    let (integrator, max_depth) = integrator(context)?;
    let mut settings = SceneSettings {
        integrator,
        max_depth,
        sampler: SamplerKind::Sobol,
        samples_per_pixel: 16,
        seed: None,
        output: film.output.clone(),
        aovs: film.aovs.clone(),
    };
    options(context, &mut settings)?;
    sampler(context, &mut settings)?;
    Ok(settings)
}

/// Returns whether textures are filtered.
pub(super) fn texture_filtering(description: &SceneDescription) -> Result<TextureFiltering, Fault> {
    let mut filtering = TextureFiltering::AsAsked;
    let options = description.options.iter();
    for option in options.filter(|option| option.name == "disabletexturefiltering") {
        filtering = match option.value.as_str() {
            "true" => TextureFiltering::Disabled,
            "false" => TextureFiltering::AsAsked,
            _ => {
                let message = "the option `disabletexturefiltering` must be `true` or `false`";
                return Err(Fault::scene(option.span, message));
            }
        };
    }
    Ok(filtering)
}

fn options(context: &mut Context<'_>, settings: &mut SceneSettings) -> Result<(), Fault> {
    for option in &context.document.options {
        match (option.name.as_str(), option.value.as_str()) {
            ("seed", value) => {
                let wrong = |_| Fault::scene(option.span, "the seed is not a whole number");
                settings.seed = Some(value.parse().map_err(wrong)?);
            }
            // Options of precision or recording, information that the scene contains anyway, and explicit
            // defaults.
            ("rendercoordsys" | "pixelstats" | "wavefront" | "disabletexturefiltering", _)
            | (_, "false") => {}
            (name, _) => {
                let message = format!("the option `{name}` has no effect here");
                context.warn(option.span, message);
            }
        }
    }
    Ok(())
}

fn sampler(context: &mut Context<'_>, settings: &mut SceneSettings) -> Result<(), Fault> {
    let Some(entity) = &context.document.sampler else {
        return Ok(());
    };
    let mut reader = Reader::new(context, entity);
    settings.samples_per_pixel = match entity.kind.as_str() {
        "stratified" => {
            reader.ignore(ParameterType::Bool, "jitter");
            let (x, y) = (
                reader.integer("xsamples", 4, 1)?,
                reader.integer("ysamples", 4, 1)?,
            );
            x.saturating_mul(y)
        }
        "independent" => {
            settings.sampler = SamplerKind::Independent;
            reader.integer("pixelsamples", 4, 1)?
        }
        _ => {
            reader.ignore(ParameterType::String, "randomization");
            reader.integer("pixelsamples", 16, 1)?
        }
    };
    if !matches!(entity.kind.as_str(), "independent" | "sobol") {
        let message = format!("the sampler `{}` is replaced by `sobol`", entity.kind);
        reader.context.warn(entity.span, message);
    }
    if let Some(seed) = reader.optional_integer("seed")? {
        settings.seed = Some(u64::from(seed.unsigned_abs()));
    }
    reader.finish()
}

fn integrator(context: &mut Context<'_>) -> Result<(IntegratorKind, u32), Fault> {
    let Some(entity) = &context.document.integrator else {
        return Ok((IntegratorKind::Path, 5));
    };
    let mut reader = Reader::new(context, entity);
    let max_depth = reader.integer("maxdepth", 5, 0)?;
    let kind = match entity.kind.as_str() {
        "path" | "volpath" => IntegratorKind::Path,
        "bdpt" => IntegratorKind::Bdpt,
        "lightpath" => IntegratorKind::Light,
        name => {
            // The parameters of another method do not apply to the substitute.
            let substitute = match name {
                "mlt" | "sppm" => ("`bdpt` is used instead", IntegratorKind::Bdpt),
                _ => ("`path` is used instead", IntegratorKind::Path),
            };
            let what = format!("the integrator `{name}`");
            (reader.context).unsupported(entity.span, &what, substitute.0)?;
            return Ok((substitute.1, max_depth));
        }
    };
    if entity.kind != "lightpath" {
        reader.ignore(ParameterType::String, "lightsampler");
        if reader.bool("regularize", false)? {
            let what = "the parameter `bool regularize`";
            (reader.context).unsupported(entity.span, what, "nothing is regularised")?;
        }
    }
    if entity.kind == "bdpt" {
        reader.ignore(ParameterType::Bool, "visualizestrategies");
        reader.ignore(ParameterType::Bool, "visualizeweights");
    }
    reader.finish()?;
    Ok((kind, max_depth))
}
