"""Faults in what scenes are made of, in random numbers and in rays."""

from .tests import ESTIMATORS, SUITE, layers, reader, unit

SCENES = [
    # --- where a scene is rendered --------------------------------------------------------
    (
        "distant scenes are rendered where they are",
        "crates/formats/src/import/space.rs",
        "_ if is_beyond(centre, FAR * half) => rounded(centre, half),",
        "_ if is_beyond(centre, FAR * half) => DVec3::ZERO,",
        ("bidir-formats", ESTIMATORS, "places::far_away"),
    ),
    (
        "intensities keep the unit of the world",
        "crates/bidir/src/scene/space.rs",
        "(f64::from(intensity) / (self.unit * self.unit)) as f32",
        "(f64::from(intensity) / self.unit) as f32",
        reader("tests::places"),
    ),
    (
        "positions are those of the space that is rendered in",
        "crates/bidir/src/driver/features.rs",
        "point: space.world_point(surface.locus.point).as_vec3(),",
        "point: surface.locus.point,",
        layers("layers::plane"),
    ),
    # --- scattering models ----------------------------------------------------------------
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
    # --- lights and shapes ----------------------------------------------------------------
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
    # --- random numbers -------------------------------------------------------------------
    (
        "second dimension with a step of Pascal's triangle missing",
        "crates/bidir/src/sampler/sobol.rs",
        "    x ^= (x >> 4) & 0x0f0f_0f0f_0f0f_0f0f;\n",
        "",
        unit("sampler::sobol"),
    ),
    (
        "second dimension of the digital shift without Pascal's triangle",
        "crates/bidir/src/sampler/sobol.rs",
        "        let [index, shift] = halves(pascal(self.indices));\n",
        "        let ([index, _], [_, shift]) = (halves(pascal(self.indices)), halves(self.indices));\n",
        unit("sampler::"),
    ),
    (
        "pixel filter with the nearest value of its table",
        "crates/bidir/src/film/filter.rs",
        "        from + (to - from) * (place - i as f32)\n",
        "        from + (to - from) * (place - i as f32).round()\n",
        unit("film::filter"),
    ),
    # --- rays -----------------------------------------------------------------------------
    (
        "hits at equal distance in any order",
        "crates/accel/src/ray.rs",
        "self.t < other.t || (self.t <= other.t && id(self) < id(other))",
        "self.t < other.t || (self.t <= other.t && id(self) > id(other))",
        ("bidir-accel", "", ""),
    ),
    (
        "leaves of a ray in step visited by its neighbour",
        "crates/accel/src/lockstep.rs",
        "let place = usize::from(place) % RAYS;",
        "let place = usize::from(place ^ 1) % RAYS;",
        ("bidir-accel", SUITE, "many::"),
    ),
    (
        "a ray in step that is blocked goes on as if it were not",
        "crates/accel/src/lockstep.rs",
        "let is_blocked = found >> number & 1 == 1;",
        "let is_blocked = found >> number & 1 == 1 && !stack.is_empty();",
        ("bidir-accel", SUITE, "many::"),
    ),
    (
        "large groups without their first part",
        "crates/accel/src/builder/group.rs",
        "for part in &parts {",
        "for part in &parts[1..] {",
        ("bidir-accel", SUITE, "bits::threads_do_not_matter"),
    ),
    (
        "subtrees with the blocks of the first",
        "crates/accel/src/builder.rs",
        "Child::triangles(&(leaf.start + blocks..leaf.end + blocks))",
        "Child::triangles(&leaf)",
        ("bidir-accel", SUITE, "bits::threads_do_not_matter"),
    ),
    # --- instances ---------------------------------------------------------------------------
    (
        "mirrored instances inside out",
        "crates/bidir/src/shape/mesh.rs",
        "winding_sign: self.winding_sign * place.sign(),",
        "winding_sign: self.winding_sign,",
        ("bidir-formats", SUITE, "objects::shared_objects"),
    ),
    (
        "instances whose boxes know no rounding",
        "crates/accel/src/instance.rs",
        "let reach = half + abs_times(&world_from_object, error) + cancelled;",
        "let reach = half + 0.0 * error;",
        ("bidir-accel", "--lib", "no_hit_is_culled"),
    ),
]
