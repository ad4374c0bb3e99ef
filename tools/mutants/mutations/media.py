"""Faults in participating media."""

from .tests import media, unit

ADVANCE = "crates/bidir/src/scene/advance.rs"
EDGE = "crates/bidir/src/scene/edge.rs"
PASSAGE = "crates/bidir/src/scene/passage.rs"
FURNACE = media("a_furnace_full_of_fog")
EQUILIBRIUM = media("glow::matter_in_equilibrium")

MEDIA = [
    (
        "a surface behind media as likely as without them",
        EDGE,
        "LocusKind::Infinity => lanes.mean(drawn)",
        "LocusKind::Infinity => 1.0",
        FURNACE,
    ),
    (
        "the density of a collision without the coefficient",
        EDGE,
        "lanes.mean(extinction * drawn)",
        "lanes.mean(drawn)",
        FURNACE,
    ),
    (
        "walks stopped by the media that they are weighted by",
        "crates/bidir/src/medium/flight.rs",
        "if !self.stops_walks() {",
        "if false {",
        media("a_slab"),
    ),
    (
        "distances that nothing draws in the density",
        EDGE,
        "let drawn = arriving(self.drawn);",
        "let drawn = arriving(self.all);",
        media("a_slab"),
    ),
    (
        "kinds of ends exchanged in a reverse density",
        EDGE,
        "to_a: density(a),",
        "to_a: density(b),",
        media("estimators_agree_in_a_room_full_of_fog"),
    ),
    (
        "every medium on the way passed by the whole depth that was drawn",
        ADVANCE,
        "            drawn.depth -= part.drawn[drawn.lane];\n",
        "            drawn.depth -= 0.0 * part.drawn[drawn.lane];\n",
        unit("scene::advance"),
    ),
    (
        "distances by one lane alone",
        ADVANCE,
        "lane: lanes.pick_lane(u_lane),",
        "lane: lanes.pick_lane(u_lane * 0.0),",
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
        "        entry.term.weight = weights.connection(job, &path, &sums);",
        "        weights.connection(job, &path, &sums);",
        media("nested_media"),
    ),
    (
        "the weight of a guess kept past boundaries",
        EDGE,
        "is_guessed: passage.crossings.is_empty()\n",
        "is_guessed: true\n",
        unit("scene::advance"),
    ),
    (
        "media that are foreseen, and let all light through",
        "crates/bidir/src/integrator/stages/connect.rs",
        "let contribution = in_vacuum * connection.transmittance;",
        "let contribution = in_vacuum * Spectrum::ONE;",
        FURNACE,
    ),
    (
        "media foreseen behind boundaries",
        "crates/bidir/src/scene/builder.rs",
        "foresees_media: is_opaque && ",
        "foresees_media: ",
        media("nested_media"),
    ),
    (
        "open boundaries between two places that are clear",
        EDGE,
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
        "crates/bidir/src/scene/alpha.rs",
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
        "lanes.unbounded(self.at(point).extinction)",
        "lanes.unbounded(self.at(point).extinction.map(|c| c.max(0.4)))",
        media("smoke_that_absorbs_nothing"),
    ),
    (
        "a fire that walks from the camera do not see",
        "crates/bidir/src/path/vertex.rs",
        "light: job.scene.glow(locus.media.outside),",
        "light: None,",
        media("glow::a_ball"),
    ),
    (
        "fire beyond the boundary of its medium",
        "crates/bidir/src/scene/glow.rs",
        "self.medium_at(at.locus.point) == light.medium()",
        "self.medium_at(at.locus.point) == light.medium() || true",
        EQUILIBRIUM,
    ),
    (
        "light of all that a medium takes, scattered or absorbed",
        "crates/bidir/src/medium/glow.rs",
        "lanes.unbounded(self.at(point).absorption()) * glow",
        "lanes.unbounded(self.at(point).extinction) * glow",
        EQUILIBRIUM,
    ),
    (
        "points of a fire as likely in each of its cells",
        "crates/bidir/src/light/volume.rs",
        "self.points.pdf(within) * self.inverse_volume",
        "self.inverse_volume",
        unit("light::tests::densities"),
    ),
    (
        "boundaries in one place in the order of their hits",
        "crates/bidir/src/scene/passage.rs",
        "by_place.then(a.surface.cmp(&b.surface))",
        "by_place",
        unit("boundaries_in_one_place"),
    ),
]
