//! Light that a list of strategies loses, beside what the estimator loses with all of them.
//!
//! Strategy (s, t) makes a path of s + t vertices if the two ends of its connection do not scatter
//! specularly; s = 0 needs a light that rays can hit. A class of paths is lost if the estimator has
//! strategies for it and none of them is in the list.

use crate::integrator::IntegratorKind;
use crate::light::Light;
use crate::material::Material;
use crate::path::{MAX_VERTICES, PathSettings, Strategies};
use crate::scene::Scene;
use crate::view::View;
use std::fmt;
use std::ops::RangeInclusive;

/// The most vertices of the paths with specular vertices that are looked at: longer ones need no other
/// strategies.
const LONGEST_PATTERN: usize = 7;
/// The most lost patterns that are named.
const EXAMPLES: usize = 3;

/// Light that a list of strategies loses. Its text follows the name of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LostLight {
    /// All of it: the list makes no path.
    All {
        /// The most vertices of a path, where the list makes longer ones.
        max_vertices: Option<usize>,
    },
    /// The paths of these numbers of vertices.
    Lengths(Vec<RangeInclusive<usize>>),
    /// Paths with specular vertices: the shortest patterns, such as `L S E, L S D E`.
    Specular(String),
}

impl fmt::Display for LostLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All { max_vertices: None } => f.write_str("makes no path"),
            Self::All {
                max_vertices: Some(most),
            } => write!(f, "makes no path of at most {most} vertices"),
            Self::Lengths(ranges) => {
                let ranges: Vec<_> = ranges.iter().map(words).collect();
                let lengths = ranges.join(", ");
                write!(
                    f,
                    "loses light: no strategy makes paths of {lengths} vertices"
                )
            }
            Self::Specular(pattern) => write!(
                f,
                "loses light: no strategy makes paths such as {pattern} (L light, S mirror or clear glass, \
                 D other surface, E camera)"
            ),
        }
    }
}

fn words(range: &RangeInclusive<usize>) -> String {
    match (*range.start(), *range.end()) {
        (first, MAX_VERTICES) => format!("{first} and more"),
        (first, last) if first == last => first.to_string(),
        (first, last) => format!("{first} to {last}"),
    }
}

/// Returns the light that the list of `settings` loses in a scene. None: no more than with all strategies, or
/// the integrator does not use the list.
pub fn lost_light(
    scene: &Scene,
    view: &View,
    integrator: IntegratorKind,
    settings: &PathSettings,
) -> Option<LostLight> {
    let list = &settings.strategies;
    if !integrator.has_candidates() || list.is_all() {
        return None;
    }
    if let Some(all) = no_path(integrator, settings) {
        return Some(all);
    }
    let kinds = kinds(scene, view);
    let lost = |edges: &[bool]| kinds.iter().any(|kind| kind.is_lost(list, edges));
    let most = settings.max_vertices();
    let lengths: Vec<_> = (2..=most).filter(|&n| lost(&vec![true; n])).collect();
    if !lengths.is_empty() {
        return Some(LostLight::Lengths(ranges(&lengths)));
    }
    if !scene.materials_of_surfaces().any(Material::may_be_specular) {
        return None;
    }
    let patterns = (3..=most.min(LONGEST_PATTERN)).flat_map(patterns);
    let lost: Vec<_> = patterns.filter(|pattern| lost(pattern)).collect();
    let named = examples(&lost);
    (!named.is_empty()).then(|| LostLight::Specular(named.join(", ")))
}

/// Returns the names of the shortest patterns in which no two neighbours scatter alike; else of the shortest.
fn examples(lost: &[Vec<bool>]) -> Vec<String> {
    let varied = lost.iter().filter(|pattern| {
        let inside = &pattern[1..pattern.len() - 1];
        inside.windows(2).all(|pair| pair[0] != pair[1])
    });
    let varied: Vec<_> = varied.take(EXAMPLES).map(|pattern| name(pattern)).collect();
    if varied.is_empty() {
        lost.iter().take(1).map(|pattern| name(pattern)).collect()
    } else {
        varied
    }
}

