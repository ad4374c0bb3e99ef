//! A view of a scene: a camera and its film. Scene and view do not refer to each other, so that one scene can have
//! many views.

use crate::camera::Camera;
use crate::film::FilmSettings;
use crate::math::Vec3;
use thiserror::Error;

/// The textures that are averaged over the footprint of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureFiltering {
    /// The textures with a filter that asks for it.
    #[default]
    AsAsked,
    /// No texture: a pixel's samples average them.
    Disabled,
}

/// The fraction of a pixel's width that textures are averaged over. It is below 1, because samples and pixel filter
/// average, too; pbrt-v4 uses the same for four samples per pixel.
const FILTERED_PART: f32 = 0.5;

/// The error of a crop that is empty, or outside of the film.
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

    /// Returns the view with another filtering of textures.
    #[must_use]
    pub fn with_filtering(self, filtering: TextureFiltering) -> Self {
        Self { filtering, ..self }
    }

    /// Returns the view with another camera and another film.
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

    /// Returns the width that textures are averaged over at the point `p`. It depends only on the point and the view,
    /// not on the path. Unit: m.
    #[inline]
    pub fn footprint(&self, p: Vec3) -> f32 {
        match self.filtering {
            TextureFiltering::AsAsked => FILTERED_PART * self.camera.pixel_width(p),
            TextureFiltering::Disabled => 0.0,
        }
    }
}
