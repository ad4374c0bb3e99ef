"""Faults in the principled material, and in light between facets."""

from .tests import unit

MODEL = "crates/bidir/src/bsdf/principled/mod.rs"
VALUE = "crates/bidir/src/bsdf/principled/value.rs"
DRAW = "crates/bidir/src/bsdf/principled/draw.rs"

PRINCIPLED = [
    (
        "a grain that mirrored parameters do not mirror",
        "crates/bidir/src/material/principled.rs",
        "Vec2::new(x, y * at.handedness.sign())",
        "Vec2::new(x, y)",
        unit("the_grain_is_mirrored"),
    ),
    # --- the principled material --------------------------------------------------------------
    (
        "a diffuse base under Fresnel's layer in one direction only",
        VALUE,
        "self.tint * (self.diffuse * self.uncovered(o) * self.uncovered(i))",
        "self.tint * (self.diffuse * self.uncovered(o))",
        unit("light_flows_both_ways"),
    ),
    (
        "a facet's choice between reflection and transmission not in the density",
        VALUE,
        "let prob = self.reflection_prob(cos).unwrap_or(0.0);",
        "let prob = 1.0;",
        unit("samples_follow_the_density"),
    ),
    (
        "a coat that leaves all light to what it covers",
        MODEL,
        "(1.0 - self.coat) * (1.0 - self.sheen)",
        "1.0 - self.sheen",
        unit("white_surfaces_gain_nothing_in_a_furnace"),
    ),
    (
        "a smooth coat's mirrored direction without that of the smooth base",
        DRAW,
        "prob += self.smooth_probs(wo)[0];",
        "prob += 0.0;",
        unit("dirac_lobes_among_others"),
    ),
    (
        "the way back through smooth glass as likely as the way in",
        DRAW,
        "pdf_reverse: reverse * sqr(index_o) * wo.z.abs(),",
        "pdf_reverse: prob * sqr(index_o) * wo.z.abs(),",
        unit("draws_agree_with_value_and_density"),
    ),
    (
        "rough lobes of a coat drawn more often than weights know",
        VALUE,
        "let of_coat = probs.coat * coat.densities[from];",
        "let of_coat = 0.8 * probs.coat * coat.densities[from];",
        unit("samples_follow_the_density"),
    ),
    (
        "layers that take light on both its ways",
        VALUE,
        "base *= Spectrum::splat(o.below().min(i.below()));",
        "base *= Spectrum::splat(o.below() * i.below());",
        unit("white_surfaces_gain_nothing_in_a_furnace"),
    ),
    # --- light between facets -----------------------------------------------------------------
    (
        "light between facets divided by the mean of the wrong side",
        "crates/bidir/src/bsdf/dielectric.rs",
        "probs[0] * probs[1] * parts[0] * INV_PI / self.lost.of(wi)",
        "probs[0] * probs[1] * parts[0] * INV_PI / self.lost.of(wo)",
        unit("light_flows_both_ways"),
    ),
    (
        "light between facets by the fit of the other slope",
        "crates/bidir/src/bsdf/multiple/loss.rs",
        "[along.sqrt(), across.sqrt()]",
        "[across.sqrt(), along.sqrt()]",
        unit("white_metal_whose_facets_scatter_often"),
    ),
    (
        "coloured metal that keeps its colour between facets",
        "crates/bidir/src/bsdf/multiple/mod.rs",
        "sqr(f) * (1.0 - lost)",
        "f * (1.0 - lost)",
        unit("coloured_metal_takes_its_colour_at_each_facet"),
    ),
    (
        "light between facets drawn more often than its density says",
        "crates/bidir/src/bsdf/multiple/mod.rs",
        "let squared = self.c2 * (libm::expf(u * self.range) - 1.0);",
        "let squared = self.c2 * (libm::expf(sqr(u) * self.range) - 1.0);",
        unit("samples_follow_the_density"),
    ),
    (
        "glTF's metal that loses light between facets",
        "crates/bidir/src/bsdf/principled/parameters.rs",
        "p.metallic > 0.0 || f0.max_lane()",
        "f0.max_lane()",
        unit("white_facets_vanish_in_a_furnace"),
    ),
]
