//! A view of a scene: the camera that sees it and the film that keeps what it sees. Scene and view do not
//! know each other, so that one scene serves many views.

use crate::camera::Camera;
use crate::film::FilmSettings;
use crate::math::Vec3;
use thiserror::Error;

/// The textures that are averaged over the footprint of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureFiltering {
    /// The textures that ask for it.
    #[default]
    AsAsked,
    /// No texture: a pixel's samples average them.
    Disabled,
}

/// The part of a pixel that textures are averaged over: its samples and its filter average too, and
/// pbrt-v4 takes as much where a pixel has four samples.
const FILTERED_PART: f32 = 0.5;

/// The part of the film that is rendered is empty or outside it.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the crop is empty or outside of the film")]
pub struct EmptyCrop;

/// A camera and its film.
#[derive(Clone, Debug)]
pub struct View {
    camera: Camera,
    film: FilmSettings,
    filtering: TextureFiltering,
}

impl View {
    /// Makes a view that filters those textures that ask for it.
    ///
    /// Errors: the film's crop is empty or outside of it.
    pub fn new(camera: Camera, film: FilmSettings) -> Result<Self, EmptyCrop> {
        let [width, height] = film.resolution;
        let is_inside = film.crop.max[0] <= width && film.crop.max[1] <= height;
        if !is_inside || film.crop.area() == 0 {
            return Err(EmptyCrop);
        }
        Ok(Self {
            camera,
            film,
            filtering: TextureFiltering::default(),
        })
    }

    /// Takes another filtering of textures.
    #[must_use]
    pub fn with_filtering(self, filtering: TextureFiltering) -> Self {
        Self { filtering, ..self }
    }

    /// Takes another camera and another film.
    ///
    /// Errors: the film's crop is empty or outside of it.
    pub fn moved(&self, camera: Camera, film: FilmSettings) -> Result<Self, EmptyCrop> {
        Ok(Self::new(camera, film)?.with_filtering(self.filtering))
    }

    /// Returns the camera, in the space of the scene.
    #[inline]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the film's geometry, filter and exposure.
    #[inline]
    pub fn film(&self) -> &FilmSettings {
        &self.film
    }

    /// Returns the width that textures are averaged over at the point `p`: a function of the point and the view,
    /// however a path came there. Unit: m.
    #[inline]
    pub fn footprint(&self, p: Vec3) -> f32 {
        match self.filtering {
            TextureFiltering::AsAsked => FILTERED_PART * self.camera.pixel_width(p),
            TextureFiltering::Disabled => 0.0,
        }
    }
}
