//! Generated rooms: the same light transport with any number of triangles, and any albedo.
//!
//! All faces of a furnished room are flat, and each is divided into k × k squares of two triangles. The
//! light is the same for every k, and so are the paths, contributions and errors; only the tree of the
//! intersector grows, and with it the cost of a ray. More objects or bumps would also change the light, so
//! that errors could no longer be compared. The limitation: flat faces are the best case for many
//! triangles, since a ray meets few of their boxes. Therefore a measured number of triangles from which an
//! optimisation pays is an upper bound.

use formats::scene::Files;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// The light source of a room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// A panel below the ceiling.
    Panel,
    /// A panel deep in an opaque bowl, which illuminates only the ceiling.
    Bowl,
}

impl Lamp {
    /// Every kind with its name.
    pub const NAMES: [(&'static str, Self); 2] =
        [("direct", Self::Panel), ("indirect", Self::Bowl)];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Panel => "direct",
            Self::Bowl => "indirect",
        }
    }

    /// Returns radiance, position, half width, and the order of corners, which makes it face down or up.
    fn emitter(self) -> (f32, [f32; 3], f32, &'static str) {
        match self {
            Self::Panel => (25.0, [2.2, 2.95, 2.6], 0.5, "0 1 2 0 2 3"),
            Self::Bowl => (4000.0, [0.5, 1.75, 4.5], 0.06, "0 2 1 0 3 2"),
        }
    }
}

/// A generated room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// The light source.
    pub light: Lamp,
    /// The albedo of every surface. Range: (0, 1).
    pub albedo: f32,
    /// The approximate number of triangles.
    pub triangles: usize,
}

/// A parallelogram: a corner and two edges.
type Face = [[f32; 3]; 3];

impl Room {
    /// Returns the number of squares along an edge of a face.
    fn division(self) -> usize {
        let whole = 2 * faces().len();
        ((self.triangles as f64 / whole as f64).sqrt().round() as usize).max(1)
    }

    /// Returns the exact number of triangles, without the triangles of the light.
    fn count(self) -> usize {
        2 * faces().len() * self.division() * self.division()
    }

    /// Returns the name of the room's scene file.
    pub(super) fn name(self) -> PathBuf {
        let (light, triangles) = (self.light.name(), self.count());
        format!("room-{light}-{triangles}-{}.pbrt", self.albedo).into()
    }

    /// Returns the scene file and its mesh, in memory.
    pub(super) fn files(self) -> Files {
        let mesh = format!("room-{}.ply", self.count());
        let scene = Arc::from(self.text(&mesh).as_bytes());
        let bytes = Arc::from(ply(&faces(), self.division()));
        Files::only([(self.name(), scene), (mesh.into(), bytes)].into())
    }

    fn text(self, mesh: &str) -> String {
        let (radiance, [x, y, z], half, indices) = self.light.emitter();
        let albedo = self.albedo;
        format!(
            "LookAt 3.6 1.5 0.3  1.62 0.86 4  0 1 0\n\
             Camera \"perspective\" \"float fov\" 56\n\
             Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 48\n\
             PixelFilter \"gaussian\"\n\
             Sampler \"independent\"\n\
             Integrator \"bdpt\"\n\
             WorldBegin\n\
             Material \"diffuse\" \"rgb reflectance\" [{albedo} {albedo} {albedo}]\n\
             Shape \"plymesh\" \"string filename\" \"{mesh}\"\n\
             AttributeBegin\n\
             AreaLightSource \"diffuse\" \"rgb L\" [{radiance} {radiance} {radiance}]\n\
             Translate {x} {y} {z}\n\
             Scale {half} 1 {half}\n\
             Shape \"trianglemesh\" \"integer indices\" [{indices}]\n\
             \"point3 P\" [-1 0 -1  1 0 -1  1 0 1  -1 0 1]\n\
             AttributeEnd\n"
        )
    }
}

