//! The camera and the film: those of the file, or a view of the whole scene.

use super::document::{Context, Document};
use super::json;
use super::node::Nodes;
use super::outlook;
use super::outside::Extent;
use super::place::{GltfFault, Place};
use crate::text::number;
use bidir::camera::{Camera, Orthographic, OrthographicSettings, Perspective, PerspectiveSettings};
use bidir::film::{FilmSettings, Filter, FilterKind};
use bidir::math::{Affine3A, Vec2};
use glam::{DAffine3, DVec3};
use std::ops::RangeInclusive;

/// Default number of rows of the film.
const HEIGHT: u32 = 720;
/// Default number of columns of the film, if no camera has an aspect ratio.
const WIDTH: u32 = 1280;
/// Default vertical angle of the view. Unit: radians.
const ANGLE: f64 = 40.0 * std::f64::consts::PI / 180.0;

/// The valid aspect ratios of cameras: width over height.
const RATIOS: RangeInclusive<f64> = 1e-3..=1e3;

/// The projection of a camera, and half the height of its view.
#[derive(Clone, Copy)]
enum Screen {
    /// Perspective, with half the height at distance 1.
    Perspective(f64),
    /// Orthographic, with half the height, which is the same at any distance.
    Orthographic(f64),
}

/// The camera of the file, or the default one.
pub(super) struct View {
    /// The camera's frame: x right, y up, z forward. None: the whole scene is in view.
    world_from_camera: Option<Affine3A>,
    screen: Screen,
    /// Aspect ratio, width over height, of the part that has to be in view. None: the film's aspect ratio.
    aspect: Option<f64>,
    place: Place,
}

/// Finds the first camera of the scene.
pub(super) fn find(context: &mut Context<'_>, nodes: &Nodes) -> Result<View, GltfFault> {
    let document = context.document;
    let camera = |&node: &usize| Some((node, document.root.nodes[node].camera?));
    let cameras: Vec<_> = nodes.order.iter().filter_map(camera).collect();
    let Some(&(node, camera)) = cameras.first() else {
        return Ok(View {
            world_from_camera: None,
            screen: Screen::Perspective(libm::tan(ANGLE / 2.0)),
            aspect: None,
            place: Place::TOP,
        });
    };
    if cameras.len() > 1 {
        let message = format!("the scene has {} cameras; using the first", cameras.len());
        context.warn(Place::of("nodes", node), message);
    }
    let render_from_node = nodes.render_from_node[node].unwrap_or(DAffine3::IDENTITY);
    let mut view = read(document, camera, &render_from_node)?;
    // Only the view of parallel rays has a size in the unit of the scene.
    if let Screen::Orthographic(half) = &mut view.screen {
        *half /= context.layout.space.unit;
    }
    Ok(view)
}

fn read(document: &Document, index: usize, render_from_node: &DAffine3) -> Result<View, GltfFault> {
    let place = Place::of("cameras", index);
    let camera = place.find(&document.root.cameras, index, "camera")?;
    let (screen, aspect) = match (
        camera.kind.as_str(),
        &camera.perspective,
        &camera.orthographic,
    ) {
        ("perspective", Some(camera), _) => perspective(camera, &place.key("perspective"))?,
        ("orthographic", _, Some(camera)) => orthographic(camera, &place.key("orthographic"))?,
        (kind @ ("perspective" | "orthographic"), ..) => {
            return Err(place.scene(format!("`{kind}` is missing")));
        }
        (other, ..) => {
            let fault = place
                .key("type")
                .scene(format!("unknown camera type `{other}`"));
            return Err(fault.with_nearest(other, ["perspective", "orthographic"]));
        }
    };
    Ok(View {
        world_from_camera: Some(rigid(render_from_node)),
        screen,
        aspect,
        place,
    })
}

/// Returns the projection and the aspect ratio of a perspective camera.
fn perspective(
    camera: &json::Perspective,
    place: &Place,
) -> Result<(Screen, Option<f64>), GltfFault> {
    let (yfov, aspect) = (camera.yfov, camera.aspect_ratio);
    if !(yfov > 1e-4 && yfov < 3.1) {
        let yfov = number(yfov);
        return Err(place.scene(format!("`yfov` is {yfov}, which is not an angle of view")));
    }
    if let Some(aspect) = aspect.filter(|aspect| !RATIOS.contains(aspect)) {
        let aspect = number(aspect);
        return Err(place.scene(format!("`aspectRatio` is {aspect}, which is not a ratio")));
    }
    let screen = Screen::Perspective(libm::tan(yfov / 2.0));
    Ok((screen, aspect))
}

