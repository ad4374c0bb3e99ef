//! What rays cost, here and by Embree: `cargo bench -p bidir-accel --bench rays [-- ROUNDS [SCENE]]`.
//!
//! The same rays for every engine, which take turns in each round, so that what else the machine does
//! slows all of them. Ratios are medians over rounds; see `docs/performance.md`.

#![allow(clippy::print_stdout, reason = "a benchmark tells what it found")]
#![allow(
    clippy::disallowed_methods,
    reason = "scenes need not be the same on every machine"
)]

mod embree;
mod ours;
mod rays;
mod scenes;
mod table;

use bidir_accel::Isa;
use rayon::ThreadPoolBuilder;

use embree::{Embree, EmbreeScene};
use ours::Ours;
use rays::{aimed, batches};
use scenes::{Mesh, Scene};
use table::{Column, leak_table, scene_table};

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
    let embree = Embree::load();
    match &embree {
        Ok(embree) => println!("Embree {}, robust, single rays", embree.version()),
        Err(reason) => println!("skipped: {reason}"),
    }
    let embree = embree.as_ref().ok();
    for scene in scenes::all()
        .iter()
        .filter(|scene| scene.name.contains(&wanted))
    {
        measure(scene, embree, rounds);
    }
    if wanted.is_empty() {
        count_leaks(embree);
    }
}

/// Every engine that there is, for every instruction set of the machine.
fn columns<'a>(
    scene: &Scene,
    ours: &Ours,
    embree: Option<&'a Embree>,
    threads: usize,
) -> Vec<Column<'a>> {
    let mut columns = Vec::new();
    for (isa, ours) in ours.for_each_isa() {
        let reference = embree.filter(|_| isa != Isa::Scalar);
        columns.push(Column::new(format!("ours {isa}"), Box::new(ours)));
        let Some(embree) = reference else { continue };
        match embree.build(scene, isa, threads) {
            Ok(built) => {
                let built: EmbreeScene<'a> = built;
                columns.push(Column::new(format!("Embree {isa}"), Box::new(built)));
            }
            Err(reason) => println!("skipped: {reason}"),
        }
    }
    columns
}

fn measure(scene: &Scene, embree: Option<&Embree>, rounds: usize) {
    let threads = rayon::current_num_threads();
    let ours = Ours::build(scene);
    let columns = columns(scene, &ours, embree, threads);
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
fn count_leaks(embree: Option<&Embree>) {
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
        leak_table(name, &columns(&scene, &ours, embree, 1), &rays);
    }
}
