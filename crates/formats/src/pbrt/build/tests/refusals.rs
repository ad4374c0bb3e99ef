use super::{LENIENT, check, check_world, load_text, world};

#[test]
fn wrong_parameters_are_errors() {
    check(
        "Camera \"perspective\" \"float fvo\" 3 WorldBegin",
        "s.pbrt:1:22: unknown parameter `fvo` of `perspective`; did you mean `fov`?",
    );
    check(
        "Camera \"perspective\" \"integer fov\" 3 WorldBegin",
        "s.pbrt:1:22: `fov` is not of type `integer`; write `float fov`",
    );
    check(
        "Camera \"perspective\" \"float fov\" [3 4] WorldBegin",
        "s.pbrt:1:34: `fov` has one value, found 2",
    );
    check(
        "Camera \"perspective\" \"float fov\" 190 WorldBegin",
        "s.pbrt:1:34: `fov` is 190, but must be between 0.001 and 179.999",
    );
    check(
        "WorldBegin Shape \"sphere\" \"float radius\" -1e-30",
        "s.pbrt:1:42: `radius` is -1e-30, but must be above 0",
    );
    check(
        "Camera \"perspective\" \"float shutterclose\" 0 WorldBegin",
        "s.pbrt:1:8: the shutter closes before it opens",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" -3 WorldBegin",
        "s.pbrt:1:34: `xresolution` is -3, but must be at least 1",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" 100000 WorldBegin",
        "s.pbrt:1:34: the film has 100000 × 720 pixels; each side can have 1 to 65536",
    );
    check(
        "Film \"rgb\" \"float cropwindow\" [0 1 0.5 0.5] WorldBegin",
        "s.pbrt:1:6: the crop leaves no pixels of the film",
    );
    check(
        "Film \"rgb\" \"integer pixelbounds\" [0 1 2] WorldBegin",
        "s.pbrt:1:34: `pixelbounds` needs left, right, top and bottom of a part of the film",
    );
    check(
        "Sampler \"sobol\" \"integer pixelsamples\" 0 WorldBegin",
        "s.pbrt:1:40: `pixelsamples` is 0, but must be at least 1",
    );
}

#[test]
fn wrong_worlds_are_errors() {
    check_world(
        "Material \"diffuse\" \"rgb reflectance\" [1 2 1]",
        "s.pbrt:2:38: the reflectance `reflectance` is above 1",
    );
    check_world(
        "Material \"diffuse\" \"rgb reflectance\" [0 -1 0]",
        "s.pbrt:2:38: the colour `reflectance` has a negative component",
    );
    check_world(
        "Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"diffuse\" \"texture \
         reflectance\" \"wod\"",
        "s.pbrt:3:42: unknown spectrum texture `wod`; did you mean `wood`?",
    );
    check_world(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"\n\
         Material \"diffuse\" \"texture reflectance\" \"t\"",
        "s.pbrt:2:53: cannot open `no.png`: no such file",
    );
    check_world(
        "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"rgb k\" [1 1 1]",
        "s.pbrt:2:10: a conductor has `reflectance` or `eta` and `k`, not both",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
        "s.pbrt:2:71: there is no point 3: the mesh has 3",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0]",
        "s.pbrt:2:7: the parameter `integer indices` is missing",
    );
    check_world(
        "Shape \"plymesh\" \"string filename\" \"no.ply\"",
        "s.pbrt:2:35: cannot open `no.ply`: no such file",
    );
    check_world(
        "LightSource \"distant\" \"point3 to\" [0 0 0]",
        "s.pbrt:2:13: `from` and `to` of the light are the same point",
    );
}

#[test]
fn unsupported_features_are_refused_by_name() {
    check_world(
        "Material \"hair\" Shape \"sphere\"",
        "s.pbrt:2:10: the material `hair` is not supported; \
         with --lenient, `diffuse` with reflectance 0.5 is used instead",
    );
    check_world(
        "Texture \"t\" \"float\" \"ptex\"\n\
         Material \"conductor\" \"texture roughness\" \"t\" Shape \"sphere\"",
        "s.pbrt:2:21: the texture class `ptex` is not supported; \
         with --lenient, 0.5 is used instead",
    );
    check_world(
        "Shape \"curve\"",
        "s.pbrt:2:7: the shape `curve` is not supported; \
         with --lenient, it is left out",
    );
    check(
        "Integrator \"mlt\" \"integer chains\" 3 WorldBegin",
        "s.pbrt:1:12: the integrator `mlt` is not supported; \
         with --lenient, `bdpt` is used instead",
    );
}

#[test]
fn with_leniency_unsupported_features_are_replaced_and_counted() {
    let loaded = load_text(
        "Integrator \"sppm\" WorldBegin\nMaterial \"hair\"\n\
         Shape \"sphere\" Shape \"curve\" Shape \"curve\"\nMaterial \"interface\" Shape \"sphere\"",
        &LENIENT,
    );
    assert_eq!((loaded.summary.shapes, loaded.summary.materials), (1, 2));
    assert_eq!(
        loaded.warnings,
        [
            "s.pbrt:1:12: the integrator `sppm` is not supported: `bdpt` is used instead",
            "s.pbrt:2:10: the material `hair` is not supported: `diffuse` with reflectance 0.5 \
             is used instead",
            "s.pbrt:3:22: the shape `curve` is not supported: it is left out (2 times)",
        ]
    );
}

#[test]
fn unused_unsupported_features_are_no_errors() {
    let unused = "Texture \"marble\" \"spectrum\" \"ptex\" \"float scale\" 3\n\
        Texture \"bumps\" \"float\" \"ptex\"\n\
        Texture \"ball\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\" \"string mapping\" \"spherical\"\n\
        Texture \"gone\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"\n\
        Material \"hair\" Material \"diffuse\" \"texture reflectance\" \"marble\"\n\
        Material \"diffuse\" Shape \"sphere\"";
    assert_eq!(world(unused).materials().len(), 2);
    // They are not replaced either.
    let lenient = load_text(&format!("WorldBegin {unused}"), &LENIENT);
    assert_eq!(lenient.warnings, [""; 0]);
}

#[test]
fn unused_invalid_features_are_errors() {
    check_world(
        "Texture \"t\" \"spectrum\" \"constant\" \"rgb valeu\" [1 1 1]",
        "s.pbrt:2:35: unknown parameter `valeu` of `constant`; did you mean `value`?",
    );
    check_world(
        "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"t.png\" \"string wrap\" \
         \"round\"",
        "s.pbrt:2:72: unknown wrap mode `round`",
    );
    check_world(
        "Material \"diffuse\" \"rgb reflectence\" [1 1 1]",
        "s.pbrt:2:20: unknown parameter `reflectence` of `diffuse`; did you mean `reflectance`?",
    );
}
