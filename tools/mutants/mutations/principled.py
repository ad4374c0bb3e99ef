"""Faults in the principled material and in what glTF files say."""

from .tests import gltf, materials, unit

MODEL = "crates/bidir/src/bsdf/principled/mod.rs"
VALUE = "crates/bidir/src/bsdf/principled/value.rs"
DRAW = "crates/bidir/src/bsdf/principled/draw.rs"

PRINCIPLED = [
    # --- the principled material --------------------------------------------------------------
    (
        "a diffuse base under Fresnel's layer in one direction only",
        VALUE,
        "self.tint * (self.diffuse * self.uncovered(wo) * self.uncovered(wi))",
        "self.tint * (self.diffuse * self.uncovered(wo))",
        unit("light_flows_both_ways"),
    ),
    (
        "a facet's choice between reflection and transmission not in the density",
        DRAW,
        "return prob * self.ggx.mirror_pdf(wo, wi);\n        }\n        if self.glass",
        "return self.ggx.mirror_pdf(wo, wi);\n        }\n        if self.glass",
        unit("samples_follow_the_density"),
    ),
    (
        "a coat that leaves all light to what it covers",
        MODEL,
        "(1.0 - self.coat_albedo(w)) * (1.0 - self.sheen_albedo(w))",
        "1.0 - self.sheen_albedo(w)",
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
        DRAW,
        "pdf += probs.coat * self.coat_ggx().mirror_pdf(wo, wi);",
        "pdf += 0.8 * probs.coat * self.coat_ggx().mirror_pdf(wo, wi);",
        unit("samples_follow_the_density"),
    ),
    # --- glTF ---------------------------------------------------------------------------------
    (
        "textures of glTF upside down",
        "crates/formats/src/gltf/mesh.rs",
        "Vec2::new(s, 1.0 - t)",
        "Vec2::new(s, t)",
        gltf("textures_are_the_right_way_up"),
    ),
    (
        "mirrored nodes keep their winding",
        "crates/formats/src/gltf/mesh/placing.rs",
        "let orientation = if is_mirrored {",
        "let orientation = if !is_mirrored && is_mirrored {",
        gltf("mirrored_nodes_turn_the_winding"),
    ),
]
