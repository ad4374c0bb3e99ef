"""Faults in textures and in relief."""

from .tests import formats, relief, unit

MAP = "crates/bidir/src/texture/map.rs"
RELIEF = "crates/bidir/src/material/relief/mod.rs"

TEXTURES = [
    # --- textures and relief ------------------------------------------------------------------
    (
        "a pixel's footprint by where the walk came from",
        "crates/bidir/src/path/vertex.rs",
        "job.view.footprint(surface.point)",
        "job.view.footprint(surface.point + wo)",
        relief("a_point_looks_the_same"),
    ),
    (
        "copies of images of odd sizes not weighted by area",
        "crates/bidir/src/texture/image.rs",
        "let (begin, end) = (i * n, (i + 1) * n);",
        "let (begin, end) = (2 * i * short, (2 * i + 2) * short);",
        unit("copies_are_means_by_area"),
    ),
    (
        "stretched images blurred by their narrower texels",
        MAP,
        "((a + c + spread) / 2.0)",
        "((a + c - spread) / 2.0)",
        unit("stretched_images_are_not_blurred"),
    ),
    (
        "octahedral maps that go on beyond their border",
        MAP,
        "if crossings.rem_euclid(2) == 0 {",
        "if crossings.rem_euclid(1) == 0 {",
        unit("octahedral_maps_have_no_border"),
    ),
    (
        "bumps pushed inwards",
        RELIEF,
        "along + n * ((height.eval(&moved) - h) / step) + dn * h",
        "along - n * ((height.eval(&moved) - h) / step) + dn * h",
        unit("a_ramp_tilts_a_plane"),
    ),
    (
        "the curvature under a height forgotten",
        RELIEF,
        "/ step) + dn * h",
        "/ step)",
        unit("a_sphere_bulges"),
    ),
    (
        "a relief that gets no tangents",
        "crates/bidir/src/material/mod.rs",
        "Self::Embossed(_) => Needs::ALL,",
        "Self::Embossed(_) => Needs::NOTHING,",
        relief("relief_changes_the_picture"),
    ),
    (
        "an image of normals decoded as colours",
        "crates/formats/src/pbrt/build/imagemap.rs",
        "encoding: Some(Encoding::Linear),",
        "encoding: None,",
        formats("materials_have_heights_or_normals"),
    ),
]
