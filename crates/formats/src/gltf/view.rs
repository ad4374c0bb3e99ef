//! The camera and the film: those of the file, or a view of all that is there.

use super::document::{Context, Document};
use super::json::Perspective as Described;
use super::node::Nodes;
use super::place::{GltfFault, Place};
use crate::error::ErrorKind;
use crate::pbrt::{Crop, LARGEST_SIDE};
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::film::{FilmSettings, Filter, FilterKind};
use bidir::math::{Affine3A, Vec2, Vec3};
use glam::{DAffine3, DVec3};

/// Rows of the film where nothing says how many.
const HEIGHT: u32 = 720;
/// Columns where no camera says its proportions.
const WIDTH: u32 = 1280;
/// The vertical angle of the view where no camera says one. Unit: radians.
const ANGLE: f64 = 40.0 * std::f64::consts::PI / 180.0;

/// What is looked from.
pub(super) struct View {
    /// x right, y up, z forward. None: so that all is in view.
    world_from_camera: Option<Affine3A>,
    /// The whole vertical angle. Unit: radians.
    yfov: f64,
    /// Width over height of what has to be in view. None: as the film is.
    aspect: Option<f64>,
    place: Place,
}

/// Finds the first camera of the scene that is supported.
pub(super) fn find(
    context: &mut Context<'_>,
    document: &Document,
    nodes: &Nodes,
) -> Result<View, GltfFault> {
    let cameras: Vec<(usize, usize)> = nodes
        .order
        .iter()
        .filter_map(|&node| Some((node, document.root.nodes[node].camera?)))
        .collect();
    let Some(&(node, camera)) = cameras.first() else {
        context.warn(
            &Place::TOP,
            "the scene has no camera: one looks at all of it from its front",
        );
        return Ok(View {
            world_from_camera: None,
            yfov: ANGLE,
            aspect: None,
            place: Place::TOP,
        });
    };
    if cameras.len() > 1 {
        let message = format!(
            "the scene has {} cameras, of which the first is used",
            cameras.len()
        );
        context.warn(&Place::of("nodes", node), message);
    }
    let world_from_node = nodes.world_from_node[node].unwrap_or(DAffine3::IDENTITY);
    read(context, document, camera, &world_from_node)
}

fn read(
    context: &mut Context<'_>,
    document: &Document,
    index: usize,
    world_from_node: &DAffine3,
) -> Result<View, GltfFault> {
    let place = Place::of("cameras", index);
    let count = document.root.cameras.len();
    let missing = || place.scene(format!("there is no camera {index}: the file has {count}"));
    let camera = document.root.cameras.get(index).ok_or_else(missing)?;
    let stand_in = Described {
        aspect_ratio: camera
            .orthographic
            .as_ref()
            .map(|camera| camera.xmag / camera.ymag),
        yfov: ANGLE,
    };
    let perspective = match (camera.kind.as_str(), &camera.perspective) {
        ("perspective", Some(perspective)) => perspective,
        ("orthographic", _) => {
            context.unsupported(
                &place,
                "the orthographic camera",
                "a perspective one stands in",
            )?;
            &stand_in
        }
        ("perspective", None) => return Err(place.scene("`perspective` is missing")),
        (other, _) => {
            let fault = place
                .key("type")
                .scene(format!("unknown type of camera `{other}`"));
            return Err(fault.with_nearest(other, ["perspective", "orthographic"]));
        }
    };
    let (yfov, aspect) = (perspective.yfov, perspective.aspect_ratio);
    if !(yfov > 1e-4 && yfov < 3.1) {
        return Err(place
            .key("perspective")
            .scene(format!("`yfov` of {yfov} is no angle of view")));
    }
    if let Some(aspect) = aspect.filter(|aspect| !(*aspect > 1e-3 && *aspect < 1e3)) {
        return Err(place
            .key("perspective")
            .scene(format!("`aspectRatio` of {aspect} is no ratio")));
    }
    Ok(View {
        world_from_camera: Some(rigid(world_from_node)),
        yfov,
        aspect,
        place,
    })
}

