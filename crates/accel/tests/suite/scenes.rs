//! Scenes and rays for the tests; everything is a function of a seed.

use std::collections::HashMap;
use std::f32::consts::TAU;

use bidir_accel::{Cylinder, Disk, Primitive, Ray, Sphere};
use glam::{Affine3A, Quat, Vec3};

/// The generator `SplitMix64`.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.bits() >> 33) as usize % limit
    }

    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// In the cube `[-1, 1)³`.
    pub(crate) fn cube(&mut self) -> Vec3 {
        2.0 * Vec3::new(self.unit(), self.unit(), self.unit()) - 1.0
    }

    /// In the unit ball, but not close to its center.
    pub(crate) fn ball(&mut self) -> Vec3 {
        loop {
            let p = self.cube();
            if (0.01..1.0).contains(&p.length_squared()) {
                return p;
            }
        }
    }

    /// A random ray; some have components of zero or large and small scales.
    pub(crate) fn ray(&mut self) -> Ray {
        let mut direction = self.ball();
        match self.below(8) {
            0 => direction[self.below(3)] = 0.0,
            1 => direction = Vec3::AXES[self.below(3)] * direction.x,
            2 => direction *= 1e-3,
            3 => direction *= 1e3,
            _ => {}
        }
        Ray::new(2.0 * self.cube(), direction)
    }

    /// A whole turn, or a part of one.
    fn azimuth(&mut self) -> f32 {
        if self.below(2) == 0 {
            TAU
        } else {
            0.5 + 5.0 * self.unit()
        }
    }

    pub(crate) fn map(&mut self) -> Affine3A {
        let rotation = Quat::from_axis_angle(self.ball().normalize(), TAU * self.unit());
        let scale = Vec3::new(1.0, 0.3 + self.unit(), 0.3 + self.unit());
        Affine3A::from_scale_rotation_translation(scale, rotation, self.cube()).inverse()
    }
}

/// A closed triangle mesh.
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<Vec3>,
    pub(crate) faces: Vec<[usize; 3]>,
}

impl Mesh {
    pub(crate) fn primitives(&self) -> Vec<Primitive> {
        let triangle = |face: &[usize; 3]| Primitive::Triangle(face.map(|i| self.vertices[i]));
        self.faces.iter().map(triangle).collect()
    }

    pub(crate) fn map(mut self, f: impl Fn(Vec3) -> Vec3) -> Self {
        self.vertices.iter_mut().for_each(|v| *v = f(*v));
        self
    }

    /// An octahedron with every face divided into four `levels` times, pushed onto the unit sphere.
    pub(crate) fn sphere(levels: usize) -> Self {
        let vertices = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let faces = [[0, 1], [1, 3], [3, 4], [4, 0]].map(|[a, b]| [[a, b, 2], [b, a, 5]]);
        let mut mesh = Self {
            vertices,
            faces: faces.concat(),
        };
        for _ in 0..levels {
            mesh.subdivide();
        }
        mesh.map(Vec3::normalize)
    }

    fn subdivide(&mut self) {
        let mut midpoints = HashMap::new();
        let faces = std::mem::take(&mut self.faces);
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *midpoints.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    self.vertices
                        .push(0.5 * (self.vertices[i] + self.vertices[j]));
                    self.vertices.len() - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            self.faces
                .extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
    }

    /// The surface of the cube `[-n, n]³` as unit squares, cut along alternating diagonals.
    pub(crate) fn cube(n: i32) -> Self {
        let mut index = HashMap::new();
        let mut mesh = Self {
            vertices: Vec::new(),
            faces: Vec::new(),
        };
        for axis in 0..3 {
            for side in [-n, n] {
                for i in -n..n {
                    for j in -n..n {
                        let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                        let [a, b, c, d] = corners.map(|[i, j]| {
                            let mut p = [side; 3];
                            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, j);
                            *index.entry(p).or_insert_with(|| {
                                mesh.vertices.push(Vec3::from_array(p.map(|x| x as f32)));
                                mesh.vertices.len() - 1
                            })
                        });
                        mesh.faces.extend(if (i + j) % 2 == 0 {
                            [[a, b, c], [a, c, d]]
                        } else {
                            [[a, b, d], [b, c, d]]
                        });
                    }
                }
            }
        }
        mesh
    }
}

/// Moves the points of the unit sphere in and out, by less than a third.
pub(crate) fn displace(p: Vec3) -> Vec3 {
    let wave = |x: f32| (x - x.floor()) * (x.ceil() - x) * 4.0;
    p * (1.0 + 0.2 * wave(2.3 * p.x + 1.1 * p.y) - 0.1 * wave(9.7 * p.z - 3.1 * p.x))
}

pub(crate) fn triangle_soup(random: &mut Random, count: usize, size: f32) -> Vec<Primitive> {
    let triangle = |_| {
        let at = random.cube();
        Primitive::Triangle([0, 1, 2].map(|_| at + size * random.cube()))
    };
    (0..count).map(triangle).collect()
}

pub(crate) fn sphere(random: &mut Random) -> Primitive {
    let radius = 0.05 + 0.3 * random.unit();
    let mut cuts = [-radius, radius];
    if random.below(2) == 0 {
        cuts = [-radius * random.unit(), radius * random.unit()];
    }
    let phi_max = random.azimuth();
    Primitive::Sphere(Sphere {
        local_from_world: random.map(),
        radius,
        z_min: cuts[0],
        z_max: cuts[1],
        phi_max,
    })
}

pub(crate) fn disk(random: &mut Random) -> Primitive {
    let radius = 0.05 + 0.3 * random.unit();
    Primitive::Disk(Disk {
        local_from_world: random.map(),
        height: 0.2 * random.unit(),
        radius,
        inner_radius: if random.below(2) == 0 {
            0.0
        } else {
            radius * random.unit()
        },
        phi_max: random.azimuth(),
    })
}

pub(crate) fn cylinder(random: &mut Random) -> Primitive {
    let z_min = 0.4 * (random.unit() - 0.5);
    Primitive::Cylinder(Cylinder {
        local_from_world: random.map(),
        radius: 0.05 + 0.3 * random.unit(),
        z_min,
        z_max: z_min + 0.05 + 0.4 * random.unit(),
        phi_max: random.azimuth(),
    })
}

/// Triangles and quadrics, shuffled.
pub(crate) fn mixed(random: &mut Random, count: usize) -> Vec<Primitive> {
    let mut primitives = triangle_soup(random, count / 2, 0.2);
    while primitives.len() < count {
        let make = [sphere, disk, cylinder][random.below(3)];
        primitives.push(make(random));
    }
    for i in (1..count).rev() {
        primitives.swap(i, random.below(i + 1));
    }
    primitives
}
