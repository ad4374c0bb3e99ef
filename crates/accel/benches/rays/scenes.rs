//! Generated scenes: rooms of many kinds of triangles, and a field of instances.

use std::f32::consts::{PI, TAU};

use glam::{DAffine3, DQuat, DVec3, Vec3};

/// Numbers from a seed, by `SplitMix64`.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    /// In the cube `[-1, 1)³`.
    pub(crate) fn cube(&mut self) -> Vec3 {
        2.0 * Vec3::new(self.unit(), self.unit(), self.unit()) - 1.0
    }

    /// A direction, uniform.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.cube();
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        ((self.unit() * limit as f32) as usize).min(limit - 1)
    }
}

/// Triangles that share vertices.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Mesh {
    pub(crate) fn triangle(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|i| self.vertices[i as usize])
    }

    /// A surface over `columns` times `rows` squares of the parameters' unit square.
    fn grid(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) -> Self {
        let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j)));
        let vertices = points.map(|(i, j)| at(i as f32 / columns as f32, j as f32 / rows as f32));
        let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| j * (columns + 1) + i));
        let faces = cells.flat_map(|a| {
            let (b, c) = (a + 1, a + columns + 1);
            [[a, b, c + 1], [a, c + 1, c]]
        });
        Self {
            vertices: vertices.collect(),
            faces: faces.collect(),
        }
    }

    /// A ball with bumps, closed: all its triangles share the poles' and the seam's vertices.
    pub(crate) fn ball(rows: u32, bump: f32) -> Self {
        let columns = 2 * rows;
        let mut mesh = Self::grid(columns, rows, |u, v| {
            let (phi, theta) = (TAU * u, PI * v);
            let wave = 1.0 + bump * (7.0 * phi).sin() * (5.0 * theta).sin();
            wave * Vec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            )
        });
        let row = columns + 1;
        let shared = |i: u32| match (i / row, i % row) {
            (0, _) => 0,
            (j, _) if j == rows => rows * row,
            (j, k) => j * row + k % columns,
        };
        mesh.faces
            .iter_mut()
            .for_each(|face| *face = face.map(shared));
        mesh.faces.retain(|[a, b, c]| a != b && b != c && c != a);
        mesh
    }

    fn map(mut self, f: impl FnMut(&mut Vec3)) -> Self {
        self.vertices.iter_mut().for_each(f);
        self
    }

    fn append(&mut self, other: &Self) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(&other.vertices);
        let moved = other.faces.iter().map(|face| face.map(|i| i + first));
        self.faces.extend(moved);
    }
}

/// The scene to be traced: a mesh in its place, or copies of one.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) mesh: Mesh,
    /// Objects and their maps. All triangles of the scene, where there are some, are theirs and the mesh's.
    pub(crate) object: Option<(Mesh, Vec<DAffine3>)>,
    /// The points that the camera is at and looks at.
    pub(crate) view: [Vec3; 2],
    pub(crate) lights: Vec<Vec3>,
}

/// A room of 8 × 3 × 8 with bumpy walls, balls, slats and plants, of `detail`² times 260 triangles, nearly.
fn room(name: &'static str, detail: u32) -> Scene {
    let mut random = Random(11);
    let mut mesh = Mesh::default();
    let size = Vec3::new(8.0, 3.0, 8.0);
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let wall = Mesh::grid(2 * detail, 2 * detail, |u, v| {
                let bump = 0.004 * (90.0 * u).sin() * (70.0 * v).sin();
                let mut p = Vec3::ZERO;
                p[axis] = side + bump * (1.0 - 2.0 * side);
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v);
                (p - Vec3::new(0.5, 0.0, 0.5)) * size
            });
            mesh.append(&wall);
        }
    }
    for _ in 0..24 {
        let radius = 0.1 + 0.4 * random.unit() * random.unit();
        let at = random.cube() * Vec3::new(3.5, 1.0, 3.5) + Vec3::Y * 1.2;
        let ball = Mesh::ball(detail + 4, 0.1).map(|p| *p = at + radius * *p);
        mesh.append(&ball);
    }
    for i in 0..40 {
        let at = Vec3::new(-3.8, 0.2 + 0.06 * i as f32, -2.0);
        let slat = Mesh::grid(detail.div_ceil(8), 1, |u, v| {
            at + Vec3::new(0.05 * v, 0.04 * v, 4.0 * u)
        });
        mesh.append(&slat);
    }
    for _ in 0..12 {
        let at = random.cube() * Vec3::new(3.6, 0.0, 3.6) + Vec3::Y * 0.5;
        plant(&mut mesh, &mut random, at, 8 * detail * detail);
    }
    Scene {
        name,
        mesh,
        object: None,
        view: [Vec3::new(3.0, 1.8, 3.3), Vec3::new(-1.0, 0.9, -1.5)],
        lights: vec![Vec3::new(-1.5, 2.9, 0.5), Vec3::new(2.0, 2.7, -2.0)],
    }
}

/// Leaves of two triangles in a ball around `at`.
fn plant(mesh: &mut Mesh, random: &mut Random, at: Vec3, triangles: u32) {
    let size = 1.5 / (triangles as f32).cbrt();
    for _ in 0..triangles / 2 {
        let (from, x, y) = (
            0.5 * random.unit() * random.direction(),
            random.direction(),
            random.direction(),
        );
        let corner = |u: f32, v: f32| at + from + 0.3 * size * (u * x + 0.4 * v * y);
        mesh.append(&Mesh::grid(1, 1, corner));
    }
}

/// A floor with a thousand copies of one ball, turned and stretched.
fn field() -> Scene {
    let mut random = Random(12);
    let floor = Mesh::grid(64, 64, |u, v| {
        let (x, z) = (40.0 * u - 20.0, 40.0 * v - 20.0);
        Vec3::new(x, 0.3 * x.sin() * z.sin(), z)
    });
    let place = |_| {
        let at = random.cube() * Vec3::new(18.0, 0.3, 18.0) + Vec3::Y * 0.4;
        let turn = DQuat::from_axis_angle(
            random.direction().as_dvec3(),
            f64::from(TAU * random.unit()),
        );
        let scale = DVec3::new(0.2, 0.3, 0.5) * f64::from(0.5 + random.unit());
        DAffine3::from_scale_rotation_translation(scale, turn, at.as_dvec3())
    };
    let maps = (0..1000).map(place).collect();
    Scene {
        name: "field",
        mesh: floor,
        object: Some((Mesh::ball(50, 0.1), maps)),
        view: [Vec3::new(15.0, 5.0, 15.0), Vec3::ZERO],
        lights: vec![Vec3::new(0.0, 12.0, 0.0), Vec3::new(-9.0, 6.0, 14.0)],
    }
}

impl Scene {
    /// Only this mesh, in its place or as an instance that is turned, stretched and moved.
    pub(crate) fn closed(mesh: Mesh, is_instance: bool) -> Self {
        let turn = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7);
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(0.3, 2.0, 0.9),
            turn,
            DVec3::new(13.0, -7.0, 4.0),
        );
        let (mesh, object) = if is_instance {
            (Mesh::default(), Some((mesh, vec![map])))
        } else {
            (mesh, None)
        };
        Self {
            name: "closed",
            mesh,
            object,
            view: [Vec3::ZERO, Vec3::Z],
            lights: Vec::new(),
        }
    }
}

pub(crate) fn all() -> Vec<Scene> {
    vec![room("room 0.1 M", 20), room("room 1 M", 62), field()]
}
