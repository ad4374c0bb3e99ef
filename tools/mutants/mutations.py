"""The list of mutants: one deliberate fault each, and the test that must notice it.

An entry is (name, file, old text, new text, test). The old text occurs exactly once in the file.
Tests are chosen to be the fastest that can notice; a test is a package, a target and a filter.
"""

PATH = ("bidir", "--test path_identities", "")
ANALYTIC = "--test analytic"
ESTIMATORS = "--test estimators"


def unit(filter_):
    """The unit tests of the `bidir` crate whose names contain `filter_`."""
    return ("bidir", "--lib", filter_)


def layers(filter_):
    """Tests of what a film keeps beside the picture."""
    return ("bidir", "--test layers", filter_)


def analytic(filter_):
    """Tests against known images."""
    return ("bidir", ANALYTIC, filter_)


def lab(filter_):
    """The unit tests of the `lab` crate whose names contain `filter_`."""
    return ("bidir-lab", "--lib", filter_)


def experiment(filter_):
    """Tests of experiments as a host runs them."""
    return ("bidir-lab", "--test experiment", filter_)


def coverage(filter_):
    """Tests of surfaces that are not all there."""
    return ("bidir-formats", "--test coverage", filter_)


def estimators(filter_):
    """Tests of estimators against each other on the torture scenes."""
    return ("bidir-formats", ESTIMATORS, filter_)


