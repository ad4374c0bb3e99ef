"""Faults in paths: geometry, densities, weights, and which connections are made."""

from .tests import PATH, RUNNING, analytic, coverage, estimators, unit

PATHS = [
    # --- path: geometry and scattering ----------------------------------------------------
    (
        "cosine dropped from G",
        "crates/bidir/src/path/segment.rs",
        "geometry_term: cos_a * cos_b * inverse2,",
        "geometry_term: cos_a * inverse2,",
        PATH,
    ),
    (
        "G without 1/d2",
        "crates/bidir/src/path/segment.rs",
        "geometry_term: cos_a * cos_b * inverse2,",
        "geometry_term: cos_a * cos_b,",
        PATH,
    ),
    (
        "area density without the cosine",
        "crates/bidir/src/path/segment.rs",
        "                cos * inverse2\n",
        "                inverse2\n",
        PATH,
    ),
    (
        "no correction of shading normals",
        "crates/bidir/src/path/scatter.rs",
        "(self.local.z / self.cos_g).abs()",
        "1.0",
        PATH,
    ),
    # --- what lanes mean ------------------------------------------------------------------
    (
        "light subpaths with the lanes of another group",
        "crates/bidir/src/driver/session.rs",
        "self.walk_light(&job, slots.clone(), pass, batch, BATCH, |batch| {",
        "self.walk_light(&self.job(0, job.stop), slots.clone(), pass, batch, BATCH, |batch| {",
        unit("groups_may_have_lanes"),
    ),
    (
        "a sample made again with the lanes of another group",
        "crates/bidir/src/driver/session.rs",
        "self.job(slot, Stop::NEVER)",
        "self.job(0, Stop::NEVER)",
        unit("replays_have_the_lanes"),
    ),
    (
        "distances in media by a lane of red, green and blue",
        "crates/bidir/src/scene/advance.rs",
        "lane: lanes.pick_lane(u_lane),",
        "lane: Lanes::Rgb.pick_lane(u_lane),",
        unit("nothing_between_the_edges"),
    ),
    (
        "light that is added as red, green and blue, whatever its lanes",
        "crates/bidir/src/driver/deposit.rs",
        "view.film().sensor.respond(lanes.to_rgb(value))",
        "view.film().sensor.respond(crate::spectrum::Lanes::Rgb.to_rgb(value))",
        unit("nothing_between_the_edges"),
    ),
    (
        "albedos as red, green and blue, whatever their lanes",
        "crates/bidir/src/driver/features.rs",
        "albedo: job.lanes.to_rgb(albedo),",
        "albedo: crate::spectrum::Lanes::Rgb.to_rgb(albedo),",
        unit("nothing_between_the_edges"),
    ),
    # --- path: densities and weights ------------------------------------------------------
    (
        "forward and reverse density swapped",
        "crates/bidir/src/path/densities.rs",
        "VertexDensities::new(x, drawn, back)",
        "VertexDensities::new(x, back, drawn)",
        PATH,
    ),
    (
        "roulette forgotten in densities",
        "crates/bidir/src/path/densities.rs",
        ".density_factor(index - 2, albedo)",
        ".density_factor(index - 2, || 1.0)",
        PATH,
    ),
    (
        "old direction at the junction",
        "crates/bidir/src/path/densities.rs",
        "before[0] = pdf * z",
        "before[0] = at_z.pdf(job) * z",
        PATH,
    ),
    (
        "next-event density taken for the emission density",
        "crates/bidir/src/path/densities.rs",
        "(LightPointChoice::Shared, _) | (_, true) => x0.pdf_fwd,",
        "(LightPointChoice::Shared, _) | (_, _) => x0.pdf_fwd,",
        PATH,
    ),
    (
        "s = 1 ratio without the emission density",
        "crates/bidir/src/path/strategy_class.rs",
        "1 => f64::from(self.vertices[0].from_light) / next_event * (a / b),",
        "1 => a / b,",
        unit("path::mis"),
    ),
    (
        "connections counted at Dirac vertices",
        "crates/bidir/src/path/strategy_class.rs",
        "j => !x[j - 1].is_delta && !x[j].is_delta,",
        "j => !x[j].is_delta,",
        RUNNING,
    ),
    (
        "Dirac lights counted as if they could be hit",
        "crates/bidir/src/path/strategy_class.rs",
        "0 => !self.light_is_delta,",
        "0 => true,",
        RUNNING,
    ),
    (
        "running sums without the next-event density",
        "crates/bidir/src/path/running.rs",
        "1 => h(start.e / start.a0 / a),",
        "1 => h(1.0 / a),",
        RUNNING,
    ),
    (
        "running sums over links at Dirac vertices",
        "crates/bidir/src/path/running.rs",
        "links[1] * possible(!vertex.went_by_delta)",
        "links[1]",
        RUNNING,
    ),
    (
        "running sums where roulette begins late",
        "crates/bidir/src/path/running.rs",
        "self.shortest <= s.min(t)",
        "self.shortest <= s.max(t)",
        RUNNING,
    ),
    (
        "n_j of the light image is one",
        "crates/bidir/src/path/strategy_class.rs",
        "StrategyClass::LightImage => self.counts.light_subpaths,",
        "StrategyClass::LightImage => 1.0,",
        PATH,
    ),
    (
        "light choice left out of next-event estimation",
        "crates/bidir/src/path/connect.rs",
        "    sample.pdf *= prob;\n",
        "    let _ = prob;\n",
        estimators("point_spot_distant"),
    ),
    (
        "the tree of lights takes the share of another child",
        "crates/bidir/src/light/tree/hierarchy.rs",
        "prob *= shares.of[i];",
        "prob *= shares.of[i ^ 1];",
        unit("light::tests::tree"),
    ),
    (
        "part of lights at infinity forgotten in the choice of a light",
        "crates/bidir/src/light/tree/mod.rs",
        "a * self.by_power.prob(emitter) + (1.0 - a) * in_tree;",
        "self.by_power.prob(emitter) + in_tree;",
        unit("light::tests::tree"),
    ),
    (
        "survivors of roulette not raised",
        "crates/bidir/src/path/walk.rs",
        "beta: beta / survival,",
        "beta,",
        analytic("roulette_does_not"),
    ),
    # --- integrators ----------------------------------------------------------------------
    (
        "sum of the group in place of C/pi",
        "crates/bidir/src/integrator/stages/trace.rs",
        "            prob,\n            ..Entry::certain(index, of.term, link)\n",
        "            ..Entry::certain(\n"
        "                index,\n"
        "                // Right in every grey image, wrong in colour.\n"
        "                {\n"
        "                    let candidates = offered.get(index);\n"
        "                    let all: f32 = candidates.iter().map(|c| c.score).sum();\n"
        "                    let values = candidates.iter().map(|c| c.term.value());\n"
        "                    let sum = values.fold(crate::spectrum::Spectrum::ZERO, |sum, v| sum + v);\n"
        "                    crate::contribution::Term {\n"
        "                        contribution: sum * (of.score / prob as f32 / all),\n"
        "                        weight: 1.0,\n"
        "                        ..of.term\n"
        "                    }\n"
        "                },\n"
        "                link,\n"
        "            )\n",
        estimators("every_choice_of_shadow_rays"),
    ),
    (
        "candidates of a light cache not shared among each other",
        "crates/bidir/src/integrator/cache.rs",
        "1.0 / (self.subpaths as f32 * f32::from(count))",
        "1.0 / self.subpaths as f32",
        analytic("a_closed_sphere"),
    ),
    (
        "pairs of long subpaths that do not count for those left out",
        "crates/bidir/src/integrator/stages/pairs.rs",
        "Some((1.0 / prob) as f32)",
        "Some(1.0)",
        unit("pairs::tests"),
    ),
    (
        "proposals that forget their uniform part",
        "crates/bidir/src/guide/proposals.rs",
        "f32::from(UNIFORM_UNITS) * of_cell + f32",
        "f32",
        unit("cache::tests"),
    ),
    (
        "weights that forget the uniform part of proposals",
        "crates/bidir/src/guide/proposals.rs",
        "UNIFORM_PART + self.count_factors",
        "self.count_factors",
        unit("counts_of_weights_are_those_of_draws"),
    ),
    (
        "vertices of a cell proposed by the count of all",
        "crates/bidir/src/integrator/cache.rs",
        "inverse_prob(units, [all, count])",
        "inverse_prob(units, [all, all])",
        unit("cache::tests"),
    ),
    (
        "weights that know the proposal the other way round",
        "crates/bidir/src/path/strategy_class.rs",
        "self.count_of(StrategyClass::of(self.settings.light_point, s, t), cells)",
        "self.count_of(StrategyClass::of(self.settings.light_point, s, t), if s > t { [cells[1], cells[0]] } else { cells })",
        RUNNING,
    ),
    (
        "weights that take lights to be chosen by power where they are not",
        "crates/bidir/src/path/vertex.rs",
        "job.emission().prob(light as usize)",
        "scene.light_choice().prob(light as usize)",
        PATH,
    ),
    (
        "learned light subpaths divided by the probability that power has",
        "crates/bidir/src/path/walk.rs",
        "let (light, prob) = job.emission().sample(u_light)?;",
        "let light = job.emission().sample(u_light)?.0;\n    let prob = scene.light_choice().prob(light);",
        estimators("light_subpaths_with_a_trained"),
    ),
    (
        "the first vertex's light points counted for those behind it",
        "crates/bidir/src/path/strategy_class.rs",
        "self.counts.next_events[bounce as usize]",
        "self.counts.next_events[0]",
        PATH,
    ),
    (
        "several light points, each of which counts as the only one",
        "crates/bidir/src/integrator/stages/light_ends.rs",
        "drawn.alpha / (drawn.pdf * f32::from(count))",
        "drawn.alpha / drawn.pdf",
        analytic("a_closed_sphere"),
    ),
    (
        "the first vertex's candidates counted for those behind it",
        "crates/bidir/src/path/running.rs",
        "[2, 3].map(|t|",
        "[2, 2].map(|t|",
        RUNNING,
    ),
    (
        "light images of fewer subpaths not made up for",
        "crates/bidir/src/integrator/stages/light_image.rs",
        "let contribution = c * share as f32;",
        "let contribution = c * share.min(1.0) as f32;",
        analytic("a_closed_sphere"),
    ),
    (
        "shared light subpaths counted as one in sums",
        "crates/bidir/src/path/running.rs",
        "is_there * h(job.count_of(class, [before.cell, z.cell]))",
        "is_there * h(job.count_of(class, [before.cell, z.cell]).signum())",
        RUNNING,
    ),
    (
        "chosen rays not divided by their probability",
        "crates/bidir/src/integrator/stages/trace.rs",
        "            prob,\n",
        "            prob: 1.0,\n",
        analytic("selection_keeps"),
    ),
    (
        "paths one vertex too long",
        "crates/bidir/src/integrator/stages/light_ends.rs",
        ".min(settings.max_vertices() - t)",
        ".min(settings.max_vertices() + 1 - t)",
        analytic("every_limit_of_depth"),
    ),
    (
        "path tracer's two densities swapped",
        "crates/bidir/src/integrator/stages/direct.rs",
        "job.settings.mis.weight_of_two(x0.pdf, p)",
        "job.settings.mis.weight_of_two(p, x0.pdf)",
        analytic("a_ring_light"),
    ),
    (
        "film filter's weight dropped",
        "crates/bidir/src/integrator/stages/walk.rs",
        "&ray, weight, camera, &mut worker.stats);",
        "&ray, 1.0, camera, &mut worker.stats);",
        estimators("filters_with"),
    ),
    # --- selection ------------------------------------------------------------------------
    (
        "budget's probability off by 2 %",
        "crates/bidir/src/select/budget.rs",
        "                    prob,",
        "                    prob: 0.98 * prob,",
        unit("select::"),
    ),
    (
        "budget's pointer does not move on",
        "crates/bidir/src/select/budget.rs",
        "pointer -= 1.0;",
        "pointer -= prob;",
        unit("select::"),
    ),
    (
        "one per group with an even probability",
        "crates/bidir/src/select/grouped.rs",
        "prob: prob(picked.of(candidates), sum),",
        "prob: 1.0 / group.len() as f64,",
        unit("select::"),
    ),
    (
        "roulette of rays with its threshold doubled in the estimate",
        "crates/bidir/src/select/simple.rs",
        "if prob >= 1.0 || draws.get(i) < prob {",
        "if prob >= 1.0 || draws.get(i) < prob / 2.0 {",
        unit("select::"),
    ),
    (
        "a cut-out lamp that next-event estimation takes for whole",
        "crates/bidir/src/integrator/stages/light_ends.rs",
        "Spectrum::splat(drawn.alpha / (drawn.pdf * f32::from(count)))",
        "Spectrum::splat(1.0 / (drawn.pdf * f32::from(count)))",
        coverage("lamps_cut_out"),
    ),
    (
        "a cut-out lamp that the path tracer takes for whole",
        "crates/bidir/src/integrator/stages/direct.rs",
        "segment.geometry_term * x0.alpha / x0.pdf",
        "segment.geometry_term / x0.pdf",
        coverage("lamps_cut_out"),
    ),
    (
        "a cut-out lamp that light subpaths take for whole",
        "crates/bidir/src/path/walk.rs",
        "* (emission.from.alpha / (start",
        "* (1.0 / (start",
        coverage("lamps_cut_out"),
    ),
    (
        "one decision for all that a ray passes",
        "crates/bidir/src/scene/alpha.rs",
        "self.stream.get_for(self.dimension, surface ^ distance)",
        "self.stream.get_for(self.dimension, 0 * (surface ^ distance))",
        coverage("transmittances_of_walls"),
    ),
    (
        "splats not weakened by what they pass",
        "crates/bidir/src/integrator/stages/light_image.rs",
        "    trace(job, splats, &mut worker.shadow_rays, &mut worker.stats);\n",
        "    trace(job, splats, &mut worker.shadow_rays, &mut worker.stats);\n"
        "    let splats = splats.iter_mut().map(|splat| &mut splat.transmittance);\n"
        "    splats.for_each(|transmittance| *transmittance = transmittance.ceil());\n",
        coverage("a_half_transparent_plane"),
    ),
]
