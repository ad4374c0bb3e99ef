//! The volumes of a scene: fills closed meshes, makes open ones thin, and turns meshes that are inside out.

use super::enclosure::{self, Findings};
use super::{Context, Document, placing};
use bidir::math::Vec3;
use bidir::medium::MediumSides;
use bidir::scene::{MaterialId, SceneBuilder, Volume};
use bidir::shape::{Mesh, Shape};
use std::collections::BTreeMap;

const INSIDE_OUT: &str = "a mesh with a volume is inside out: it is turned";

/// Maximum number of closed volumes that an inside-out mesh is compared with, to find out whose cavity it is.
const MOST_CAVITIES: usize = 1024;

/// The contents of the volumes that the shapes of a material bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Content {
    pub(crate) volume: Volume,
    /// The material of shapes that do not enclose a volume. None: they keep theirs.
    pub(crate) thin: Option<MaterialId>,
    /// The warning for shapes that do not enclose a volume.
    pub(crate) warning: &'static str,
}

/// The space of shapes: the world, or an object by number.
pub(super) type Space = Option<usize>;

/// Shapes that may bound a volume together.
#[derive(Clone, Debug)]
struct Draft {
    content: Content,
    /// The material of its shapes.
    material: MaterialId,
    space: Space,
    /// The number of the family. Drafts of one family may close each other's openings.
    family: usize,
    shapes: Vec<usize>,
}

/// A volume, and the lowest and highest corner of its bounding box.
type Boxed = (Draft, [Vec3; 2]);

/// The volumes of a scene under construction.
#[derive(Debug, Default)]
pub(super) struct Volumes {
    drafts: Vec<Draft>,
    numbers: BTreeMap<(usize, Space, MaterialId), usize>,
}

/// The tools to settle volumes.
struct Settling<'a, 'b, 'c, D: Document> {
    builder: &'a mut SceneBuilder,
    context: &'a mut Context<'b, D>,
    /// The place of each shape in the file, for warnings.
    places: &'c [D::Place],
}

impl Volumes {
    /// Adds a shape whose material fills the volume that the shape bounds.
    pub(super) fn add(
        &mut self,
        shape: usize,
        material: MaterialId,
        content: Content,
        family: usize,
        space: Space,
    ) {
        let next = self.drafts.len();
        let number = *self
            .numbers
            .entry((family, space, material))
            .or_insert(next);
        if number == next {
            self.drafts.push(Draft {
                content,
                material,
                space,
                family,
                shapes: Vec::new(),
            });
        }
        self.drafts[number].shapes.push(shape);
    }

    /// Fills the volumes that the shapes enclose. Makes open shapes thin, and turns those that are inside out.
    pub(super) fn settle<D: Document>(
        self,
        builder: &mut SceneBuilder,
        context: &mut Context<'_, D>,
        places: &[D::Place],
    ) {
        let mut settling = Settling {
            builder,
            context,
            places,
        };
        let mut inside_out = Vec::new();
        let mut closed = Vec::new();
        for draft in settling.join_families(self.drafts) {
            let findings = settling.findings(&draft);
            if findings.is_inside_out {
                inside_out.push(draft);
                continue;
            }
            settling.turn(&draft, &findings);
            let mut is_open = findings.open.iter();
            let (open, shapes) = (draft.shapes.iter()).partition(|_| is_open.next() == Some(&true));
            settling.make_thin(&draft, open);
            let draft = Draft { shapes, ..draft };
            let corners = settling.corners(&draft);
            closed.push((draft, corners));
        }
        for draft in inside_out {
            settling.settle_inside_out(draft, &mut closed);
        }
        for (draft, _) in closed.iter().filter(|(draft, _)| !draft.shapes.is_empty()) {
            settling.turn_normals(draft);
            let volume = draft.content.volume;
            settling.builder.enclose(&draft.shapes, volume);
        }
    }
}

