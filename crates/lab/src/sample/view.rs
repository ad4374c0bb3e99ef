//! The vertices and terms of a sample, in the world, on the film, and in RGB.

use super::report::{Choice, RayReport, SubpathReport, TermReport, VertexReport};
use bidir::camera::Camera;
use bidir::driver::{Replay, ReplayedTerm, Session};
use bidir::integrator::Fate;
use bidir::locus::Locus;
use bidir::math::{Vec2, Vec3};
use bidir::path::{Scattering, Subpath, Vertex};
use bidir::scene::RenderSpace;
use bidir::spectrum::Lanes;
use serde::Serialize;

/// A point or a direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Place {
    /// The point, or the direction towards it. Space: render, in which drawings are made.
    #[serde(skip)]
    pub(super) point: Vec3,
    /// The point, or if it is at infinity, the direction towards it. Space: world.
    pub(super) position: [f32; 3],
    pub(super) is_infinite: bool,
    /// The raster position of the point through the sample's lens point, without visibility; it may be outside
    /// the film. None: the point is behind the camera, or is the lens point. Unit: pixels, from the top left.
    pub(super) raster: Option<[f32; 2]>,
}

/// The lens point of a sample, from which its points are projected onto the film.
pub(super) struct View<'a> {
    lanes: Lanes,
    space: RenderSpace,
    camera: &'a Camera,
    lens: Locus,
}

impl<'a> View<'a> {
    /// Returns the view from the lens point of the camera subpath, so that the surface its ray hits is in its
    /// pixel. Without a camera subpath, returns the view from the middle of the lens.
    pub(super) fn new(session: &'a Session<'_>, replay: &Replay) -> Self {
        let camera = session.view().camera();
        let middle = || camera.sample_lens(|| Vec2::splat(0.5)).locus;
        Self {
            lanes: replay.lanes,
            space: *session.scene().space(),
            camera,
            lens: replay
                .camera()
                .vertices
                .first()
                .map_or_else(middle, |y0| y0.locus),
        }
    }

    pub(super) fn eye(&self) -> Place {
        self.place(&self.lens)
    }

    fn place(&self, locus: &Locus) -> Place {
        let (point, is_infinite) = (locus.point, locus.is_infinite());
        let in_world = || self.space.world_point(point).as_vec3();
        let raster = self.raster(point, is_infinite).filter(|p| p.is_finite());
        Place {
            point,
            position: if is_infinite { point } else { in_world() }.to_array(),
            is_infinite,
            raster: raster.map(|p| p.to_array()),
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

    pub(super) fn subpath(&self, subpath: &Subpath<'_>) -> SubpathReport {
        SubpathReport {
            vertices: subpath
                .vertices
                .iter()
                .map(|vertex| self.vertex(vertex))
                .collect(),
            escape: subpath.escape.map(|escape| escape.direction.to_array()),
        }
    }

    fn vertex(&self, vertex: &Vertex) -> VertexReport {
        VertexReport {
            kind: match vertex.scattering {
                Scattering::Camera => "camera",
                Scattering::Light => "light",
                Scattering::Surface(_) => "surface",
                Scattering::Medium(_) => "medium",
            },
            place: self.place(&vertex.locus),
            normal: vertex.locus.n_g.to_array(),
            is_delta: vertex.is_delta() || vertex.went_by_delta,
            light: vertex.light,
            beta: self.lanes.to_rgb(vertex.beta),
            pdf_fwd: vertex.pdf_fwd,
            pdf_rev: vertex.pdf_rev,
        }
    }

    pub(super) fn term(&self, replayed: &ReplayedTerm) -> TermReport {
        let term = &replayed.term;
        TermReport {
            s: term.strategy.s,
            t: term.strategy.t,
            contribution: self.lanes.to_rgb(term.contribution),
            weight: term.weight,
            value: self.lanes.to_rgb(term.value()),
            is_dropped: replayed.fate == Fate::Dropped,
            added: self.lanes.to_rgb(replayed.added),
            ray: replayed.ends.map(|[end, _]| self.ray(replayed, &end)),
        }
    }

    /// Reports the shadow ray of a candidate or a splat.
    fn ray(&self, replayed: &ReplayedTerm, light_end: &Locus) -> RayReport {
        let choice = || Choice {
            score: replayed.selection.map(|selection| selection.score),
            // Without a choice everything is traced.
            prob: replayed.selection.map_or(1.0, |selection| selection.prob),
            is_chosen: replayed.is_chosen(),
        };
        RayReport {
            light_end: self.place(light_end),
            choice: replayed.landing.is_none().then(choice),
            is_visible: replayed.is_visible(),
            transmittance: replayed.transmittance,
            landing: replayed.landing,
        }
    }
}
