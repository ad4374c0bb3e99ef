//! The vertices of a sample, in the scene and on the film.

use bidir::camera::{Camera, LensSample};
use bidir::driver::Session;
use bidir::locus::Locus;
use bidir::math::{Vec2, Vec3};
use bidir::path::{Scattering, Subpath, Vertex};
use bidir::scene::RenderSpace;
use bidir::spectrum::{Lanes, Rgb};
use serde::Serialize;

#[derive(Clone, Debug, Serialize)]
pub(super) struct SubpathReport {
    pub(super) vertices: Vec<VertexReport>,
    /// The direction in which the walk left the scene.
    pub(super) escape: Option<[f32; 3]>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct VertexReport {
    pub(super) kind: &'static str,
    #[serde(flatten)]
    pub(super) place: Place,
    pub(super) normal: [f32; 3],
    pub(super) is_delta: bool,
    pub(super) light: Option<u32>,
    pub(super) beta: Rgb,
    pub(super) pdf_fwd: f32,
    pub(super) pdf_rev: f32,
}

/// A point or a direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Place {
    /// In the space of the scene's numbers, which drawings are made in.
    #[serde(skip)]
    point: Vec3,
    /// In the world. The direction towards it where it is at infinity.
    pub(super) position: [f32; 3],
    pub(super) is_infinite: bool,
    /// Its image on the film through the sample's lens point, or beyond the edges, whatever is in between.
    /// None: it is behind the camera, or the camera itself. Unit: pixels, from the top left.
    pub(super) raster: Option<[f32; 2]>,
}

impl Place {
    /// The camera in a drawing without a camera subpath.
    pub(super) fn eye(camera: &Camera) -> Self {
        let lens = middle_of_lens(camera);
        Self {
            is_infinite: lens.locus.is_infinite(),
            ..Self::finite(lens.locus.point)
        }
    }

    /// A point that is on no film.
    pub(super) fn finite(point: Vec3) -> Self {
        Self {
            point,
            position: point.to_array(),
            is_infinite: false,
            raster: None,
        }
    }

    /// The point, or the direction.
    pub(super) fn point(&self) -> Vec3 {
        self.point
    }
}

fn middle_of_lens(camera: &Camera) -> LensSample {
    camera.sample_lens(|| Vec2::splat(0.5))
}

/// The lens point of a sample.
pub(super) struct View<'a> {
    space: RenderSpace,
    camera: &'a Camera,
    lens: Locus,
}

impl<'a> View<'a> {
    /// From the lens point of `subpath`, so that what its ray hits lies in its pixel; without a
    /// camera subpath, from the middle of the lens.
    pub(super) fn new(session: &'a Session<'_>, subpath: &Subpath<'_>) -> Self {
        let camera = session.view().camera();
        let middle = || middle_of_lens(camera).locus;
        Self {
            space: *session.scene().space(),
            camera,
            lens: subpath.vertices.first().map_or_else(middle, |y0| y0.locus),
        }
    }

    pub(super) fn end(&self, end: &Locus) -> Place {
        self.place(end.point, end.is_infinite())
    }

    fn place(&self, point: Vec3, is_infinite: bool) -> Place {
        let raster = self.raster(point, is_infinite);
        let position = if is_infinite {
            point
        } else {
            self.space.world_point(point).as_vec3()
        };
        Place {
            point,
            position: position.to_array(),
            is_infinite,
            raster: raster.filter(|p| p.is_finite()).map(|p| p.to_array()),
        }
    }

    fn raster(&self, point: Vec3, is_infinite: bool) -> Option<Vec2> {
        match (self.lens.is_infinite(), is_infinite) {
            // Rays of one direction see no other direction.
            (true, true) => None,
            (true, false) => self.camera.raster(point, -self.lens.point),
            (false, true) => self.camera.raster(self.lens.point, point),
            (false, false) => {
                let direction = (point - self.lens.point).try_normalize()?;
                self.camera.raster(self.lens.point, direction)
            }
        }
    }
}

impl SubpathReport {
    pub(super) fn new(lanes: Lanes, view: &View<'_>, subpath: &Subpath<'_>) -> Self {
        let vertices = subpath
            .vertices
            .iter()
            .map(|vertex| VertexReport::new(lanes, view, vertex));
        Self {
            vertices: vertices.collect(),
            escape: subpath.escape.map(|escape| escape.direction.to_array()),
        }
    }
}

impl VertexReport {
    fn new(lanes: Lanes, view: &View<'_>, vertex: &Vertex) -> Self {
        let kind = match vertex.scattering {
            Scattering::Camera => "camera",
            Scattering::Light => "light",
            Scattering::Surface(_) => "surface",
            Scattering::Medium(_) => "medium",
        };
        Self {
            kind,
            place: view.end(&vertex.locus),
            normal: vertex.locus.n_g.to_array(),
            is_delta: vertex.is_delta() || vertex.went_by_delta,
            light: vertex.light,
            beta: lanes.to_rgb(vertex.beta),
            pdf_fwd: vertex.pdf_fwd,
            pdf_rev: vertex.pdf_rev,
        }
    }
}
