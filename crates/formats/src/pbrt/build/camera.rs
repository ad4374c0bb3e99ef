//! The camera.

use super::context::Context;
use super::reader::Reader;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::Entity;
use crate::pbrt::transform::Transforms;
use crate::source::{Fault, SourceMap, Span};
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::math::{Affine3A, Vec2};

/// A camera but for the film's size.
pub(super) struct CameraSettings {
    /// Seconds between opening and closing of the shutter.
    pub(super) exposure_time: f32,
    world_from_camera: Affine3A,
    fov: f32,
    aspect: Option<f32>,
    screen_window: Option<[f32; 4]>,
    lens_radius: f32,
    focal_distance: f32,
    pub(super) span: Span,
}

/// Reads the camera; without one it is the format's default.
pub(super) fn read(context: &mut Context<'_>) -> Result<CameraSettings, Fault> {
    let Some(camera) = &context.description.camera else {
        return Ok(CameraSettings::default_at(SourceMap::BEGINNING));
    };
    if camera.transforms.is_animated() {
        context.unsupported(
            camera.entity.span,
            "a moving camera",
            "its first place stands in",
        )?;
    }
    if let Some(medium) = &camera.medium.outside {
        context.unsupported(medium.span, "a participating medium", "vacuum stands in")?;
    }
    let mut reader = Reader::new(&camera.entity);
    let kind = camera.entity.kind.as_str();
    if kind != "perspective" {
        let what = format!("the camera `{kind}`");
        context.unsupported(camera.entity.span, &what, "`perspective` stands in")?;
        let world_from_camera = place(&camera.transforms);
        return Ok(CameraSettings {
            world_from_camera,
            ..CameraSettings::default_at(camera.entity.span)
        });
    }
    let settings = read_perspective(&mut reader, &camera.entity, &camera.transforms)?;
    reader.finish()?;
    Ok(settings)
}

fn place(camera_from_world: &Transforms) -> Affine3A {
    camera_from_world.start.inverse().as_affine3a()
}

fn read_perspective(
    reader: &mut Reader<'_>,
    entity: &Entity,
    transforms: &Transforms,
) -> Result<CameraSettings, Fault> {
    let (open, close) = (
        reader.float("shutteropen", 0.0)?,
        reader.float("shutterclose", 1.0)?,
    );
    if close <= open {
        return Err(Fault::scene(
            entity.span,
            "the shutter closes before it opens",
        ));
    }
    let screen_window = reader.floats(ParameterType::Float, "screenwindow");
    let wrong = |_| Fault::scene(entity.span, "`screenwindow` is left, right, bottom and top");
    let screen_window = screen_window
        .map(|window| window.try_into().map_err(wrong))
        .transpose()?;
    let aspect = reader.float_within("frameaspectratio", 0.0, [0.0, f32::MAX])?;
    Ok(CameraSettings {
        exposure_time: close - open,
        world_from_camera: place(transforms),
        fov: reader.float_within("fov", 90.0, [1e-3, 179.999])?,
        aspect: (aspect > 0.0).then_some(aspect),
        screen_window,
        lens_radius: reader.float_within("lensradius", 0.0, [0.0, f32::MAX])?,
        focal_distance: reader.float_within("focaldistance", 1e6, [f32::MIN_POSITIVE, f32::MAX])?,
        span: entity.span,
    })
}

impl CameraSettings {
    fn default_at(span: Span) -> Self {
        Self {
            exposure_time: 1.0,
            world_from_camera: Affine3A::IDENTITY,
            fov: 90.0,
            aspect: None,
            screen_window: None,
            lens_radius: 0.0,
            focal_distance: 1e6,
            span,
        }
    }

    /// The camera in front of a film of `resolution`, with the view of one of `own_resolution`.
    ///
    /// The angle `fov` spans the screen from -1 to 1; the longer side reaches further.
    pub(super) fn camera(
        &self,
        resolution: [u32; 2],
        own_resolution: [u32; 2],
    ) -> Result<Camera, Fault> {
        let [resolution, own] =
            [resolution, own_resolution].map(|[w, h]| Vec2::new(w as f32, h as f32));
        let aspect = self.aspect.unwrap_or(own.x / own.y);
        let [left, right, bottom, top] = self.screen_window.unwrap_or(if aspect > 1.0 {
            [-aspect, aspect, -1.0, 1.0]
        } else {
            [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect]
        });
        let half = libm::tan(f64::from(self.fov).to_radians() / 2.0) as f32;
        let settings = PerspectiveSettings {
            world_from_camera: self.world_from_camera,
            resolution,
            screen: [Vec2::new(left, top) * half, Vec2::new(right, bottom) * half],
            lens_radius: self.lens_radius,
            focal_distance: self.focal_distance,
        };
        let camera = Perspective::new(&settings);
        camera.map(Camera::Perspective).ok_or_else(|| {
            let message =
                "the camera's screen is empty, or its transformation is sheared or uneven";
            Fault::scene(self.span, message)
        })
    }
}