/// Returns the projection and the aspect ratio of an orthographic camera.
fn orthographic(
    camera: &json::Orthographic,
    place: &Place,
) -> Result<(Screen, Option<f64>), GltfFault> {
    let (width, height) = (camera.xmag, camera.ymag);
    let is_size = |side: f64| side > 0.0 && side <= 1e12;
    if !(is_size(width) && is_size(height) && RATIOS.contains(&(width / height))) {
        let [width, height] = [width, height].map(number);
        return Err(place.scene(format!(
            "`xmag` {width} and `ymag` {height} are not the size of a view"
        )));
    }
    Ok((Screen::Orthographic(height), Some(width / height)))
}

/// Returns the frame of a camera that looks along -z of its node, without the node's scale.
fn rigid(render_from_node: &DAffine3) -> Affine3A {
    let m = render_from_node.matrix3;
    let forward = (-m.z_axis).normalize_or(DVec3::NEG_Z);
    let upwards = m.y_axis.reject_from_normalized(forward).try_normalize();
    let up = upwards.unwrap_or_else(|| forward.any_orthonormal_vector());
    looking(render_from_node.translation, forward, up)
}

pub(super) fn looking(eye: DVec3, forward: DVec3, up: DVec3) -> Affine3A {
    let right = forward.cross(up);
    let columns = [right, up, forward, eye].map(DVec3::as_vec3a);
    Affine3A::from_cols(columns[0], columns[1], columns[2], columns[3])
}

impl View {
    /// Returns the position of the file's camera in the render space. None: the file has no camera.
    pub(super) fn eye(&self) -> Option<DVec3> {
        let place = self.world_from_camera?;
        Some(place.translation.as_dvec3())
    }

    /// Returns the place in the file that gives the film's size. None: the caller's options give the size.
    pub(super) fn film_place(&self, context: &Context<'_>) -> Option<Place> {
        let is_given = context.options.resolution.is_some();
        (!is_given).then(|| self.place.clone())
    }

    /// Returns the film, in the size of the caller's options, else in the camera's aspect ratio.
    pub(super) fn film(&self, context: &Context<'_>) -> Result<FilmSettings, GltfFault> {
        let own = match self.aspect {
            None => [WIDTH, HEIGHT],
            Some(aspect) => [
                (f64::from(HEIGHT) * aspect).round().clamp(1.0, 8192.0) as u32,
                HEIGHT,
            ],
        };
        let options = context.options;
        let resolution = options.resolution(own, self.place.clone())?;
        let filter = Filter::new(FilterKind::Gaussian { sigma: 0.5 }, Vec2::splat(1.5));
        let mut film = FilmSettings::new(resolution, filter);
        film.crop = options.crop(None, resolution, Place::TOP)?;
        Ok(film)
    }

    /// Returns the frame of the camera: the file's, else one at the viewpoint `inside`, else one with all of
    /// `extent` in view.
    pub(super) fn placed(
        &self,
        context: &mut Context<'_>,
        resolution: [u32; 2],
        extent: &Extent,
        inside: Option<&outlook::Place>,
    ) -> Affine3A {
        if let Some(own) = self.world_from_camera {
            return own;
        }
        if let Some(inside) = inside {
            let message = "the scene has no camera; using one inside it, as it is closed";
            context.warn(Place::TOP, message);
            return inside.camera(&context.layout.render_from_world());
        }
        let viewpoint = extent.viewpoint();
        let name = viewpoint.name;
        let message = format!("the scene has no camera; using one {name} that sees everything");
        context.warn(Place::TOP, message);
        viewpoint.camera(extent, self.half(resolution))
    }

    /// Returns the camera for a film of `resolution`. A film of any aspect ratio contains the view of the file's
    /// camera, and does not stretch it.
    pub(super) fn camera(
        &self,
        resolution: [u32; 2],
        world_from_camera: Affine3A,
    ) -> Result<Camera, GltfFault> {
        let half = self.half(resolution);
        let [x, y] = [half.x as f32, half.y as f32];
        let screen = [Vec2::new(-x, y), Vec2::new(x, -y)];
        let resolution = Vec2::from(resolution.map(|side| side as f32));
        let camera = match self.screen {
            Screen::Perspective(_) => Perspective::new(&PerspectiveSettings {
                world_from_camera,
                resolution,
                screen,
                lens_radius: 0.0,
                focal_distance: 1e6,
            })
            .map(Camera::Perspective),
            Screen::Orthographic(_) => Orthographic::new(&OrthographicSettings {
                world_from_camera,
                resolution,
                screen,
            })
            .map(Camera::Orthographic),
        };
        camera.ok_or_else(|| self.place.scene("the camera's position is not finite"))
    }

    /// Returns half the width and height of the view for a film of `resolution`, at distance 1; z is 0.
    fn half(&self, resolution: [u32; 2]) -> DVec3 {
        let [width, height] = resolution.map(f64::from);
        let (Screen::Perspective(mut half) | Screen::Orthographic(mut half)) = self.screen;
        if let Some(aspect) = self.aspect {
            half *= (aspect * height / width).max(1.0);
        }
        DVec3::new(half * width / height, half, 0.0)
    }
}