/// Returns the faces of walls, furniture, and the bowl.
fn faces() -> Vec<Face> {
    let mut faces = Vec::new();
    let boxes = [
        // The room itself.
        [[0.0, 0.0, 0.0], [4.0, 3.0, 5.0]],
        // A table with four legs.
        [[1.3, 0.7, 2.4], [2.7, 0.75, 3.3]],
        [[1.35, 0.0, 2.45], [1.42, 0.7, 2.52]],
        [[2.58, 0.0, 2.45], [2.65, 0.7, 2.52]],
        [[1.35, 0.0, 3.18], [1.42, 0.7, 3.25]],
        [[2.58, 0.0, 3.18], [2.65, 0.7, 3.25]],
        // Seat and back of a sofa, a cupboard, and two things on the table.
        [[0.9, 0.0, 4.1], [2.9, 0.42, 4.9]],
        [[0.9, 0.42, 4.7], [2.9, 0.95, 4.9]],
        [[0.02, 0.0, 1.2], [0.5, 1.9, 2.3]],
        [[1.7, 0.75, 2.7], [1.85, 0.98, 2.85]],
        [[2.1, 0.75, 2.8], [2.4, 0.8, 3.05]],
    ];
    for [low, high] in boxes {
        for axis in 0..3 {
            for end in [low, high] {
                let mut corner = low;
                corner[axis] = end[axis];
                faces.push(face(corner, low, high, axis));
            }
        }
    }
    // The bowl: a box without its top.
    let (low, high) = ([0.35, 1.7, 4.35], [0.65, 2.0, 4.65]);
    for (axis, at) in [(0, 0.35), (0, 0.65), (1, 1.7), (2, 4.35), (2, 4.65)] {
        let mut corner = low;
        corner[axis] = at;
        faces.push(face(corner, low, high, axis));
    }
    faces
}

/// Returns the face of a box at `corner`, perpendicular to `axis`.
fn face(corner: [f32; 3], low: [f32; 3], high: [f32; 3], axis: usize) -> Face {
    let edge = |k: usize| {
        let along = (axis + k) % 3;
        let mut edge = [0.0; 3];
        edge[along] = high[along] - low[along];
        edge
    };
    [corner, edge(1), edge(2)]
}

/// Writes the faces, each divided into k × k squares, as binary PLY.
fn ply(faces: &[Face], k: usize) -> Vec<u8> {
    let row = k + 1;
    let mut head = String::from("ply\nformat binary_little_endian 1.0\n");
    // Writing to a string cannot fail.
    let _ = write!(
        head,
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        faces.len() * row * row,
        faces.len() * k * k * 2
    );
    let mut bytes = head.into_bytes();
    for [corner, a, b] in faces {
        for at in 0..row * row {
            let [u, v] = [at % row, at / row].map(|i| i as f32 / k as f32);
            for axis in 0..3 {
                let x = corner[axis] + u * a[axis] + v * b[axis];
                bytes.extend(x.to_le_bytes());
            }
        }
    }
    for face in 0..faces.len() {
        for cell in 0..k * k {
            let first = face * row * row + cell / k * row + cell % k;
            let square = [first, first + 1, first + row + 1, first + row];
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                bytes.push(3);
                for corner in triangle {
                    bytes.extend((square[corner] as u32).to_le_bytes());
                }
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::driver::{Resources, Settings, render};
    use bidir::integrator::IntegratorKind;
    use formats::scene::{LoadOptions, load_from};

    fn image(room: Room) -> (u64, Vec<[f32; 3]>) {
        let options = LoadOptions {
            resolution: Some([8, 6]),
            ..LoadOptions::default()
        };
        let loaded = load_from(&room.name(), &options, &room.files()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let settings = Settings::new(IntegratorKind::Bdpt);
        let film = render(
            &loaded.scene,
            &loaded.view,
            &settings,
            256,
            &Resources::default(),
        )
        .unwrap();
        (loaded.summary.primitives, film.develop().pixels)
    }

    /// The same random numbers give the same paths, except for rare differences by rounding.
    #[test]
    fn dividing_faces_changes_no_light() {
        for (_, light) in Lamp::NAMES {
            let room = |triangles| Room {
                light,
                albedo: 0.7,
                triangles,
            };
            let (few, coarse) = image(room(100));
            let (many, fine) = image(room(4000));
            assert_eq!(few, room(100).count() as u64 + 2);
            assert_eq!(many, room(4000).count() as u64 + 2);
            assert!(many > 3000 && many < 5000, "{many}");
            let sum = |pixels: &[[f32; 3]]| pixels.iter().flatten().sum::<f32>();
            assert!(sum(&coarse) > 0.0);
            let ratio = sum(&fine) / sum(&coarse);
            assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        }
    }
}
