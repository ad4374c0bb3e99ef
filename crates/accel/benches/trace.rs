//! What rays cost: `cargo bench -p bidir-accel [-- ROUNDS]`. Prints the median over rounds, in
//! nanoseconds per ray. One round suffices to count instructions.

#![allow(clippy::print_stdout, reason = "a benchmark tells what it found")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use bidir_accel::{BuildOptions, Bvh, Hit, Instance, Primitive, Ray, accept_all};
use glam::{DAffine3, DVec3, Vec3};

const RAYS: usize = 20_000;

/// Numbers in [-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

fn soup(count: usize, size: f32) -> Vec<Primitive> {
    let mut random = Random(1);
    let triangle = |_| {
        let at = random.vector();
        Primitive::Triangle([(); 3].map(|()| at + size * random.vector()))
    };
    (0..count).map(triangle).collect()
}

fn rays() -> Vec<Ray> {
    let mut random = Random(2);
    let ray = |_| Ray::new(1.5 * random.vector(), random.vector());
    (0..RAYS).map(ray).collect()
}

/// A tree, and the same with a thousand instances of a smaller one, scattered.
fn scenes() -> [(&'static str, Bvh); 2] {
    let options = BuildOptions::default();
    let flat = Bvh::build(&soup(50_000, 0.03), &options).expect("finite");
    let object = Bvh::build(&soup(10_000, 0.05), &options).expect("finite");
    let mut random = Random(3);
    let instance = |_| Instance {
        object: 0,
        world_from_object: DAffine3::from_scale(DVec3::splat(0.07))
            * DAffine3::from_translation(14.0 * random.vector().as_dvec3()),
    };
    let instances: Vec<_> = (0..1000).map(instance).collect();
    let forest = Bvh::with_instances(&[], vec![Arc::new(object)], &instances, &options);
    [("flat", flat), ("forest", forest.expect("invertible"))]
}

#[inline(never)]
fn measure(name: &str, rounds: usize, rays: &[Ray], trace: impl Fn(&Ray) -> bool) {
    let round = |_| {
        let begin = Instant::now();
        let hits = rays.iter().filter(|ray| trace(black_box(ray))).count();
        black_box(hits);
        begin.elapsed().as_nanos() as f64 / rays.len() as f64
    };
    let mut times: Vec<f64> = (0..rounds).map(round).collect();
    times.sort_by(f64::total_cmp);
    println!("{name:<24} {:8.1} ns", times[rounds / 2]);
}

fn main() {
    // Cargo passes `--bench`.
    let rounds = std::env::args().find_map(|argument| argument.parse().ok());
    let (rounds, rays) = (rounds.unwrap_or(31), rays());
    let partly = |hit: &Hit| hit.u < 0.5;
    for (name, bvh) in scenes() {
        let closest = |ray: &Ray| bvh.closest(ray, accept_all).is_some();
        measure(&format!("{name}, closest"), rounds, &rays, closest);
        let filtered = |ray: &Ray| bvh.closest(ray, partly).is_some();
        measure(
            &format!("{name}, closest, filtered"),
            rounds,
            &rays,
            filtered,
        );
        let occluded = |ray: &Ray| bvh.occluded(ray, accept_all);
        measure(&format!("{name}, any"), rounds, &rays, occluded);
    }
}
