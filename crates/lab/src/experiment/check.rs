//! Checks of methods in the scenes of an experiment.

use super::error::ExperimentError;
use super::loaded_scene::LoadedScene;
use super::observer::{Event, Observer};
use super::settings::no_effect;
use super::{Experiment, MethodSpec};
use bidir::analysis::{LostLight, lost_light};
use formats::film::Subject;

type Result<T> = std::result::Result<T, ExperimentError>;

/// Refuses methods whose strategies make no path in a scene. Warns of methods that lose light, once for all
/// methods that lose the same light.
pub(super) fn methods(
    experiment: &Experiment,
    scenes: &[LoadedScene<'_>],
    observer: &mut dyn Observer,
) -> Result<()> {
    let mut losses: Vec<(String, Vec<&str>)> = Vec::new();
    for method in &experiment.methods {
        let scenes = scenes.iter();
        for loaded in scenes.filter(|loaded| loaded.has(experiment, method)) {
            check_effect(method, loaded)?;
            let Some(text) = loss(method, loaded)? else {
                continue;
            };
            match losses.iter_mut().find(|(known, _)| *known == text) {
                Some((_, methods)) => methods.push(&method.name),
                None => losses.push((text, vec![&method.name])),
            }
        }
    }
    for (text, mut methods) in losses {
        methods.dedup();
        let others = match methods.len() - 1 {
            0 => String::new(),
            1 => " and another".to_owned(),
            others => format!(" and {others} others"),
        };
        let warning = format!("method `{}`{others}: {text}", methods[0]);
        observer.notify(Event::Warning(&warning));
    }
    Ok(())
}

/// Describes the light that a method loses in a scene. None: it loses none.
///
/// Errors: its strategies make no path.
fn loss(method: &MethodSpec, loaded: &LoadedScene<'_>) -> Result<Option<String>> {
    let settings = method.request.apply(&loaded.settings);
    let (path, integrator) = (&settings.path, settings.integrator);
    let Subject { scene, view, .. } = &loaded.subject;
    let Some(lost) = lost_light(scene, view, integrator, path) else {
        return Ok(None);
    };
    let text = format!("strategies {} {lost}", path.strategies);
    if matches!(lost, LostLight::All { .. }) {
        return Err(loaded.refusal(method, text, None));
    }
    Ok(Some(text))
}

/// Refuses a setting of the method that has no effect on the scene file's integrator.
fn check_effect(method: &MethodSpec, loaded: &LoadedScene<'_>) -> Result<()> {
    let request = &method.request;
    let integrator = loaded.settings.integrator;
    match request.ignored(&loaded.settings).first() {
        Some(name) if request.integrator.is_none() => {
            let text = format!("{}, which the scene sets", no_effect(name, integrator));
            let hint = "set `integrator` in [settings] or in the method";
            Err(loaded.refusal(method, text, Some(hint)))
        }
        _ => Ok(()),
    }
}
