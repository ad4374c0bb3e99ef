//! The crate obvhs: its eight-wide tree `CwBvh`, whose traversal by vectors of four is its fastest here,
//! with `RtTriangle`, its triangle for processors.

use std::hint::black_box;
use std::time::{Duration, Instant};

use bidir_accel::{Isa, Ray};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;

use crate::ours::Engine;
use crate::rays::Question;
use crate::scenes::{Mesh, Scene};
use crate::table::Column;

/// Names and settings to build by: that of obvhs's examples, meant to take as long as Embree, and that of
/// its best trees.
const PRESETS: [(&str, BvhBuildParams); 2] = [
    ("medium", BvhBuildParams::medium_build()),
    ("very slow", BvhBuildParams::very_slow_build()),
];

/// The instructions that obvhs was compiled for: it does not choose when it runs.
const ISA: Isa = if cfg!(target_feature = "avx512vl") {
    Isa::Avx512
} else if cfg!(target_feature = "avx2") {
    Isa::Avx2
} else if cfg!(target_feature = "sse2") {
    Isa::Sse2
} else {
    Isa::Scalar
};

/// A tree by each preset. `Err` where there are instances.
pub(crate) fn columns(scene: &Scene) -> Result<Vec<Column<'static>>, &'static str> {
    if scene.object.is_some() {
        return Err("obvhs's traversal of two levels does not take rays to an object's space");
    }
    let column = |(preset, settings)| {
        let built = CwBvhScene::build(&scene.mesh, settings);
        Column::new(&format!("obvhs {preset}"), ISA, built)
    };
    Ok(PRESETS.map(column).into())
}

/// A tree with its triangles.
struct CwBvhScene {
    tree: CwBvh,
    /// In the order of the tree's leaves; a triangle that has been split occurs more than once.
    triangles: Vec<RtTriangle>,
    seconds: f64,
}

impl CwBvhScene {
    fn build(mesh: &Mesh, settings: BvhBuildParams) -> Self {
        let triangle = |face| {
            let [v0, v1, v2] = mesh.triangle(face).map(Into::into);
            Triangle { v0, v1, v2 }
        };
        let given: Vec<_> = (0..mesh.faces.len()).map(triangle).collect();
        let begin = Instant::now();
        let tree = build_cwbvh_from_tris(&given, settings, &mut Duration::default());
        let in_leaf = |&i: &u32| RtTriangle::from(&given[i as usize]);
        let triangles = tree.primitive_indices.iter().map(in_leaf).collect();
        let seconds = begin.elapsed().as_secs_f64();
        Self {
            tree,
            triangles,
            seconds,
        }
    }

    /// Finds the hit of the ray. True if there is one.
    fn intersect(&self, ray: ObvhsRay) -> bool {
        let mut hit = RayHit::none();
        let distance = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
        let is_hit = self.tree.ray_traverse(ray, &mut hit, distance);
        if is_hit {
            let i = hit.primitive_id as usize;
            let uv = self.triangles[i].compute_barycentric(&ray);
            black_box((hit.t, uv, self.tree.primitive_indices[i]));
        }
        is_hit
    }

    /// True if anything is in the way.
    fn occluded(&self, ray: ObvhsRay) -> bool {
        let distance = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
        !self.tree.ray_traverse_miss(ray, distance)
    }
}

impl Engine for CwBvhScene {
    fn count_hits(&self, question: Question, rays: &[Ray]) -> usize {
        let hits = |ray: &&Ray| {
            let [origin, direction] = [ray.origin, ray.direction].map(Into::into);
            let ray = ObvhsRay::new(origin, direction, ray.t_min, ray.t_max);
            match question {
                Question::Closest => self.intersect(ray),
                Question::Occluded | Question::Together => self.occluded(ray),
            }
        };
        rays.iter().filter(hits).count()
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.tree.nodes[..])
            + size_of_val(&self.tree.primitive_indices[..])
            + size_of_val(&self.triangles[..])
    }

    fn build_seconds(&self) -> f64 {
        self.seconds
    }
}