/// Returns [`LostLight::All`] where no strategy of the list makes a path within the limit of length.
pub(crate) fn no_path(integrator: IntegratorKind, settings: &PathSettings) -> Option<LostLight> {
    let list = &settings.strategies;
    if !integrator.has_candidates() || list.is_all() {
        return None;
    }
    let makes = |n: usize| (0..n).any(|s| list.contains(s, n - s));
    let most = settings.max_vertices();
    if (2..=most).any(makes) {
        return None;
    }
    let makes_longer = (most + 1..=MAX_VERTICES).any(makes) || list.has_longer_than(MAX_VERTICES);
    Some(LostLight::All {
        max_vertices: makes_longer.then_some(most),
    })
}

/// How light leaves a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LightKind {
    /// No ray hits it.
    Delta,
    Area,
    /// A sky; a parallel camera has no image of it by t = 1.
    Sky {
        is_parallel: bool,
    },
    /// A medium without an end, whose points are found by hits alone.
    Endless,
}

impl LightKind {
    /// Returns true where strategy (s, n - s) makes paths of this light whose vertices scatter diffusely where
    /// `is_diffuse` says so; both ends always do.
    fn makes(self, s: usize, is_diffuse: &[bool]) -> bool {
        let n = is_diffuse.len();
        match (self, s) {
            (Self::Delta, 0) => false,
            (_, 0) => true,
            (Self::Endless, _) => false,
            // Strategy (1, 1): the image of the light itself.
            (Self::Delta | Self::Sky { is_parallel: true }, 1) if n == 2 => false,
            _ => is_diffuse[s - 1] && is_diffuse[s],
        }
    }

    fn is_lost(self, list: &Strategies, is_diffuse: &[bool]) -> bool {
        let n = is_diffuse.len();
        let mut makers = (0..n).filter(|&s| self.makes(s, is_diffuse)).peekable();
        makers.peek().is_some() && !makers.any(|s| list.contains(s, n - s))
    }
}

