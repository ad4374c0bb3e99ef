"""Faults in layered and mixed materials, and in what Dirac lobes beside others mean to weights."""

from .tests import RUNNING, materials, unit

MATERIALS = [
    # --- layered and mixed materials ----------------------------------------------------------
    (
        "a Dirac lobe of a walk not told to weights",
        "crates/bidir/src/path/densities.rs",
        "                from_camera: drawn,\n                is_delta: x.went_by_delta,",
        "                from_camera: drawn,\n                is_delta: false,",
        RUNNING,
    ),
    (
        "an end that is connected taken for Dirac",
        "crates/bidir/src/path/densities.rs",
        "(x[s - 1].is_delta, x[s].is_delta) = (false, false);",
        "",
        RUNNING,
    ),
    (
        "the path tracer weighs hits by a Dirac lobe against next-event estimation",
        "crates/bidir/src/integrator/stages/direct.rs",
        "from.went_by_delta {",
        "from.is_delta() {",
        materials("a_smooth_varnish"),
    ),
    (
        "a varnish's base drawn without its probability",
        "crates/bidir/src/bsdf/coated_diffuse.rs",
        "prob * densities[from] + (1.0 - prob) * base",
        "prob * densities[from] + base",
        unit("samples_follow_the_density"),
    ),
    (
        "a curve at the second cosine with the sums of the first",
        "crates/bidir/src/bsdf/coat/curve.rs",
        "sums.z + s[1] * sums.w",
        "sums.x + s[1] * sums.y",
        unit("a_curve_is_the_sum"),
    ),
    (
        "odd polynomials of a curve summed like even ones",
        "crates/bidir/src/bsdf/coat/curve.rs",
        "Vec4::new(u[0], 1.0, u[1], 1.0)",
        "Vec4::new(u[0], u[0], u[1], u[1])",
        unit("a_curve_is_the_sum"),
    ),
    (
        "the way back from a varnish as likely as the way in",
        "crates/bidir/src/bsdf/coated_diffuse.rs",
        "pdf_reverse: pdf(1, wo)",
        "pdf_reverse: pdf(0, wi)",
        unit("light_flows_both_ways"),
    ),
    (
        "radiance within a varnish not compressed",
        "crates/bidir/src/bsdf/coated_diffuse.rs",
        "rho * all_orders(rho * trip) * INV_PI / sqr(coat.eta())",
        "rho * all_orders(rho * trip) * INV_PI",
        unit("a_varnish_reflects"),
    ),
    (
        "directions within a lacquer without their Jacobian",
        "crates/bidir/src/bsdf/coated_conductor.rs",
        "pdf * stretch(wi, inner_i)",
        "pdf",
        unit("samples_follow_the_density"),
    ),
    (
        "a varnish loses what its interface throws back",
        "crates/bidir/src/bsdf/coat/mod.rs",
        "1.0 / (1.0 - x.min(0.9999))",
        "1.0 + 0.0 * x",
        unit("a_varnish_reflects"),
    ),
    (
        "light thrown back within a layer absorbed on one way only",
        "crates/bidir/src/bsdf/coat/filled.rs",
        "part * left(w.z) * left(back.z)",
        "part * left(w.z)",
        unit("a_varnish_reflects"),
    ),
    (
        "a lane without light in the mean of a layer's tables",
        "crates/bidir/src/material/coated.rs",
        "lanes.carrying().map(|lane| filled[lane])",
        "filled.iter().copied()",
        unit("a_haze_looks_the_same"),
    ),
    (
        "what a layer scatters before it reaches the base forgotten",
        "crates/bidir/src/bsdf/coated_diffuse.rs",
        "if !self.thrown.is_black() {",
        "if false && !self.thrown.is_black() {",
        unit("a_layer_that_scatters_reflects"),
    ),
    (
        "a pane with one reflection",
        "crates/bidir/src/bsdf/thin_dielectric.rs",
        "2.0 * once / (1.0 + once)",
        "once",
        unit("a_pane_reflects"),
    ),
    (
        "a mixture within a mixture chooses by the same number",
        "crates/bidir/src/material/mod.rs",
        "material.choose(at, || rest.clamp(0.0, ONE_MINUS_EPSILON))",
        "material.choose(at, || u)",
        materials("a_mixture_is_its_parts"),
    ),
]
