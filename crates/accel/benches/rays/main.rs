//! The cost of rays, here and by others: `cargo bench -p bidir-accel --bench rays [-- ROUNDS [SCENE]]`.
//! Embree takes part where a library of it is found, obvhs with the feature `bench-peers`.
//!
//! The same rays for every engine, which take turns in each round, so that other load of the machine
//! slows all of them. Ratios are medians over rounds; see `docs/performance.md`.

#![allow(clippy::print_stdout, reason = "a benchmark prints its results")]
#![allow(
    clippy::disallowed_methods,
    reason = "scenes need not be the same on every machine"
)]

#[cfg(feature = "bench-peers")]
mod cwbvh;
mod embree;
mod ours;
mod rays;
mod scenes;
mod table;

use std::fmt::Display;

use bidir_accel::Isa;
use rayon::ThreadPoolBuilder;

use embree::Embree;
use ours::Ours;
use rays::{aimed, batches};
use scenes::{Mesh, Scene};
use table::{Column, EMBREE, leak_table, scene_table};

/// Rays that look for leaks, of each mesh.
const AIMED: usize = 400_000;

fn main() {
    // Cargo passes `--bench`.
    let mut words = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'));
    let rounds = words.next().map_or(Ok(15), |word| word.parse());
    let rounds: usize = rounds.expect("the first word is the number of rounds");
    let wanted = words.next().unwrap_or_default();
    let loaded = Embree::load().into_iter();
    let embrees: Vec<_> = loaded.filter_map(unless_skipped).collect();
    for scene in scenes::all()
        .iter()
        .filter(|scene| scene.name.contains(&wanted))
    {
        measure(scene, &embrees, rounds);
    }
    if wanted.is_empty() {
        count_leaks(&embrees);
    }
}

/// Every engine that there is, for every instruction set of the machine.
fn columns<'a>(
    scene: &Scene,
    ours: &Ours,
    embrees: &'a [Embree],
    threads: usize,
) -> Vec<Column<'a>> {
    let mut columns = Vec::new();
    for (isa, ours) in ours.for_each_isa() {
        columns.push(Column::new("ours", isa, ours));
        for embree in embrees.iter().filter(|_| isa != Isa::Scalar) {
            let name = format!("{EMBREE} {}", embree.version());
            let built = embree.build(scene, isa, threads);
            columns.extend(unless_skipped(built.map(|it| Column::new(&name, isa, it))));
        }
    }
    #[cfg(feature = "bench-peers")]
    columns.extend(unless_skipped(cwbvh::columns(scene)).unwrap_or_default());
    columns
}

/// Prints why there is nothing.
fn unless_skipped<T>(result: Result<T, impl Display>) -> Option<T> {
    result
        .inspect_err(|reason| println!("skipped: {reason}"))
        .ok()
}

fn measure(scene: &Scene, embrees: &[Embree], rounds: usize) {
    let threads = rayon::current_num_threads();
    let ours = Ours::build(scene);
    let columns = columns(scene, &ours, embrees, threads);
    let batches = batches(scene, &ours);
    let triangles = scene.mesh.faces.len()
        + scene
            .object
            .as_ref()
            .map_or(0, |(mesh, _)| mesh.faces.len());
    println!("\n## {}: {triangles} triangles", scene.name);
    for threads in [1, 2].into_iter().filter(|&n| n <= threads) {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        scene_table(&columns, &batches, rounds, &pool.expect("threads"));
    }
    table::build_table(&columns, triangles);
}

/// Rays that leave closed meshes, the mesh as it is and as an instance, of every engine.
fn count_leaks(embrees: &[Embree]) {
    for (name, mesh, is_instance) in [
        ("ball", Mesh::ball(50, 0.0), false),
        ("bumpy ball", Mesh::ball(200, 0.2), false),
        ("bumpy ball, an instance", Mesh::ball(200, 0.2), true),
    ] {
        let scene = Scene::closed(mesh.clone(), is_instance);
        let map = scene.object.as_ref().map(|(_, maps)| maps[0]);
        let rays = aimed(&mesh, AIMED, |p| {
            map.map_or(p, |map| map.transform_point3(p.as_dvec3()).as_vec3())
        });
        let ours = Ours::build(&scene);
        leak_table(name, &columns(&scene, &ours, embrees, 1), &rays);
    }
}
