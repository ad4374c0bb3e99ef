"""Faults at the ends of paths: in lights, cameras and where shadow rays end."""

from .tests import PATH, SUITE, unit

ENDS = [
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
        "emitted_cos: self.intensity(direction, lanes),",
        "emitted_cos: lanes.light(&self.intensity),",
        unit("light::tests"),
    ),
    (
        "half the disk around the scene",
        "crates/bidir/src/light/infinite.rs",
        "1.0 / (PI * sqr(context.radius))",
        "2.0 / (PI * sqr(context.radius))",
        unit("light::tests"),
    ),
    (
        "a sky along parallel rays weighed against a connection that cannot be",
        "crates/bidir/src/path/densities.rs",
        "if x0.locus.is_infinite() && x1.locus.is_infinite() => 0.0,",
        "if x0.locus.is_infinite() && x1.locus.is_infinite() => x0.pdf_fwd,",
        ("bidir", SUITE, "seen_directly::parallel_rays"),
    ),
    (
        "a lamp's picture forgotten where rays leave",
        "crates/bidir/src/light/area.rs",
        "emitted_cos: self.radiance(context, &from.at, lanes)",
        "emitted_cos: lanes.light(&self.radiance)",
        unit("light::tests"),
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
    (
        "the far ends of shadow rays are as exact as the near ones",
        "crates/bidir/src/locus.rs",
        "Vec3::splat(self.error) + 2.0 * f32::EPSILON * back.abs()",
        "Vec3::splat(self.error)",
        unit("no_surface_shadows_itself"),
    ),
]
