//! Engines, and ours among them.

use std::sync::Arc;
use std::time::Instant;

use bidir_accel::{BuildOptions, Bvh, Instance, Isa, Primitive, Ray, accept_all};

use crate::rays::{Question, TOGETHER};
use crate::scenes::{Mesh, Scene};

/// Something that answers rays.
pub(crate) trait Engine: Sync {
    /// The number of rays that hit anything. For [`Question::Closest`] the hit must be found, not only
    /// that there is one.
    fn count_hits(&self, question: Question, rays: &[Ray]) -> usize;

    /// Bytes of memory, if the engine reports them.
    fn bytes(&self) -> usize;

    /// Seconds that building took.
    fn build_seconds(&self) -> f64;
}

/// The tree of this crate, for one instruction set.
#[derive(Clone)]
pub(crate) struct Ours {
    bvh: Arc<Bvh>,
    seconds: f64,
}

impl Ours {
    pub(crate) fn build(scene: &Scene) -> Self {
        let options = BuildOptions::default();
        let own = primitives(&scene.mesh);
        let object = scene.object.as_ref().map(|(mesh, maps)| {
            let instance = |map| Instance {
                object: 0,
                world_from_object: map,
            };
            let instances: Vec<_> = maps.iter().copied().map(instance).collect();
            (primitives(mesh), instances)
        });
        let begin = Instant::now();
        let bvh = match &object {
            None => Bvh::build(&own, &options).expect("finite"),
            Some((object, instances)) => {
                let object = Bvh::build(object, &options).expect("finite");
                Bvh::with_instances(&own[..], vec![Arc::new(object)], instances, &options)
                    .expect("invertible")
            }
        };
        let seconds = begin.elapsed().as_secs_f64();
        Self {
            bvh: Arc::new(bvh),
            seconds,
        }
    }

    /// The same tree for each instruction set of the machine, the newest first.
    pub(crate) fn for_each_isa(&self) -> impl Iterator<Item = (Isa, Self)> {
        Isa::supported().rev().map(|isa| {
            let bvh = Bvh::clone(&self.bvh).with_isa(isa).expect("supported");
            let ours = Self {
                bvh: Arc::new(bvh),
                ..*self
            };
            (isa, ours)
        })
    }

    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }
}

impl Engine for Ours {
    fn count_hits(&self, question: Question, rays: &[Ray]) -> usize {
        let each = rays.iter();
        match question {
            Question::Closest => each
                .filter(|ray| self.bvh.closest(ray, accept_all).is_some())
                .count(),
            Question::Occluded => each.filter(|ray| self.bvh.is_blocked(ray)).count(),
            Question::Together => {
                let mut blocked = Vec::new();
                let mut of_call = |rays| {
                    self.bvh.are_blocked(rays, &mut blocked);
                    blocked.iter().filter(|&&is_blocked| is_blocked).count()
                };
                rays.chunks(TOGETHER).map(&mut of_call).sum()
            }
        }
    }

    fn bytes(&self) -> usize {
        self.bvh.memory_bytes()
    }

    fn build_seconds(&self) -> f64 {
        self.seconds
    }
}

fn primitives(mesh: &Mesh) -> Vec<Primitive> {
    let triangle = |face| Primitive::Triangle(mesh.triangle(face));
    (0..mesh.faces.len()).map(triangle).collect()
}