/// The place of a camera that looks along -z of its node, whose scale does not matter.
fn rigid(world_from_node: &DAffine3) -> Affine3A {
    let m = world_from_node.matrix3;
    let forward = (-m.z_axis).normalize_or(DVec3::NEG_Z);
    let up = m.y_axis.reject_from_normalized(forward);
    let up = up
        .try_normalize()
        .unwrap_or_else(|| forward.any_orthonormal_vector());
    looking(world_from_node.translation, forward, up)
}

fn looking(eye: DVec3, forward: DVec3, up: DVec3) -> Affine3A {
    let right = forward.cross(up);
    let columns = [right, up, forward, eye].map(DVec3::as_vec3a);
    Affine3A::from_cols(columns[0], columns[1], columns[2], columns[3])
}

impl View {
    /// The film: as large as the caller says, else of the camera's proportions.
    pub(super) fn film(&self, context: &Context<'_>) -> Result<FilmSettings, GltfFault> {
        let own = match self.aspect {
            None => [WIDTH, HEIGHT],
            Some(aspect) => [
                (f64::from(HEIGHT) * aspect).round().clamp(1.0, 8192.0) as u32,
                HEIGHT,
            ],
        };
        let [width, height] = context.options.resolution.unwrap_or(own);
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            let message = format!("a film of {width} × {height} pixels is empty or too large");
            return Err(self.place.fault(ErrorKind::Limit, message));
        }
        let filter = Filter::new(FilterKind::Gaussian { sigma: 0.5 }, Vec2::splat(1.5));
        let mut film = FilmSettings::new([width, height], filter);
        if let Some(crop) = context.options.crop {
            film.crop = Crop::pixels(crop, [width, height]);
        }
        if film.crop.area() > 0 {
            return Ok(film);
        }
        let message =
            format!("the crop asked for has no pixels of this film of {width} × {height}");
        Err(Place::TOP.fault(ErrorKind::Options, message))
    }

    /// The camera in front of a film of `resolution`. What the file's camera sees is in view
    /// whatever the film's shape; nothing is stretched.
    pub(super) fn camera(
        &self,
        resolution: [u32; 2],
        corners: [Vec3; 2],
    ) -> Result<Camera, GltfFault> {
        let [width, height] = resolution.map(f64::from);
        let mut half = libm::tan(self.yfov / 2.0);
        if let Some(aspect) = self.aspect {
            half *= (aspect * height / width).max(1.0);
        }
        let half = DVec3::new(half * width / height, half, 0.0);
        let placed = self.world_from_camera;
        let [x, y] = [half.x as f32, half.y as f32];
        let settings = PerspectiveSettings {
            world_from_camera: placed.unwrap_or_else(|| in_front(corners, half)),
            resolution: Vec2::new(width as f32, height as f32),
            screen: [Vec2::new(-x, y), Vec2::new(x, -y)],
            lens_radius: 0.0,
            focal_distance: 1e6,
        };
        let camera = Perspective::new(&settings).map(Camera::Perspective);
        camera.ok_or_else(|| self.place.scene("the camera's place is not finite"))
    }
}

/// A place on the side of +z from which a box between two corners fills a view of half size `half`
/// at distance 1.
fn in_front(corners: [Vec3; 2], half: DVec3) -> Affine3A {
    let [low, high] = corners.map(Vec3::as_dvec3);
    let (centre, size) = if low.cmple(high).all() {
        ((low + high) / 2.0, (high - low) / 2.0)
    } else {
        (DVec3::ZERO, DVec3::ONE)
    };
    let distance = (size.x / half.x).max(size.y / half.y) * 1.05 + size.z;
    let eye = centre + DVec3::Z * distance.max(1e-6);
    looking(eye, DVec3::NEG_Z, DVec3::Y)
}
