//! The camera.

use super::context::Context;
use super::reader::Reader;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::transform::Transforms;
use crate::source::{Fault, SourceMap, Span};
use bidir::camera::{
    Camera, Orthographic, OrthographicSettings, Perspective, PerspectiveSettings, Spherical,
    SphericalMapping,
};
use bidir::math::{Affine3A, Vec2};
use glam::DVec3;

/// A camera without the film's size.
pub(super) struct CameraSettings {
    /// Time between opening and closing of the shutter. Unit: seconds.
    pub(super) exposure_time: f32,
    /// The position. Space: world.
    pub(super) eye: DVec3,
    /// The map from the camera to the render space.
    render_from_camera: Affine3A,
    view: View,
    pub(super) span: Span,
}

/// The projection of a camera.
enum View {
    /// Perspective: the angle `fov` spans the screen from -1 to 1. Unit: degrees.
    Perspective {
        fov: f32,
        screen: Screen,
    },
    /// Orthographic: the screen is in the scene's unit.
    Orthographic(Screen),
    Spherical(SphericalMapping),
}

/// The screen window and the lens.
struct Screen {
    aspect: Option<f32>,
    window: Option<[f32; 4]>,
    lens_radius: f32,
    focal_distance: f32,
}

/// Reads the camera, or returns the format's default.
pub(super) fn read(context: &mut Context<'_>) -> Result<CameraSettings, Fault> {
    let Some(camera) = &context.document.camera else {
        let transforms = Transforms::default();
        return Ok(CameraSettings::default_at(
            SourceMap::BEGINNING,
            context,
            &transforms,
        ));
    };
    if camera.transforms.is_animated() {
        let span = camera.entity.span;
        context.unsupported(span, "a moving camera", "its first position is used")?;
    }
    let span = camera.entity.span;
    let default = CameraSettings::default_at(span, context, &camera.transforms);
    let mut reader = Reader::new(context, &camera.entity);
    let view = match camera.entity.kind.as_str() {
        "perspective" => View::Perspective {
            fov: reader.float_within("fov", 90.0, [1e-3, 179.999])?,
            screen: Screen::read(&mut reader)?,
        },
        "orthographic" => View::Orthographic(Screen::read(&mut reader)?),
        "spherical" => {
            let mappings = [
                ("equalarea", SphericalMapping::EqualArea),
                ("equirectangular", SphericalMapping::Equirectangular),
            ];
            let mapping = reader.choice("mapping", "mapping", &mappings)?;
            // The format allows a screen, which has no effect.
            Screen::read(&mut reader)?;
            View::Spherical(mapping)
        }
        kind => {
            let what = format!("the camera `{kind}`");
            (reader.context).unsupported(span, &what, "`perspective` is used instead")?;
            return Ok(default);
        }
    };
    let exposure_time = exposure_time(&mut reader)?;
    reader.finish()?;
    Ok(CameraSettings {
        exposure_time,
        view,
        ..default
    })
}

fn exposure_time(reader: &mut Reader<'_, '_>) -> Result<f32, Fault> {
    let open = reader.float("shutteropen", 0.0)?;
    let close = reader.float("shutterclose", 1.0)?;
    if close > open {
        return Ok(close - open);
    }
    Err(reader.fault("the shutter closes before it opens"))
}

impl Screen {
    fn read(reader: &mut Reader<'_, '_>) -> Result<Self, Fault> {
        let edges = reader.floats(ParameterType::Float, "screenwindow");
        let span = reader.span();
        let wrong = |_| Fault::scene(span, "`screenwindow` needs left, right, bottom and top");
        let window = edges
            .map(|edges| edges.try_into().map_err(wrong))
            .transpose()?;
        let aspect = reader.float_within("frameaspectratio", 0.0, [0.0, f32::MAX])?;
        let near = [f32::MIN_POSITIVE, f32::MAX];
        Ok(Self {
            aspect: (aspect > 0.0).then_some(aspect),
            window,
            lens_radius: reader.float_within("lensradius", 0.0, [0.0, f32::MAX])?,
            focal_distance: reader.float_within("focaldistance", 1e6, near)?,
        })
    }

    /// Returns the top left and bottom right corner for a film of this size.
    fn corners(&self, film: Vec2) -> [Vec2; 2] {
        let aspect = self.aspect.unwrap_or(film.x / film.y);
        let [left, right, bottom, top] = self.window.unwrap_or(if aspect > 1.0 {
            [-aspect, aspect, -1.0, 1.0]
        } else {
            [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect]
        });
        [Vec2::new(left, top), Vec2::new(right, bottom)]
    }
}

impl CameraSettings {
    /// Returns the format's default camera with a transformation.
    fn default_at(span: Span, context: &Context<'_>, camera_from_world: &Transforms) -> Self {
        let world_from_camera = camera_from_world.inverse();
        Self {
            exposure_time: 1.0,
            eye: world_from_camera.start.translation,
            render_from_camera: context.place(&world_from_camera).as_affine3a(),
            view: View::Perspective {
                fov: 90.0,
                screen: Screen {
                    aspect: None,
                    window: None,
                    lens_radius: 0.0,
                    focal_distance: 1e6,
                },
            },
            span,
        }
    }

    /// Returns true if the view is a whole sphere, so that opposite edges of the film meet.
    pub(super) fn sees_all_around(&self) -> bool {
        matches!(self.view, View::Spherical(_))
    }

    /// Returns the camera for a film of `resolution`, with the view that a film of `own_resolution` has.
    pub(super) fn camera(
        &self,
        resolution: [u32; 2],
        own_resolution: [u32; 2],
    ) -> Result<Camera, Fault> {
        let [film, own] = [resolution, own_resolution].map(|[w, h]| Vec2::new(w as f32, h as f32));
        let place = &self.render_from_camera;
        let camera = match &self.view {
            View::Perspective { fov, screen } => {
                let half = libm::tan(f64::from(*fov).to_radians() / 2.0) as f32;
                let corners = screen.corners(own).map(|corner| corner * half);
                self.lens(screen, film, corners)
            }
            // The rays of a film position meet where the parallel ray crosses the plane of focus, as those of a
            // perspective camera whose film, at z = 1, is divided by the focal distance.
            View::Orthographic(screen) if screen.lens_radius > 0.0 => {
                let corners = screen.corners(own);
                self.lens(screen, film, corners.map(|c| c / screen.focal_distance))
            }
            View::Orthographic(screen) => Orthographic::new(&OrthographicSettings {
                world_from_camera: *place,
                resolution: film,
                screen: screen.corners(own),
            })
            .map(Camera::Orthographic),
            View::Spherical(mapping) => {
                Spherical::new(place, film, *mapping).map(Camera::Spherical)
            }
        };
        camera.ok_or_else(|| {
            let message = "the camera's screen is empty, or its transformation is flat";
            Fault::scene(self.span, message)
        })
    }

    /// Returns a lens camera whose film has these corners on the plane z = 1.
    fn lens(&self, screen: &Screen, resolution: Vec2, corners: [Vec2; 2]) -> Option<Camera> {
        let settings = PerspectiveSettings {
            world_from_camera: self.render_from_camera,
            resolution,
            screen: corners,
            lens_radius: screen.lens_radius,
            focal_distance: screen.focal_distance,
        };
        Perspective::new(&settings).map(Camera::Perspective)
    }
}