/// Returns the kinds of lights of a scene, each once.
fn kinds(scene: &Scene, view: &View) -> Vec<LightKind> {
    let is_parallel = view.camera().is_parallel();
    let mut kinds = Vec::new();
    for light in scene.lights() {
        let kind = match light {
            light if light.is_delta() => LightKind::Delta,
            Light::Infinite(_) => LightKind::Sky { is_parallel },
            light if light.is_endless() => LightKind::Endless,
            _ => LightKind::Area,
        };
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

/// Returns all patterns of scattering at `n` vertices with diffuse ends and a specular vertex between.
fn patterns(n: usize) -> impl Iterator<Item = Vec<bool>> {
    let inside = n - 2;
    (1_usize..1 << inside).map(move |bits| {
        let vertex = |i: usize| i == 0 || i == n - 1 || (bits >> (i - 1)) & 1 == 0;
        (0..n).map(vertex).collect()
    })
}

/// Returns the pattern in Heckbert's notation.
fn name(is_diffuse: &[bool]) -> String {
    let last = is_diffuse.len() - 1;
    let letter = |(i, is_diffuse): (usize, &bool)| match i {
        0 => "L",
        i if i == last => "E",
        _ if *is_diffuse => "D",
        _ => "S",
    };
    let letters: Vec<_> = is_diffuse.iter().enumerate().map(letter).collect();
    letters.join(" ")
}

/// Groups ascending numbers into ranges.
fn ranges(numbers: &[usize]) -> Vec<RangeInclusive<usize>> {
    let mut ranges: Vec<RangeInclusive<usize>> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some(last) if *last.end() + 1 == number => *last = *last.start()..=number,
            _ => ranges.push(number..=number),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::super::tests::{even_sky, grey, point, shot};
    use super::*;
    use crate::testing::prelude::{Shot, metal};

    fn lost(shot: &Shot, list: &str, max_depth: u32) -> Option<String> {
        let settings = PathSettings {
            strategies: list.parse().unwrap(),
            max_depth: (max_depth > 0).then_some(max_depth),
            ..PathSettings::default()
        };
        lost_light(&shot.scene, &shot.view, IntegratorKind::Bdpt, &settings)
            .map(|lost| lost.to_string())
    }

    #[track_caller]
    fn check(shot: &Shot, list: &str, max_depth: u32, expected: Option<&str>) {
        assert_eq!(lost(shot, list, max_depth).as_deref(), expected, "{list}");
    }

    #[test]
    fn lists_that_make_no_path_are_found() {
        let shot = shot(&[grey()], vec![even_sky()]);
        for list in ["s0t0", "s0t1", "s1t0", "t0"] {
            check(&shot, list, 5, Some("makes no path"));
        }
        let long = Some("makes no path of at most 7 vertices");
        for list in ["s4t4", "s9999t2", "t1025"] {
            check(&shot, list, 5, long);
        }
        let longest = Some("makes no path of at most 1024 vertices");
        check(&shot, "s9999t2", 0, longest);
        assert!(lost(&shot, "s4t4", 6).unwrap().starts_with("loses light:"));
    }

    #[test]
    fn lost_lengths_are_named() {
        let shot = shot(&[grey()], vec![even_sky()]);
        for (list, lengths) in [
            ("s2", "2"),
            ("s2t3", "2 to 4, 6 to 7"),
            ("s0t2,s1t2", "4 to 7"),
            ("all,-s0t2,-s1t1", "2"),
        ] {
            let expected = format!("loses light: no strategy makes paths of {lengths} vertices");
            check(&shot, list, 5, Some(&expected));
        }
        let open = "loses light: no strategy makes paths of 2 to 4, 6 and more vertices";
        check(&shot, "s2t3", 0, Some(open));
        for list in "all s0 s1 t1 t2 all,-s0 all,-t1 all,-s1".split(' ') {
            check(&shot, list, 5, None);
        }
    }

    #[test]
    fn lights_that_no_ray_hits_need_connections() {
        let shot = shot(&[grey()], vec![point()]);
        let lost = "loses light: no strategy makes paths of 3 to 7 vertices";
        check(&shot, "s0", 5, Some(lost));
        // The light itself is invisible: there are no paths of two vertices to lose.
        for list in ["s1", "s2,s1t2", "all,-s1t1", "t1"] {
            check(&shot, list, 5, None);
        }
    }

    #[test]
    fn mirrors_need_hits_and_light_images() {
        let words = |pattern: &str| {
            format!(
                "loses light: no strategy makes paths such as {pattern} (L light, S mirror or clear glass, \
                 D other surface, E camera)"
            )
        };
        let mirror = |light| shot(&[grey(), metal(0.0)], vec![light]);
        let (under_sky, lit) = (mirror(even_sky()), mirror(point()));
        for (shot, list, patterns) in [
            (&under_sky, "all,-s0", "L S E, L S D S E, L S D S D S E"),
            (&under_sky, "s1", "L S E, L S D E, L S D S E"),
            (&lit, "all,-t1", "L S D E, L S D S D E"),
            (&lit, "all,-s1", "L D S E, L D S D S E"),
        ] {
            check(shot, list, 5, Some(&words(patterns)));
        }
        check(&under_sky, "all,-t1", 5, None);
        check(&lit, "all,-s0", 5, None);
        // Too short for it.
        check(&lit, "all,-t1", 1, None);
    }

    #[test]
    fn only_estimators_with_connections_use_the_list() {
        let shot = shot(&[grey()], vec![even_sky()]);
        let settings = PathSettings {
            strategies: "s0t0".parse().unwrap(),
            ..PathSettings::default()
        };
        for (_, integrator) in IntegratorKind::NAMES {
            let lost = lost_light(&shot.scene, &shot.view, integrator, &settings);
            assert_eq!(lost.is_some(), integrator.has_candidates());
        }
    }
}
