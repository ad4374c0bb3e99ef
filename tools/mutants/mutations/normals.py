"""Faults in shading normals, and in coats with normals of their own."""

from .tests import PATH, formats, relief

VISIBLE = "crates/bidir/src/path/visible.rs"

NORMALS = [
    (
        "correction of shading normals for one mode only",
        "crates/bidir/src/path/scatter.rs",
        "TransportMode::Importance => (wi, wo),",
        "TransportMode::Importance => (wo, wi),",
        PATH,
    ),
    (
        "shading normals turned by where the walk came from",
        VISIBLE,
        "TransportMode::Importance => wi,",
        "TransportMode::Importance => wo,",
        PATH,
    ),
    (
        "light walks with the density of normals that the camera sees",
        VISIBLE,
        "[by_light.pdf * light(wo), by_camera.pdf_reverse]",
        "[by_camera.pdf, by_camera.pdf_reverse]",
        relief("densities_of_light_walks"),
    ),
    (
        "shading normals that face away from the viewer",
        VISIBLE,
        "            if along >= least {\n",
        "            if along >= -1.0 {\n",
        relief("relief_is_not_black"),
    ),
    (
        "plastic that mirrors light below the horizon",
        VISIBLE,
        "least + 0.5 * gloss * (cos - least)",
        "least + 0.0 * gloss * (cos - least)",
        relief("plastic_keeps_its_light"),
    ),
    (
        "a coat lit by the cosine of its base",
        VISIBLE,
        "let ratios = locals.map(|local| (local.z / cos_g).max(0.0));",
        "let ratios = [(locals[0].z / cos_g).max(0.0); 2];",
        formats("a_coat_has_normals_of_its_own"),
    ),
    (
        "a coat with the normals of its base",
        "crates/bidir/src/path/vertex.rs",
        "coat.filter(is_apart)",
        "coat.filter(|n| is_apart(n) && n.z > 2.0)",
        formats("a_coat_has_normals_of_its_own"),
    ),
]
