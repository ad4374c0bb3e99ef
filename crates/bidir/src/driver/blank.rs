//! Pictures without content, black or the same everywhere, and the reason.

use crate::analysis::blind_spots;
use crate::film::{FilmSettings, Picture};
use crate::light::Light;
use crate::math::Vec2;
use crate::sampler::{Domain, Sampler, SamplerKind};
use crate::scene::{RayDraws, Scene};
use crate::settings::Settings;
use crate::strategy::Strategies;
use crate::view::View;

/// Rays along each side of the grid over the film.
const SIDE: u32 = 16;

/// Counts of the first surfaces that a camera sees through a grid of points of the film.
#[derive(Clone, Copy, Default)]
struct Sight {
    /// The number of rays that hit a surface.
    hits: usize,
    /// The number of rays that hit a surface from behind.
    backs: usize,
}

impl Sight {
    /// Counts what the camera sees through the rendered part of the film.
    fn of(scene: &Scene, view: &View) -> Self {
        let crop = view.film().crop;
        let sampler = Sampler::new(SamplerKind::Independent, 0);
        let mut sight = Self::default();
        for i in 0..SIDE * SIDE {
            let at = (Vec2::new((i % SIDE) as f32, (i / SIDE) as f32) + 0.5) / SIDE as f32;
            let size = Vec2::new(crop.width() as f32, crop.height() as f32);
            let corner = Vec2::from(crop.min.map(|side| side as f32));
            let ray = view
                .camera()
                .sample_ray(corner + at * size, || Vec2::splat(0.5));
            let stream = sampler.stream(Domain::Camera, 0, i.into());
            let hit = scene.intersect(ray.origin, ray.direction, RayDraws::new(&stream, 1));
            if let Some(hit) = hit {
                sight.hits += 1;
                sight.backs += usize::from(hit.surface.n_g.dot(ray.direction) > 0.0);
            }
        }
        sight
    }
}

/// Returns a warning, with the reason, for a picture that is black or has one colour everywhere. None: pixels differ,
/// or the picture is a single pixel that is not black.
pub(super) fn blank_warning(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    picture: &Picture,
) -> Option<String> {
    let first = picture.pixels.first()?;
    let bits = |pixel: &[f32; 3]| pixel.map(|value| (value + 0.0).to_bits());
    if picture
        .pixels
        .iter()
        .any(|pixel| bits(pixel) != bits(first))
    {
        return None;
    }
    if bits(first) == [0; 3] {
        return Some(format!(
            "the image is black: {}",
            darkness(scene, view, settings)
        ));
    }
    let sight = Sight::of(scene, view);
    let reason = match sight.hits {
        0 if is_cropped(view.film()) => "no surface is in the part of the film that is rendered",
        0 => "the camera sees no surface, only what is behind all",
        _ => "all that the camera sees shines alike",
    };
    let is_picture = picture.pixels.len() > 1;
    is_picture.then(|| format!("every pixel has the same value: {reason}"))
}

/// Returns the reason for a black picture.
fn darkness(scene: &Scene, view: &View, settings: &Settings) -> String {
    let lights = scene.lights();
    let context = scene.light_context();
    if lights.is_empty() {
        return "the scene has no light".into();
    }
    if lights.iter().all(|light| light.power(&context) <= 0.0) {
        return "the lights of the scene have no power".into();
    }
    let film = view.film();
    if film.exposure <= f32::MIN_POSITIVE {
        return format!("the exposure of the film is {:e}", film.exposure);
    }
    let path = &settings.path;
    if path.strategies.to_string() != Strategies::default().to_string() {
        return format!("the strategies `{}` find no light here", path.strategies);
    }
    let spots = blind_spots(scene, view, settings.integrator);
    let missed = spots.iter().find(|spot| spot.is_missing());
    if path.max_depth == Some(0) {
        return "with at most 0 scattering events only lights are seen, and none is in view".into();
    }
    let sight = Sight::of(scene, view);
    let has_sky = lights.iter().any(Light::is_infinite);
    if sight.hits == 0 && !has_sky {
        let part = if is_cropped(film) {
            "no surface is in the part of the film that is rendered"
        } else {
            "the camera sees no surface"
        };
        return format!("{part}, and no light comes from infinity");
    }
    if sight.hits > 0 && sight.backs == sight.hits {
        return "the camera sees surfaces from behind only: it may stand in a solid, or outside a room".into();
    }
    if let Some(spot) = missed {
        return format!("`{}` misses {}", settings.integrator, spot.description());
    }
    match path.max_depth {
        Some(depth) => format!(
            "no light reaches what the camera sees within {depth} scattering events, or nothing reflects it"
        ),
        None => "no light reaches what the camera sees, or nothing reflects it".into(),
    }
}

fn is_cropped(film: &FilmSettings) -> bool {
    [film.crop.width(), film.crop.height()] != film.resolution
}
