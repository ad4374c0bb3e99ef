"""Faults in films and cameras."""

from .tests import PATH, layers, unit

PICTURES = [
    (
        "splats divided by passes",
        "crates/bidir/src/film/develop.rs",
        "fixed::to_f64(light, VALUE_SCALE) / light_paths",
        "fixed::to_f64(light, VALUE_SCALE) / self.samples()",
        unit("film::"),
    ),
    (
        "raw images with the weight",
        "crates/bidir/src/contribution.rs",
        "self.arriving(self.term.contribution)",
        "self.arriving(self.term.value())",
        layers("a_raw_image"),
    ),
    (
        "contributions of one strategy varying one by one",
        "crates/bidir/src/driver/deposit.rs",
        "sums.iter_mut().find(|(known, _)| *known == place)",
        "sums.iter_mut().find(|_| false)",
        unit("driver::deposit"),
    ),
    (
        "contributions of one strategy varying together where they are neighbours alone",
        "crates/bidir/src/driver/deposit.rs",
        "sums.iter_mut().find(|(known, _)| *known == place)",
        "sums.last_mut().filter(|(known, _)| *known == place)",
        unit("driver::deposit"),
    ),
    (
        "variance of the light image as if light paths had pixels",
        "crates/bidir/src/driver/variance.rs",
        "let pixels = film.light_paths().max(1) as f64;",
        "let pixels = 1.0;",
        layers("strategies_vary"),
    ),
    (
        "variance of the light image as if no samples shared light paths",
        "crates/bidir/src/driver/variance.rs",
        "(pixels, self.counts().light_subpaths)",
        "(pixels, pixels)",
        layers("light_images_of_one_path"),
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
        "space.world_length(context.job.view.camera().depth(surface.locus.point))",
        "space.world_length(surface.locus.point.length())",
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
        "crates/bidir/src/math/fixed.rs",
        "let high = high.wrapping_add(carry);",
        "",
        unit("math::fixed"),
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
]
