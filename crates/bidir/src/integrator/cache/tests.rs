//! Draws from a light cache have the probability that they say.

use super::*;
use crate::camera::LensSample;
use crate::guide::PairSums;
use crate::locus::Locus;
use crate::math::Vec3;
use crate::medium::MediumId;
use crate::testing::check_near;

const SUBPATHS: usize = 20;
/// The places of numbers that are drawn with, evenly spaced.
const DRAWS: u32 = 1 << 20;

/// Returns a vertex in a cell, of a subpath that begins on a light.
fn vertex(cell: Cell) -> Vertex {
    let lens = LensSample {
        locus: Locus::on_surface(Vec3::ZERO, Vec3::Z, 0.0),
        pdf: 1.0,
    };
    Vertex {
        cell,
        light: Some(0),
        ..Vertex::camera(&lens, MediumId::VACUUM)
    }
}

/// Returns one of three cells.
fn cell(cells: &Cells, i: usize) -> Cell {
    let axis = [Vec3::X, Vec3::Y, Vec3::Z][i % 3];
    cells.of(Vec3::ZERO, axis)
}

fn cache(proposals: Option<&LightProposals>, cells: &Cells) -> LightCache {
    let mut walks = Subpaths::default();
    for i in 0..SUBPATHS {
        // x_0 is not connected; some subpaths have nothing else.
        walks.add((0..=i % 4).map(|j| vertex(cell(cells, i * j))));
    }
    let mut cache = LightCache::default();
    cache.index(&walks, LightPointChoice::Fresh, proposals);
    cache
}

/// Each vertex comes up as often as it is said to.
fn check(proposals: Option<&LightProposals>, cells: &Cells) {
    let cache = cache(proposals, cells);
    let connectable = (0..SUBPATHS).map(|i| i % 4).sum();
    let mut found = vec![(0u32, 0.0); connectable];
    let row = proposals.map(|all| all.row(cell(cells, 1)));
    for i in 0..DRAWS {
        let number = (u64::from(2 * i + 1) << 31) / u64::from(DRAWS);
        let draw = match row {
            Some(row) => cache.draw_learned(row, number as u32),
            None => cache.draw_any(number as u32),
        };
        if let Some((_, draw)) = draw {
            found[draw.entry].0 += 1;
            found[draw.entry].1 = f64::from(draw.inverse_prob);
        }
    }
    for (i, (count, inverse_prob)) in found.into_iter().enumerate() {
        let prob = f64::from(count) / f64::from(DRAWS);
        let told = 1.0 / inverse_prob;
        check_near(prob, told, 3.0 / f64::from(DRAWS), i);
    }
}

#[test]
fn draws_have_the_probability_that_they_say() {
    let cells = Cells::new(&mut []);
    let numbers = |count: usize, step: usize| (0..count).map(move |i| (i * step % 7) as f64);
    let sums = PairSums {
        light_vertices: numbers(Cells::COUNT, 5).collect(),
        squares: numbers(Cells::COUNT * Cells::COUNT, 3).collect(),
        arrived: vec![[0; 2]; Cells::COUNT * Cells::COUNT],
    };
    let uniform = PairSums::uniform(sums.light_vertices.clone());
    let [learned, uniform] = [sums, uniform].map(|sums| LightProposals::new(cells.clone(), &sums));
    for proposals in [None, Some(&uniform), Some(&learned)] {
        check(proposals, &cells);
    }
}

/// The numbers of all `u` together are all numbers, each as often as others.
#[test]
fn numbers_are_one_of_each_of_as_many_parts() {
    for count in [1, 2, 3, 7, 24, 48, 4096] {
        for u in [0, 1, 1 << 31, u32::MAX] {
            let drawn: Vec<_> = numbers(count, u).map(u64::from).collect();
            assert_eq!(drawn.len(), usize::from(count));
            for (m, number) in (0..).zip(drawn) {
                let exact = (m << 32 | u64::from(u)) / u64::from(count);
                assert!(number.abs_diff(exact) <= 1, "{number} instead of {exact}");
            }
        }
    }
}
