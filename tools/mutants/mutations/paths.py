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
        "{ 1.0 } else { cos_b * inverse2 }",
        "{ 1.0 } else { inverse2 }",
        PATH,
    ),
    (
        "no correction of shading normals",
        "crates/bidir/src/path/scatter.rs",
        "(self.shading.z.dot(w) / self.n_g.dot(w)).abs()",
        "1.0",
        PATH,
    ),
    (
        "correction of shading normals for one mode only",
        "crates/bidir/src/path/scatter.rs",
        "TransportMode::Importance => self.normal_ratio(wo),",
        "TransportMode::Importance => self.normal_ratio(wi),",
        PATH,
    ),
    # --- path: densities and weights ------------------------------------------------------
    (
        "forward and reverse density swapped",
        "crates/bidir/src/path/densities.rs",
        "            drawn_density(context, &subpath[..=i]),\n"
        "            vertex.pdf_rev * factor(context, n - 1 - i, after),",
        "            vertex.pdf_rev * factor(context, n - 1 - i, after),\n"
        "            drawn_density(context, &subpath[..=i]),",
        PATH,
    ),
    (
        "roulette forgotten in densities",
        "crates/bidir/src/path/densities.rs",
        "context.settings.roulette.density_factor(index - 2, albedo)",
        "context.settings.roulette.density_factor(index - 2, || 1.0)",
        PATH,
    ),
    (
        "old direction at the junction",
        "crates/bidir/src/path/densities.rs",
        "before[0] = z.pdf_direction(context, w, z.wo)",
        "before[0] = z.pdf_direction(context, z.wo, z.wo)",
        PATH,
    ),
    (
        "next-event density taken for the emission density",
        "crates/bidir/src/path/densities.rs",
        "(LightPointChoice::Shared, _) | (_, VertexKind::Camera) => x0.pdf_fwd,",
        "(LightPointChoice::Shared, _) | (_, _) => x0.pdf_fwd,",
        PATH,
    ),
    (
        "s = 1 ratio without the emission density",
        "crates/bidir/src/path/mis.rs",
        "1 => f64::from(x[0].from_light) / next_event * x[1].ratio(),",
        "1 => x[1].ratio(),",
        unit("path::mis"),
    ),
    (
        "connections counted at Dirac vertices",
        "crates/bidir/src/path/mis.rs",
        "j => !x[j - 1].is_delta && !x[j].is_delta,",
        "j => !x[j].is_delta,",
        RUNNING,
    ),
    (
        "Dirac lights counted as if they could be hit",
        "crates/bidir/src/path/mis.rs",
        "0 => !path.light_is_delta,",
        "0 => true,",
        RUNNING,
    ),
    (
        "running sums without the next-event density",
        "crates/bidir/src/path/running.rs",
        "1 => self.next_event / self.emission * ratio(b, a),",
        "1 => ratio(b, a),",
        RUNNING,
    ),
    (
        "running sums over links at Dirac vertices",
        "crates/bidir/src/path/running.rs",
        "possible(!self.went_by_delta && !next.went_by_delta)",
        "possible(!self.went_by_delta)",
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
        "crates/bidir/src/path/count.rs",
        "1 => self.scene.film().light_paths() as f64 / samples_per_subpath,",
        "1 => 1.0,",
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
        "crates/bidir/src/integrator/bdpt.rs",
        "        let contribution = candidate.contribution(chosen.prob);",
        "        // Right in every grey image, wrong in colour.\n"
        "        let contribution = {\n"
        "            let candidates = &workspace.candidates;\n"
        "            let score = |i: usize| candidates[i].score;\n"
        "            let all: f32 = (0..candidates.len()).map(score).sum();\n"
        "            let sum = candidates.iter().fold(Spectrum::ZERO, |sum, c| sum + c.value);\n"
        "            let part = score(chosen.candidate as usize) / chosen.prob as f32 / all;\n"
        "            super::Contribution {\n"
        "                value: sum * part,\n"
        "                ..candidate.contribution(chosen.prob)\n"
        "            }\n"
        "        };",
        estimators("every_choice_of_shadow_rays"),
    ),
    (
        "candidates of a light cache not shared among each other",
        "crates/bidir/src/integrator/lvc/mod.rs",
        "draw.share / f64::from(self.candidates.at(t));",
        "draw.share;",
        analytic("a_closed_sphere"),
    ),
    (
        "proposals that forget their uniform part",
        "crates/bidir/src/path/proposals.rs",
        "part / all as f64 + (1.0 - part) * gamma / of_cell as f64",
        "(1.0 - part) * gamma / of_cell as f64",
        unit("lvc::tests"),
    ),
    (
        "vertices of a cell proposed by the count of all",
        "crates/bidir/src/integrator/lvc/cache.rs",
        "let counts = [all.len(), self.of_cell(cell).len()];",
        "let counts = [all.len(), all.len()];",
        unit("lvc::tests"),
    ),
    (
        "weights that know the proposal the other way round",
        "crates/bidir/src/path/count.rs",
        "all.relative(z.cell, y.cell);",
        "all.relative(if s > t { z.cell } else { y.cell }, y.cell);",
        RUNNING,
    ),
    (
        "next-event estimation counted by the cell of its lamp",
        "crates/bidir/src/path/count.rs",
        "all.next_events(y.cell)",
        "all.next_events(if t > 3 { z.cell } else { y.cell })",
        RUNNING,
    ),
    (
        "the first vertex's candidates counted for those behind it",
        "crates/bidir/src/path/running.rs",
        "share(context.count(i + 1, 3, [&walk[i], &walk[i + 1]]));",
        "share(context.count(i + 1, 2, [&walk[i], &walk[i + 1]]));",
        RUNNING,
    ),
    (
        "light images that tell of themselves alone",
        "crates/bidir/src/driver/training/trial.rs",
        "let term = value * value / (w * (1.0 - w));",
        "let term = value * value / w;",
        unit("light_images_tell"),
    ),
    (
        "what pixels differ by taken for variance",
        "crates/bidir/src/driver/training/trial.rs",
        "block.differences / block.pairs.max(1.0) + self.splat_variance(i, pixels)",
        "self.spread(i, pixels)",
        unit("what_pixels_differ_by"),
    ),
    (
        "what path tracing missed forgotten",
        "crates/bidir/src/driver/training/plan.rs",
        "            missed.beside(found)\n",
        "            0.0 * missed.beside(found)\n",
        unit("what_light_images_tell_counts"),
    ),
    (
        "correlation of the strategy at hand alone",
        "crates/bidir/src/path/count.rs",
        "MisCount::Correlated if is_shared =>",
        "MisCount::Correlated if is_shared && j == self.light.len() =>",
        PATH,
    ),
    (
        "blocked connections counted as those that arrive",
        "crates/bidir/src/path/proposals.rs",
        "*arrived += u32::from(square.is_some());",
        "*arrived += 1;",
        unit("visibility_is_what_arrives"),
    ),
    (
        "light images of fewer subpaths not made up for",
        "crates/bidir/src/integrator/light.rs",
        "path.contribution(context) * context.connections.samples_per_subpath as f32;",
        "path.contribution(context);",
        analytic("a_closed_sphere"),
    ),
    (
        "shared light subpaths counted as one in sums",
        "crates/bidir/src/path/running.rs",
        "let count = share(context.count(i + 1, 3, [&walk[i], &walk[i + 1]]));",
        "let count = 1.0;",
        RUNNING,
    ),
    (
        "chosen rays not divided by their probability",
        "crates/bidir/src/integrator/bdpt.rs",
        "candidate.contribution(chosen.prob)",
        "candidate.contribution(1.0)",
        analytic("selection_keeps"),
    ),
    (
        "paths one vertex too long",
        "crates/bidir/src/integrator/bdpt.rs",
        ".min(context.settings.max_vertices() - t);",
        ".min(context.settings.max_vertices() + 1 - t);",
        analytic("every_limit_of_depth"),
    ),
    (
        "path tracer's two densities swapped",
        "crates/bidir/src/integrator/path.rs",
        "context.settings.mis.weight_of_two(x0.pdf, p)",
        "context.settings.mis.weight_of_two(p, x0.pdf)",
        analytic("a_ring_light"),
    ),
    (
        "film filter's weight dropped",
        "crates/bidir/src/integrator/workspace.rs",
        "camera_subpath(context, &sample.camera, &ray, weight, camera, stats);",
        "camera_subpath(context, &sample.camera, &ray, 1.0, camera, stats);",
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
        "prob: prob(candidate, sum),",
        "prob: 1.0 / self.members(candidates, group).count() as f64,",
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
        "crates/bidir/src/integrator/bdpt.rs",
        "Spectrum::splat(drawn.coverage / drawn.pdf)",
        "Spectrum::splat(1.0 / drawn.pdf)",
        coverage("lamps_cut_out"),
    ),
    (
        "a cut-out lamp that the path tracer takes for whole",
        "crates/bidir/src/integrator/path.rs",
        "segment.geometry_term * x0.coverage / x0.pdf",
        "segment.geometry_term / x0.pdf",
        coverage("lamps_cut_out"),
    ),
    (
        "a cut-out lamp that light subpaths take for whole",
        "crates/bidir/src/path/walk.rs",
        "emitted * (emission.from.coverage / (start",
        "emitted * (1.0 / (start",
        coverage("lamps_cut_out"),
    ),
    (
        "one decision for all that a ray passes",
        "crates/bidir/src/scene/coverage.rs",
        "self.stream.get_for(self.dimension, surface ^ distance)",
        "self.stream.get_for(self.dimension, 0 * (surface ^ distance))",
        coverage("walls_let_through"),
    ),
    (
        "splats not weakened by what they pass",
        "crates/bidir/src/integrator/light.rs",
        "contribution: counted.whole().behind(arrives),",
        "contribution: counted.whole().behind(arrives.ceil()),",
        coverage("walls_let_through"),
    ),
]
