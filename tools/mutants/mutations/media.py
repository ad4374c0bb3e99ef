"""Faults in participating media."""

from .tests import media, unit

PASSAGE = "crates/bidir/src/scene/passage.rs"
FURNACE = media("a_furnace_full_of_fog")

MEDIA = [
    (
        "a surface behind media as likely as without them",
        PASSAGE,
        "LocusKind::Infinity => self.color.mean(drawn)",
        "LocusKind::Infinity => 1.0",
        FURNACE,
    ),
    (
        "the density of a collision without the coefficient",
        PASSAGE,
        "self.color.mean(extinction * drawn)",
        "self.color.mean(drawn)",
        FURNACE,
    ),
    (
        "walks stopped by the media that they are weighted by",
        "crates/bidir/src/medium/flight.rs",
        "if !self.scatters {",
        "if false {",
        media("a_slab"),
    ),
    (
        "distances that nothing draws in the density",
        PASSAGE,
        "let drawn = arriving(self.drawn);",
        "let drawn = arriving(self.all);",
        media("a_slab"),
    ),
    (
        "kinds of ends exchanged in a reverse density",
        PASSAGE,
        "to_a: density(a),",
        "to_a: density(b),",
        media("estimators_agree_in_a_room_full_of_fog"),
    ),
    (
        "distances by one lane alone",
        PASSAGE,
        "lane: self.color.pick_lane(u_lane),",
        "lane: self.color.pick_lane(u_lane * 0.0),",
        FURNACE,
    ),
    (
        "a boundary leads back to where the ray comes from",
        PASSAGE,
        "into: sides.toward(if leaves { 1.0 } else { -1.0 }),",
        "into: sides.toward(if leaves { -1.0 } else { 1.0 }),",
        media("a_slab"),
    ),
    (
        "the weight of a guess kept after the ray",
        "crates/bidir/src/integrator/stages/media.rs",
        "        entry.contribution.term.weight = weights.weight(&context, &path, &sums);",
        "        weights.weight(&context, &path, &sums);",
        media("nested_media"),
    ),
    (
        "open boundaries between two places that are clear",
        PASSAGE,
        "self.is_opaque && place.media == MediumSides::VACUUM",
        "place.media == MediumSides::VACUUM",
        media("nested_media"),
    ),
    (
        "a sky that smoke around the camera shuts out of light subpaths",
        "crates/bidir/src/path/walk.rs",
        "start.locus.is_infinite() && !scene.is_open()",
        "start.locus.is_infinite() && scene.has_media()",
        media("smoke_that_absorbs_nothing"),
    ),
    (
        "holes that lead into no medium",
        "crates/bidir/src/scene/coverage.rs",
        "cross(hit);\n                if alpha > 0.0 {",
        "if alpha <= 0.0 { cross(hit); }\n                if alpha > 0.0 {",
        media("light_that_passes_a_hole"),
    ),
    (
        "scattering that looks the other way",
        "crates/bidir/src/medium/phase.rs",
        "(-wo.dot(wi)).clamp(-1.0, 1.0)",
        "wo.dot(wi).clamp(-1.0, 1.0)",
        unit("medium::phase::"),
    ),
    (
        "grids integrated by one point",
        "crates/bidir/src/medium/grid.rs",
        "const REACH: f32 = 0.288_675_13;",
        "const REACH: f32 = 0.0;",
        unit("medium::tests::"),
    ),
    (
        "a walk through a grid stops in the middle of a cell",
        "crates/bidir/src/medium/flight.rs",
        "    for _ in 0..STEPS {",
        "    for _ in 0..STEPS * 0 {",
        unit("medium::tests::"),
    ),
    (
        "blocks that are not constant passed in one step",
        "crates/bidir/src/medium/grid.rs",
        "block.is_constant || detail == Detail::Means",
        "block.is_constant || detail != Detail::Means",
        unit("medium::tests::"),
    ),
    (
        "a walk collides in thin smoke as often as in thicker smoke",
        "crates/bidir/src/medium/mod.rs",
        "color.unbounded(self.at(point).extinction, wavelengths)",
        "color.unbounded(self.at(point).extinction.map(|c| c.max(0.4)), wavelengths)",
        media("smoke_that_absorbs_nothing"),
    ),
]
