"""Faults in participating media."""

from .tests import media, unit

PASSAGE = "crates/bidir/src/scene/passage.rs"
FURNACE = media("a_furnace_full_of_fog")

MEDIA = [
    (
        "a surface behind media as likely as without them",
        PASSAGE,
        "                self.color.mean(transmittance)\n",
        "                1.0\n",
        FURNACE,
    ),
    (
        "the density of a collision without the coefficient",
        PASSAGE,
        "self.color.mean(extinction * transmittance)",
        "self.color.mean(transmittance)",
        FURNACE,
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
        "let lane = self.color.pick_lane(u_lane);",
        "let lane = self.color.pick_lane(u_lane * 0.0);",
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
        "            entry.contribution.term.weight = weights.weight(&context, &path, &sums);",
        "            weights.weight(&context, &path, &sums);",
        media("nested_media"),
    ),
    (
        "scattering that looks the other way",
        "crates/bidir/src/medium/phase.rs",
        "(-wo.dot(wi)).clamp(-1.0, 1.0)",
        "wo.dot(wi).clamp(-1.0, 1.0)",
        unit("medium::phase::"),
    ),
]