impl<D: Document> Settling<'_, '_, '_, D> {
    fn findings(&self, draft: &Draft) -> Findings {
        let shapes = draft
            .shapes
            .iter()
            .map(|&shape| self.builder.shape_of(shape));
        let empty = Mesh::default();
        let meshes: Vec<&Mesh> = (shapes.clone())
            .map(|shape| match shape {
                Shape::Mesh(mesh) => mesh,
                Shape::Sphere(_) | Shape::Disk(_) | Shape::Cylinder(_) => &empty,
            })
            .collect();
        let mut findings = Findings::of(&meshes);
        let all: f64 = shapes.clone().map(Shape::enclosed).sum();
        for (open, shape) in findings.open.iter_mut().zip(shapes) {
            // A sphere that looks inwards is a cavity.
            let is_ball = matches!(shape, Shape::Sphere(sphere) if sphere.is_whole());
            *open &= !is_ball || all <= 0.0;
        }
        findings
    }

    /// Joins the open drafts of a family to one, if they enclose a volume together.
    fn join_families(&self, mut drafts: Vec<Draft>) -> Vec<Draft> {
        drafts.sort_by_key(|draft| (draft.family, draft.space));
        let mut joined: Vec<Draft> = Vec::new();
        for family in drafts.chunk_by(|a, b| (a.family, a.space) == (b.family, b.space)) {
            let (mut open, closed): (Vec<_>, Vec<_>) = family
                .iter()
                .cloned()
                .partition(|draft| family.len() > 1 && !self.findings(draft).is_closed());
            joined.extend(closed);
            if open.len() > 1 {
                let shapes = open.iter().flat_map(|draft| draft.shapes.iter().copied());
                let whole = Draft {
                    shapes: shapes.collect(),
                    ..open[0].clone()
                };
                if self.findings(&whole).is_closed() {
                    open = vec![whole];
                }
            }
            joined.extend(open);
        }
        joined
    }

    fn turn(&mut self, draft: &Draft, findings: &Findings) {
        for (&shape, faces) in draft.shapes.iter().zip(&findings.turned) {
            let Shape::Mesh(mesh) = self.builder.shape_mut(shape) else {
                continue;
            };
            enclosure::turn(mesh, faces);
            if !faces.is_empty() && mesh.normals.is_empty() {
                self.context.warn(self.places[shape].clone(), INSIDE_OUT);
            }
        }
    }

    fn turn_normals(&mut self, draft: &Draft) {
        for &shape in &draft.shapes {
            if let Shape::Mesh(mesh) = self.builder.shape_mut(shape)
                && enclosure::turn_normals(mesh) > 0
            {
                self.context.warn(self.places[shape].clone(), INSIDE_OUT);
            }
        }
    }

    fn make_thin(&mut self, draft: &Draft, shapes: Vec<usize>) {
        for shape in shapes {
            let Content { thin, warning, .. } = draft.content;
            self.context.warn(self.places[shape].clone(), warning);
            if let Some(thin) = thin {
                self.builder.dress(shape, thin);
                self.builder.sides(shape, MediumSides::VACUUM);
            }
        }
    }

    /// Adds an inside-out mesh as a cavity to a closed volume of the same contents around it, or else turns it.
    fn settle_inside_out(&mut self, draft: Draft, closed: &mut Vec<Boxed>) {
        let own = self.corners(&draft);
        let is_like =
            |other: &Draft| other.material == draft.material && other.content == draft.content;
        let is_around = |(other, of): &&mut Boxed| {
            let is_within = of[0].cmple(own[0]).all() && of[1].cmpge(own[1]).all();
            is_within && is_like(other) && other.space == draft.space
        };
        if let Some((around, _)) = closed.iter_mut().take(MOST_CAVITIES).find(is_around) {
            around.shapes.extend(draft.shapes);
            return;
        }
        // Nobody knows which places of two objects belong together.
        let is_elsewhere = |(other, _): &Boxed| is_like(other) && other.space.is_some();
        if draft.space.is_some() && closed.iter().take(MOST_CAVITIES).any(is_elsewhere) {
            return;
        }
        for &shape in &draft.shapes {
            if let Shape::Mesh(mesh) = self.builder.shape_mut(shape) {
                mesh.orientation = placing::opposite(mesh.orientation);
                if mesh.normals.is_empty() {
                    self.context.warn(self.places[shape].clone(), INSIDE_OUT);
                }
            }
        }
        closed.push((draft, own));
    }

    /// Returns the lowest and highest corner of the bounding box of a draft.
    fn corners(&self, draft: &Draft) -> [Vec3; 2] {
        let nowhere = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let shapes = draft
            .shapes
            .iter()
            .map(|&shape| self.builder.shape_of(shape));
        shapes.fold(nowhere, |[low, high], shape| {
            let [from, to] = shape.corners();
            [low.min(from), high.max(to)]
        })
    }
}
