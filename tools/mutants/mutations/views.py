"""Faults in cameras without a lens, in shapes, spectra and lamps that are pictures."""

from .tests import estimators, formats, unit

VIEWS = [
    (
        "a sky along parallel rays weighed against a connection that cannot be",
        "crates/bidir/src/path/densities.rs",
        "if x0.locus.is_infinite() && x1.locus.is_infinite() => 0.0,",
        "if x0.locus.is_infinite() && x1.locus.is_infinite() => x0.pdf_fwd,",
        ("bidir", "--test suite", "seen_directly::parallel_rays"),
    ),
    (
        "splats from behind the plane of parallel rays",
        "crates/bidir/src/camera/orthographic.rs",
        "(local.z > 0.0).then_some(raster)",
        "Some(raster)",
        unit("parallel_rays_see_nothing"),
    ),
    (
        "longitudes as dense at the poles as at the equator",
        "crates/bidir/src/camera/spherical.rs",
        "area / (2.0 * PI * PI * sin.max(1e-6))",
        "area / (2.0 * PI * PI) + 0.0 * sin",
        unit("the_density_of_rays_without_a_lens"),
    ),
    (
        "a lamp's picture forgotten where rays leave",
        "crates/bidir/src/light/area.rs",
        "                .radiance(context, &from.at)",
        "                .radiance",
        unit("light::tests"),
    ),
    (
        "a cylinder's area not stretched by its map",
        "crates/bidir/src/shape/cylinder.rs",
        "1.0 / (self.local_area() * self.placement.area_scale(normal))",
        "1.0 / (self.local_area() * self.placement.area_scale(Vec3::X) + 0.0 * normal.x)",
        unit("shape::tests"),
    ),
    (
        "borders of subdivided meshes to another limit",
        "crates/formats/src/pbrt/build/subdivision.rs",
        "(8.0 * smoothing(n))), 1.0 / 6.0)",
        "(8.0 * smoothing(n))), 0.2)",
        formats("subdivision"),
    ),
    (
        "lights with the magnitude of their spectrum",
        "crates/formats/src/spectra/color.rs",
        "Some((clamped / luminance).as_vec3().into())",
        "Some((clamped / luminance.min(1.0)).as_vec3().into())",
        formats("spectra"),
    ),
]
