//! Boxes with holes, faces that are turned, and parts within parts.

use super::*;

const NONE: Vec<u32> = Vec::new();

/// The faces of a box, seen from outside.
const BOX: [u32; 36] = [
    4, 5, 6, 4, 6, 7, 0, 2, 1, 0, 3, 2, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0,
    4, 3, 4, 7,
];

/// A box between two corners, without shared vertices.
fn soup([low, high]: [Vec3; 2]) -> Mesh {
    let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let ends = [low, high];
    let corner = |i: u32| {
        let [x, y] = ring[i as usize % 4];
        Vec3::new(ends[x].x, ends[y].y, ends[i as usize / 4].z)
    };
    Mesh {
        positions: BOX.map(corner).to_vec(),
        triangles: (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    }
}

fn cube(half: f32) -> Mesh {
    soup([Vec3::splat(-half), Vec3::splat(half)])
}

fn turned(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|face| face.swap(1, 2));
    mesh
}

fn of(meshes: &[Mesh]) -> Findings {
    Findings::of(&meshes.iter().collect::<Vec<_>>())
}

#[test]
fn a_box_is_closed_and_looks_outwards() {
    let findings = of(&[cube(1.0)]);
    assert!(findings.is_closed() && !findings.is_inside_out);
    assert_eq!(findings.turned, [NONE; 1]);
    let findings = of(&[turned(cube(1.0))]);
    assert!(findings.is_closed() && findings.is_inside_out);
    let mirrored = Mesh {
        orientation: Orientation::Reversed,
        ..turned(cube(1.0))
    };
    assert!(!of(&[mirrored]).is_inside_out);
}

#[test]
fn holes_are_openings_wherever_they_are() {
    for holes in [vec![0], vec![5], vec![0, 1, 2, 3], vec![6, 7, 10, 11]] {
        let mut mesh = cube(1.0);
        let mut number = 0..;
        mesh.triangles
            .retain(|_| !holes.contains(&number.next().unwrap_or(0)));
        assert_eq!(of(&[mesh]).open, [true], "{holes:?}");
    }
    assert_eq!(of(&[Mesh::default()]).open, [true]);
}

#[test]
fn a_sheet_with_two_sides_encloses_nothing() {
    let thin = soup([Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!(of(&[thin]).open, [true]);
    let plate = soup([Vec3::ZERO, Vec3::new(1.0, 1.0, 1e-4)]);
    assert_eq!(of(&[plate]).open, [false]);
}

/// A corner in the middle of another's edge leaves no opening.
#[test]
fn edges_may_meet_in_parts() {
    let mut mesh = cube(1.0);
    let [a, b, c] = mesh.triangles[0];
    let [from, to] = [a, b].map(|i| mesh.positions[i as usize]);
    let middle = mesh.positions.len() as u32;
    mesh.positions.push((from + to) / 2.0);
    mesh.triangles[0] = [a, middle, c];
    mesh.triangles.push([middle, b, c]);
    assert!(of(&[mesh]).is_closed());
}

#[test]
fn few_faces_follow_the_many() {
    let mut mesh = cube(1.0);
    for face in [3, 8] {
        mesh.triangles[face].swap(1, 2);
    }
    let findings = of(std::slice::from_ref(&mesh));
    assert_eq!(
        (findings.open, &findings.turned[..]),
        (vec![false], &[vec![3, 8]][..])
    );
    turn(&mut mesh, &findings.turned[0]);
    assert_eq!(of(&[mesh]).turned, [NONE; 1]);
}

#[test]
fn parts_within_others_are_cavities_and_others_are_turned() {
    let all: Vec<u32> = (0..12).collect();
    let findings = of(&[cube(1.0), turned(cube(0.5))]);
    assert_eq!(findings.turned, [NONE, NONE]);
    let apart = soup([Vec3::splat(2.0), Vec3::splat(3.0)]);
    let findings = of(&[cube(1.0), turned(apart)]);
    assert_eq!(findings.turned, [NONE, all]);
    // A solid within a cavity looks outwards again.
    let findings = of(&[cube(1.0), turned(cube(0.5)), turned(cube(0.25))]);
    assert!(findings.turned[1].is_empty() != findings.turned[2].is_empty());
}

#[test]
fn boxes_that_share_an_edge_are_both_closed() {
    let beside = soup([Vec3::new(1.0, 1.0, -1.0), Vec3::new(2.0, 2.0, 1.0)]);
    let findings = of(&[cube(1.0), beside]);
    assert!(findings.is_closed() && findings.turned.iter().all(Vec::is_empty));
}

#[test]
fn a_band_with_one_side_is_open() {
    let at = |i: u32| {
        let (angle, half) = (f64::from(i / 2) * 0.7, f64::from(i / 2) * 0.35);
        let radius = 2.0 + (f64::from(i % 2) - 0.5) * libm::cos(half);
        let z = (f64::from(i % 2) - 0.5) * libm::sin(half);
        DVec3::new(radius * libm::cos(angle), radius * libm::sin(angle), z).as_vec3()
    };
    let next = |i: u32| match i {
        18 => 1,
        19 => 0,
        i => i,
    };
    let quads = (0..9).map(|i| [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3].map(next));
    let band = Mesh {
        positions: (0..18).map(at).collect(),
        triangles: quads
            .flat_map(|[a, b, c, d]| [[a, b, c], [b, d, c]])
            .collect(),
        ..Mesh::default()
    };
    assert_eq!(of(&[band]).open, [true]);
}

#[test]
fn normals_that_point_inwards_are_turned() {
    let mut mesh = cube(1.0);
    mesh.normals = mesh.positions.iter().map(|p| -p.normalize()).collect();
    assert_eq!(turn_normals(&mut mesh), 36);
    assert_eq!(turn_normals(&mut mesh), 0);
}
