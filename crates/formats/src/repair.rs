//! Repairs the attributes of meshes that cannot be used as they are, and counts them.
//!
//! Wrong positions and indices are errors, as the shape of the mesh depends on them. All other attributes
//! have substitutes.

use glam::DVec3;

/// The number of defects of a mesh, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Faces without area, or with fewer than three corners: no ray hits them.
    pub faces: usize,
    /// Polygons whose sides cross: a fan fills them.
    pub crossing: usize,
    /// Normals that are not finite, or zero: replaced by the normals of the faces around.
    pub normals: usize,
    /// Tangents that are not finite, or zero: the mesh loses all its tangents.
    pub tangents: usize,
    /// Texture coordinates that are not finite: replaced by 0.
    pub uvs: usize,
    /// Colours that are not finite: replaced by white.
    pub colors: usize,
    /// Weights of joints that are not finite, negative, or of joints that do not exist: replaced by 0.
    pub weights: usize,
    /// Vertices of a skin whose weights are all 0: they follow its first joint.
    pub loose: usize,
}

impl Repairs {
    /// Returns a warning for each kind of repair that was made.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = String> {
        let all = [
            (self.faces, "faces have no area and are not seen"),
            (
                self.crossing,
                "polygons cross themselves: each is filled as a fan",
            ),
            (
                self.normals,
                "normals are not finite or zero: those of the faces there are used",
            ),
            (
                self.tangents,
                "tangents are not finite or zero: all of the mesh follow its texture coordinates",
            ),
            (
                self.uvs,
                "texture coordinates are not finite and count as 0",
            ),
            (
                self.colors,
                "colours of vertices are not finite and count as white",
            ),
            (
                self.weights,
                "weights of joints are not finite, negative, or of joints that do not exist, and count as 0",
            ),
            (
                self.loose,
                "vertices have no weight of a joint and follow the first",
            ),
        ];
        let repaired = all.into_iter().filter(|(count, _)| *count > 0);
        repaired.map(|(count, what)| format!("{count} {what}"))
    }
}

/// Returns true for a vector that has no direction.
pub(crate) fn has_no_direction(v: &[f32; 3]) -> bool {
    !v.iter().all(|x| x.is_finite()) || v.iter().all(|&x| x == 0.0)
}

/// Returns twice the vector area of a triangle, which points along the normal of its front.
pub(crate) fn area(positions: &[[f32; 3]], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|i| DVec3::from(positions[i as usize].map(f64::from)));
    (b - a).cross(c - a)
}

/// Returns the number of triangles without area.
pub(crate) fn count_flat(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> usize {
    let areas = triangles.iter().map(|&triangle| area(positions, triangle));
    areas.filter(|area| *area == DVec3::ZERO).count()
}

/// Replaces each normal without a direction by the mean normal of the faces around it, weighted by area, on the
/// side to which the other normals of these faces point. Returns the number of replaced normals.
pub(crate) fn repair_normals(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    normals: &mut [[f32; 3]],
) -> usize {
    let count = normals
        .iter()
        .filter(|normal| has_no_direction(normal))
        .count();
    if count == 0 {
        return 0;
    }
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for &triangle in triangles {
        let of_corner =
            |i: u32| Some(normals[i as usize]).filter(|normal| !has_no_direction(normal));
        let others = triangle.into_iter().filter_map(of_corner);
        let side: DVec3 = others
            .map(|normal| DVec3::from(normal.map(f64::from)))
            .sum();
        let front = area(positions, triangle);
        for corner in triangle {
            sums[corner as usize] += if side.dot(front) < 0.0 { -front } else { front };
        }
    }
    for (normal, sum) in normals.iter_mut().zip(sums) {
        if has_no_direction(normal) {
            *normal = sum.normalize_or_zero().as_vec3().to_array();
        }
    }
    count
}

/// Replaces values that are not finite by `substitute`. Returns the number of vertices that have one.
pub(crate) fn replace_infinite<const N: usize>(values: &mut [[f32; N]], substitute: f32) -> usize {
    let mut count = 0;
    for value in values {
        if !value.iter().all(|x| x.is_finite()) {
            *value = value.map(|x| if x.is_finite() { x } else { substitute });
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    #[track_caller]
    fn check_normal(normal: [f32; 3], others: [f32; 3], expected: [f32; 3]) {
        let mut normals = [normal, others, others, others];
        assert_eq!(repair_normals(&QUAD, &HALVES, &mut normals), 1);
        assert_eq!(normals[0].map(f32::to_bits), expected.map(f32::to_bits));
    }

    #[test]
    fn a_normal_without_direction_is_that_of_the_faces_on_their_side() {
        for bad in [[f32::NAN, 0., 1.], [0., f32::INFINITY, 0.], [0.; 3]] {
            check_normal(bad, [0., 0., 2.], [0., 0., 1.]);
            check_normal(bad, [0.6, 0., -0.8], [0., 0., -1.]);
        }
        let mut all = [[f32::NAN; 3]; 4];
        assert_eq!(repair_normals(&QUAD, &HALVES, &mut all), 4);
        assert_eq!(all, [[0., 0., 1.]; 4]);
        let mut good = [[0.5, 0., 0.]; 4];
        assert_eq!(repair_normals(&QUAD, &HALVES, &mut good), 0);
        assert_eq!(good, [[0.5, 0., 0.]; 4]);
    }

    #[test]
    fn triangles_without_area_are_counted_and_thin_ones_are_not() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [1., 1e-30, 0.]];
        let triangles = [[0, 1, 2], [0, 2, 3], [1, 1, 3]];
        assert_eq!(count_flat(&positions, &triangles), 2);
    }

    #[test]
    fn numbers_that_are_not_finite_have_a_substitute() {
        let mut uvs = [[0.5, f32::NAN], [f32::NEG_INFINITY, 1.0], [0.25, 0.75]];
        assert_eq!(replace_infinite(&mut uvs, 0.0), 2);
        assert_eq!(uvs, [[0.5, 0.0], [0.0, 1.0], [0.25, 0.75]]);
    }
}
