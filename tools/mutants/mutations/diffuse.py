"""Faults in connections of diffuse vertices: with each other, with light points and with lens points."""

from .tests import RUNNING, analytic, unit

DIFFUSE = "crates/bidir/src/path/diffuse.rs"
CONNECT = "crates/bidir/src/integrator/stages/diffuse.rs"

DIFFUSE_ENDS = [
    (
        "connections of diffuse vertices without the camera's other strategies",
        DIFFUSE,
        "(r_z * lanes.others + r_y * y.others)",
        "(r_z * lanes.others)",
        RUNNING,
    ),
    (
        "weights of diffuse vertices from the lane beside them",
        DIFFUSE,
        "            weights,\n",
        "            weights: glam::Vec4Swizzles::yzwx(weights),\n",
        RUNNING,
    ),
    (
        "connections of diffuse vertices that face away from each other",
        DIFFUSE,
        "Vec4::select(a & b & c & d, factors, Vec4::ZERO)",
        "factors",
        RUNNING,
    ),
    (
        "light vertices seen by the shading normal that they have",
        DIFFUSE,
        "turned: turned.bitmask(),",
        "turned: 0,",
        RUNNING,
    ),
    (
        "light vertices lost behind the last four",
        CONNECT,
        "if !others.is_empty() {",
        "if others.len() > 3 {",
        analytic("a_closed_sphere"),
    ),
    (
        "light vertices lost in the last lane",
        CONNECT,
        "offered += is_offered >> lane & 1;",
        "offered += is_offered >> lane & usize::from(lane < 3);",
        analytic("a_closed_sphere"),
    ),
    (
        "light vertices of a cache without their shares",
        CONNECT,
        "connections.contributions * shares",
        "connections.contributions",
        analytic("a_closed_sphere"),
    ),
    (
        "four spectra that are black where one lane is",
        "crates/bidir/src/spectrum/four.rs",
        "(a & b) & (c & d)",
        "(a | b) | (c | d)",
        unit("four_are_as_each_alone"),
    ),
    (
        "connections of diffuse vertices behind a shading normal",
        DIFFUSE,
        "[g_z, g_y, s_y].map",
        "[g_z, g_y, g_y].map",
        RUNNING,
    ),
    (
        "connections of diffuse vertices without the adjoint of shading normals",
        DIFFUSE,
        "TransportMode::Importance => (cos_s / cos_g).abs(),",
        "TransportMode::Importance => 1.0,",
        RUNNING,
    ),
    (
        "light points of diffuse vertices without the walk that hits the light",
        DIFFUSE,
        "let hit = start.is_hit * (to_light / start.e);",
        "let hit = 0.0 * (to_light / start.e);",
        RUNNING,
    ),
    (
        "light points of diffuse vertices without light subpaths",
        DIFFUSE,
        "let others = hit + drawn * f64::from(self.others);",
        "let others = hit + 0.0 * drawn * f64::from(self.others);",
        RUNNING,
    ),
    (
        "light images of diffuse vertices with the counts of longer paths",
        DIFFUSE,
        "sums.per_density(Bounce::First, self.before(vertex))",
        "sums.per_density(Bounce::Deeper, self.before(vertex))",
        RUNNING,
    ),
    (
        "light points of lights that no ray can hit, weighed against hits",
        DIFFUSE,
        "let hit = start.is_hit * (to_light / start.e);",
        "let hit = to_light / start.e;",
        RUNNING,
    ),
    (
        "light points of diffuse vertices with the wrong cosine in a density",
        DIFFUSE,
        "f64::from(x0.pdf_leaving(job, -segment.w) * segment.to_a)",
        "f64::from(x0.pdf_leaving(job, -segment.w) * segment.to_b)",
        RUNNING,
    ),
    (
        "light images of diffuse vertices with the wrong cosine in a density",
        DIFFUSE,
        "f64::from(lens.pdf_leaving(job, -segment.w) * segment.to_a)",
        "f64::from(lens.pdf_leaving(job, -segment.w) * segment.to_b)",
        RUNNING,
    ),
    (
        "light points as likely for light subpaths as for next-event estimation",
        DIFFUSE,
        "let drawn = start.a0 / start.e * a1;",
        "let drawn = a1;",
        RUNNING,
    ),
    (
        "light images of diffuse vertices by the cosine to the shading normal",
        DIFFUSE,
        "let cos_g = self.n_g.dot(segment.w);",
        "let cos_g = self.n_s.dot(segment.w);",
        RUNNING,
    ),
    (
        "light points behind the shading normal of a diffuse vertex",
        DIFFUSE,
        "self.n_g.dot(w) > 0.0 && self.n_s.dot(w) > 0.0 && to_b > 0.0",
        "self.n_g.dot(w) > 0.0 && to_b > 0.0",
        RUNNING,
    ),
]