MUTATIONS = [
    # --- path: geometry and scattering ------------------------------------------------------
    (
        "cosine dropped from G",
        "crates/bidir/src/path/vertex.rs",
        "let cosines = self.abs_cos(w) * other.abs_cos(w);",
        "let cosines = self.abs_cos(w);",
        PATH,
    ),
    (
        "G without 1/d2",
        "crates/bidir/src/path/vertex.rs",
        "cosines / distance2",
        "cosines",
        PATH,
    ),
    (
        "area density without the cosine",
        "crates/bidir/src/path/scatter.rs",
        "pdf_w * cos / distance2",
        "pdf_w / distance2",
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
    # --- path: densities and weights --------------------------------------------------------
    (
        "forward and reverse density swapped",
        "crates/bidir/src/path/densities.rs",
        "            vertex.pdf_fwd * factor(context, i, before),\n"
        "            vertex.pdf_rev * factor(context, n - 1 - i, after),",
        "            vertex.pdf_rev * factor(context, i, before),\n"
        "            vertex.pdf_fwd * factor(context, n - 1 - i, after),",
        PATH,
    ),
    (
        "roulette forgotten in densities",
        "crates/bidir/src/path/densities.rs",
        "context.settings.roulette.density_factor(index - 2, albedo)",
        "context.settings.roulette.density_factor(index - 2, 1.0)",
        PATH,
    ),
    (
        "old direction at the junction",
        "crates/bidir/src/path/densities.rs",
        "x[s - 2].from_camera = z.pdf_to(context, wo, before) * survival;",
        "x[s - 2].from_camera = z.pdf_to(context, z.wo, before) * survival;",
        PATH,
    ),
    (
        "next-event density taken for the emission density",
        "crates/bidir/src/path/densities.rs",
        "LightPointChoice::Shared || n == 2;",
        "LightPointChoice::Shared || n >= 2;",
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
        analytic("white_objects"),
    ),
    (
        "Dirac lights counted as if they could be hit",
        "crates/bidir/src/path/mis.rs",
        "0 => !path.light_is_delta,",
        "0 => true,",
        estimators("point_spot_distant"),
    ),
    (
        "n_j of the light image is one",
        "crates/bidir/src/path/connect.rs",
        "1 => self.scene.film().light_paths() as f64,",
        "1 => 1.0,",
        PATH,
    ),
    (
        "light choice left out of next-event estimation",
        "crates/bidir/src/path/connect.rs",
        "Spectrum::splat(sample.coverage / (prob * sample.pdf))",
        "Spectrum::splat(sample.coverage / sample.pdf)",
        estimators("point_spot_distant"),
    ),
    (
        "survivors of roulette not raised",
        "crates/bidir/src/path/walk.rs",
        "beta: beta / survival,",
        "beta,",
        analytic("roulette_does_not"),
    ),
    (
        "a cut-out lamp that next-event estimation takes for whole",
        "crates/bidir/src/path/connect.rs",
        "Spectrum::splat(sample.coverage / (prob * sample.pdf))",
        "Spectrum::splat(1.0 / (prob * sample.pdf))",
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
        "splat.contribution = splat.contribution.behind(arrives);",
        "splat.contribution = splat.contribution.behind(arrives.ceil());",
        coverage("half_transparent"),
    ),
    (
        "mirrored instances inside out",
        "crates/bidir/src/shape/mesh.rs",
        "winding_sign: self.winding_sign * place.sign(),",
        "winding_sign: self.winding_sign,",
        ("bidir-formats", "--test objects", "geometry"),
    ),
    (
        "instances whose boxes know no rounding",
        "crates/accel/src/instance.rs",
        "let reach = half + abs_times(&world_from_object, error) + cancelled;",
        "let reach = half + 0.0 * error;",
        ("bidir-accel", "--lib", "no_hit_is_culled"),
    ),
    # --- integrators ------------------------------------------------------------------------
    (
        "sum of the group in place of C/pi",
        "crates/bidir/src/integrator/bdpt.rs",
        "            value: candidate.contribution(chosen.prob),",
        "            // Right in every grey image, wrong in colour.\n"
        "            value: {\n"
        "                let candidates = &workspace.candidates;\n"
        "                let score = |i: usize| candidates[i].score;\n"
        "                let all: f32 = (0..candidates.len()).map(score).sum();\n"
        "                let sum = candidates.iter().fold(Spectrum::ZERO, |sum, c| sum + c.value);\n"
        "                let part = score(chosen.candidate as usize) / chosen.prob as f32 / all;\n"
        "                sum * part\n"
        "            },",
        estimators("every_choice_of_shadow_rays"),
    ),
    (
        "chosen rays not divided by their probability",
        "crates/bidir/src/integrator/bdpt.rs",
        "candidate.contribution(chosen.prob)",
        "candidate.value",
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
        "context.settings.mis.weight_of_two(q, p)",
        "context.settings.mis.weight_of_two(p, q)",
        analytic("a_ring_light"),
    ),
    (
        "film filter's weight dropped",
        "crates/bidir/src/integrator/workspace.rs",
        "camera_subpath(context, &sample.camera, &ray, weight, camera, stats);",
        "camera_subpath(context, &sample.camera, &ray, 1.0, camera, stats);",
        estimators("filters_with"),
    ),
    # --- selection --------------------------------------------------------------------------
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
    # --- film and camera --------------------------------------------------------------------
    (
        "splats divided by passes",
        "crates/bidir/src/film/develop.rs",
        "fixed::to_f64(light, VALUE_SCALE) / light_paths",
        "fixed::to_f64(light, VALUE_SCALE) / self.samples()",
        unit("film::"),
    ),
    (
        "raw images with the weight",
        "crates/bidir/src/integrator/workspace.rs",
        "lane / self.weight",
        "lane",
        layers("a_raw_image"),
    ),
    (
        "environments of one escape varying one by one",
        "crates/bidir/src/driver/deposit.rs",
        "contributions.chunk_by(|a, b| a.strategy == b.strategy)",
        "contributions.chunks(1)",
        unit("driver::deposit"),
    ),
    (
        "variance of the light image as if light paths had pixels",
        "crates/bidir/src/driver/variance.rs",
        "1 => film.light_paths().max(1) as f64,",
        "1 => 1.0,",
        layers("strategies_vary"),
    ),
    (
        "contributions in the group of the light before",
        "crates/bidir/src/film/layers.rs",
        "then_some(group as usize)",
        "then_some((group as usize).saturating_sub(1))",
        layers("a_group"),
    ),
    (
        "points divided by all samples, those without a surface too",
        "crates/bidir/src/film/develop.rs",
        "Some(coverage)) => fixed::to_f64(sums[coverage], VALUE_SCALE),",
        "Some(_)) => self.samples(),",
        layers("features"),
    ),
    (
        "depth as the distance from the lens",
        "crates/bidir/src/driver/features.rs",
        "depth: (surface.point - lens.point).dot(lens.n_g),",
        "depth: (surface.point - lens.point).length(),",
        layers("features"),
    ),
    (
        "negative lobes splatted as positive",
        "crates/bidir/src/film/filter.rs",
        "sum.copysign(*value)",
        "sum",
        unit("film::filter"),
    ),
    (
        "carry lost between the limbs of a sum",
        "crates/bidir/src/film/fixed.rs",
        "let high = high.wrapping_add(carry);",
        "",
        unit("film::fixed"),
    ),
    (
        "importance without the lens's area",
        "crates/bidir/src/camera/perspective.rs",
        "self.pdf_direction(w) / (cos * self.lens_area())",
        "self.pdf_direction(w) / cos",
        PATH,
    ),
    (
        "camera density with one cosine too few",
        "crates/bidir/src/camera/perspective.rs",
        "self.raster_density / (cos * cos * cos)",
        "self.raster_density / (cos * cos)",
        unit("camera::"),
    ),
    # --- scattering models ------------------------------------------------------------------
    (
        "eta squared forgotten",
        "crates/bidir/src/bsdf/dielectric.rs",
        "TransportMode::Radiance => 1.0 / sqr(self.eta_across(wo)),",
        "TransportMode::Radiance => 1.0,",
        unit("bsdf::tests::identities"),
    ),
    (
        "eta squared forgotten in Dirac coefficients",
        "crates/bidir/src/bsdf/dielectric.rs",
        "pdf: prob * sqr(self.eta_at(wi)) * wi.z.abs(),",
        "pdf: prob * wi.z.abs(),",
        unit("bsdf::tests::identities"),
    ),
    (
        "wrong Jacobian of refraction",
        "crates/bidir/src/bsdf/dielectric.rs",
        "1.0 / sqr(wi.dot(m) + wo.dot(m) / self.eta_across(wo))",
        "1.0 / sqr(wi.dot(m) + wo.dot(m) * self.eta_across(wo))",
        unit("bsdf::tests::densities"),
    ),
    (
        "visible normals without G1",
        "crates/bidir/src/bsdf/microfacet.rs",
        "self.g1(v) * v.dot(m).abs() * self.d(m) / v.z.abs()",
        "v.dot(m).abs() * self.d(m) / v.z.abs()",
        unit("bsdf::microfacet"),
    ),
    (
        "anisotropy turned by a right angle",
        "crates/bidir/src/bsdf/microfacet.rs",
        "Vec3::new(m.x * self.alpha_x, m.y * self.alpha_y, m.z.max(1e-6)).normalize()",
        "Vec3::new(m.x * self.alpha_y, m.y * self.alpha_x, m.z.max(1e-6)).normalize()",
        unit("bsdf::tests::densities"),
    ),
    # --- lights and shapes ------------------------------------------------------------------
    (
        "wrong Jacobian of the sphere's cone",
        "crates/bidir/src/shape/sphere.rs",
        "cos / (distance2 * 2.0 * PI * height)",
        "1.0 / (distance2 * 2.0 * PI * height)",
        unit("shape::tests::directions"),
    ),
    (
        "stretch of a sphere forgotten",
        "crates/bidir/src/shape/sphere.rs",
        "        let pdf = 1.0 / (self.local_area() * self.placement.area_scale(n));",
        "        let pdf = 1.0 / self.area();",
        unit("shape::tests::points"),
    ),
    (
        "two-sided emission with the density of one side",
        "crates/bidir/src/light/area.rs",
        "warp::cosine_hemisphere_pdf(cos.abs()) / 2.0",
        "warp::cosine_hemisphere_pdf(cos.abs())",
        unit("light::tests"),
    ),
    (
        "spot without its falloff in light subpaths",
        "crates/bidir/src/light/point.rs",
        "emitted_cos: self.intensity(direction),",
        "emitted_cos: self.intensity,",
        unit("light::tests"),
    ),
    (
        "half the disk around the scene",
        "crates/bidir/src/light/infinite.rs",
        "1.0 / (PI * sqr(context.radius))",
        "2.0 / (PI * sqr(context.radius))",
        unit("light::tests"),
    ),
    # --- random numbers ---------------------------------------------------------------------
    (
        "second dimension with a step of Pascal's triangle missing",
        "crates/bidir/src/sampler/sobol.rs",
        "    x ^= (x >> 4) & 0x0f0f_0f0f_0f0f_0f0f;\n",
        "",
        unit("sampler::sobol"),
    ),
    # --- rays -------------------------------------------------------------------------------
    (
        "hits at equal distance in any order",
        "crates/accel/src/ray.rs",
        "self.t < other.t || (self.t <= other.t && id(self) < id(other))",
        "self.t < other.t || (self.t <= other.t && id(self) > id(other))",
        ("bidir-accel", "", ""),
    ),
    # --- numbers ----------------------------------------------------------------------------
    (
        "FLIP without features",
        "crates/lab/src/flip/mod.rs",
        "libm::powf(color, 1.0 - feature)",
        "libm::powf(color, 1.0 - 0.0 * feature)",
        lab("flip::tests"),
    ),
    (
        "the worst pixels rounded down",
        "crates/lab/src/metric/map.rs",
        "errors.len().div_ceil(1000)",
        "errors.len() / 1000",
        lab("metric"),
    ),
    (
        "the variance of a block as if it had one pixel",
        "crates/lab/src/statistics/welch.rs",
        "variance.sum / (variance.count * variance.count)",
        "variance.sum / variance.count",
        lab("statistics::welch"),
    ),
    (
        "bootstrap by plain percentiles",
        "crates/lab/src/statistics/bootstrap.rs",
        "normal_cdf(-(n / (n - 1.0)).sqrt() * t)",
        "(0.5 - 0.5 * confidence) * (t / t)",
        lab("statistics::bootstrap"),
    ),
    (
        "p-values without Sidak's correction",
        "crates/lab/src/statistics/welch.rs",
        "p: corrected(p, tests.len())",
        "p: corrected(p, 1)",
        lab("statistics::welch"),
    ),
    (
        "all replicates of an experiment with one seed",
        "crates/lab/src/experiment/cell.rs",
        "settings.seed = self.seed;",
        "settings.seed = 0 * self.seed;",
        experiment("every_cell"),
    ),
    (
        "equal rays with a pass too many",
        "crates/lab/src/experiment/cell.rs",
        "(next - target).abs() < (now - target).abs()",
        "next.min(target) > 0.0 && now < target * 1.2",
        experiment("equal_rays"),
    ),
    (
        "training that costs no rays",
        "crates/lab/src/experiment/cell.rs",
        "training.map_or(0, |training| training.rays.total())",
        "training.map_or(0, |training| 0 * training.rays.total())",
        experiment("training"),
    ),
    (
        "records of another experiment gone on from",
        "crates/lab/src/experiment/run.rs",
        "spec.name,\n            stage.digest,",
        "spec.name,\n            0,",
        experiment("another_experiment"),
    ),
    (
        "ratios of other seeds",
        "crates/lab/src/experiment/analysis/mod.rs",
        "b.iter().find(|b| b.seed == a.seed)?",
        "b.iter().find(|b| b.seed != a.seed)?",
        lab("analysis"),
    ),
    (
        "both estimators of a reference with the same seeds",
        "crates/lab/src/reference/make.rs",
        "settings.seed.wrapping_mul(2).wrapping_add(index)",
        "settings.seed.wrapping_mul(2).wrapping_add(0 * index)",
        lab("reference::tests"),
    ),
    (
        "all replicates of a reference with the same seed",
        "crates/lab/src/reference/replicate.rs",
        "seed: self.settings.seed.wrapping_add(replicate),",
        "seed: self.settings.seed.wrapping_add(0 * replicate),",
        lab("reference::tests"),
    ),
    (
        "references whose estimators disagree are taken",
        "crates/lab/src/reference/provenance.rs",
        "if *agree && *p >= LEVEL {",
        "if *agree || *p < LEVEL {",
        lab("reference::tests"),
    ),
    (
        "a reference is that of any scene",
        "crates/lab/src/reference/provenance.rs",
        "if self.scene_digest != digest {",
        "if self.scene_digest.len() != digest.len() {",
        lab("reference::tests"),
    ),
]
