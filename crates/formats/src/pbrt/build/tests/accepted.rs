//! Every parameter of the format that is supported, with every type that it may have.

use super::{LENIENT, load_text};

/// A scene with textures, materials and media that the parameters below name.
const BEFORE: &str = "Camera \"perspective\" Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n\
    MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nWorldBegin\n\
    Texture \"f\" \"float\" \"constant\" \"float value\" .5\n\
    Texture \"s\" \"spectrum\" \"constant\" \"rgb value\" [.5 .5 .5]\n\
    MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
    MakeNamedMaterial \"i\" \"string type\" \"interface\"\n";

/// The ways to write a float texture, a spectrum, and a spectrum texture.
const FLOATS: &[&str] = &["\"float NAME\" .5", "\"texture NAME\" \"f\""];
const SPECTRA: &[&str] = &[
    "\"rgb NAME\" [.5 .6 .7]",
    "\"blackbody NAME\" 3000",
    "\"spectrum NAME\" [360 .5 830 .6]",
    "\"spectrum NAME\" \"illum-acesD60\"",
];
const COLORS: &[&str] = &[
    "\"rgb NAME\" [.5 .6 .7]",
    "\"spectrum NAME\" [360 .5 830 .6]",
    "\"texture NAME\" \"s\"",
];
const INDICES: &[&str] = &[
    "\"float NAME\" 1.4",
    "\"rgb NAME\" [1.4 1.5 1.6]",
    "\"spectrum NAME\" [360 1.5 830 1.6]",
    "\"spectrum NAME\" \"glass-BK7\"",
    "\"blackbody NAME\" 5000",
];

#[track_caller]
fn check_accepted(directive: &str) {
    let text = format!("{BEFORE}{directive} Shape \"sphere\" LightSource \"infinite\"");
    let loaded = load_text(&text, &LENIENT);
    assert!(
        loaded.refused.is_empty(),
        "{directive}: {:?}",
        loaded.refused
    );
}

/// Checks one directive with each of its parameters alone, in each way to write it.
#[track_caller]
fn check_each(directive: &str, parameters: &[(&str, &[&str])]) {
    for (name, ways) in parameters {
        for way in *ways {
            check_accepted(&format!("{directive} {}", way.replace("NAME", name)));
        }
    }
}

#[test]
fn parameters_of_materials_have_all_types_of_the_format() {
    const ROUGH: [(&str, &[&str]); 3] = [
        ("roughness", FLOATS),
        ("uroughness", FLOATS),
        ("vroughness", FLOATS),
    ];
    let with = |own: &[(&'static str, &'static [&'static str])]| [&ROUGH[..], own].concat();
    check_each(
        "Material \"diffuse\"",
        &[("reflectance", COLORS), ("displacement", FLOATS)],
    );
    check_each(
        "Material \"diffusetransmission\"",
        &[
            ("reflectance", COLORS),
            ("transmittance", COLORS),
            ("scale", &["\"float NAME\" 1"]),
        ],
    );
    check_each(
        "Material \"dielectric\"",
        &with(&[("eta", INDICES), ("displacement", FLOATS)]),
    );
    check_each(
        "Material \"thindielectric\"",
        &[("eta", INDICES), ("displacement", FLOATS)],
    );
    check_each(
        "Material \"conductor\"",
        &with(&[("eta", COLORS), ("k", COLORS), ("reflectance", COLORS)]),
    );
    check_each(
        "Material \"coateddiffuse\"",
        &with(&[
            ("reflectance", COLORS),
            ("thickness", FLOATS),
            ("eta", INDICES),
            ("g", FLOATS),
            ("albedo", COLORS),
        ]),
    );
    check_each(
        "Material \"coatedconductor\"",
        &[
            ("interface.roughness", FLOATS),
            ("interface.uroughness", FLOATS),
            ("interface.vroughness", FLOATS),
            ("interface.eta", INDICES),
            ("thickness", FLOATS),
            ("conductor.eta", COLORS),
            ("conductor.k", COLORS),
            ("reflectance", COLORS),
            ("conductor.roughness", FLOATS),
            ("conductor.uroughness", FLOATS),
            ("conductor.vroughness", FLOATS),
            ("g", FLOATS),
            ("albedo", COLORS),
        ],
    );
    check_each(
        "Material \"subsurface\"",
        &with(&[("eta", INDICES), ("scale", &["\"float NAME\" 2"])]),
    );
    check_each(
        "Material \"mix\" \"string materials\" [\"a\" \"i\"]",
        &[("amount", FLOATS)],
    );
    for name in ["interface", "none", ""] {
        check_accepted(&format!("Material \"{name}\""));
    }
}

#[test]
fn parameters_of_lights_have_all_types_of_the_format() {
    const POWER: &[&str] = &["\"float NAME\" 3"];
    const POINT: &[&str] = &["\"point3 NAME\" [1 2 3]"];
    for kind in ["point", "spot"] {
        let own = [
            ("I", SPECTRA),
            ("scale", POWER),
            ("power", POWER),
            ("from", POINT),
        ];
        check_each(&format!("LightSource \"{kind}\""), &own);
    }
    let spot = [
        ("to", POINT),
        ("coneangle", POWER),
        ("conedeltaangle", POWER),
    ];
    check_each("LightSource \"spot\"", &spot);
    let own = [
        ("L", SPECTRA),
        ("scale", POWER),
        ("illuminance", POWER),
        ("from", POINT),
        ("to", POINT),
    ];
    check_each("LightSource \"distant\"", &own);
    check_each("LightSource \"infinite\"", &own[..3]);
    let own = [
        ("L", SPECTRA),
        ("scale", POWER),
        ("power", POWER),
        ("twosided", &["\"bool NAME\" true"][..]),
    ];
    check_each("AreaLightSource \"diffuse\"", &own);
}

#[test]
fn parameters_of_textures_and_shapes_have_all_types_of_the_format() {
    for (class, names) in [
        ("scale", &["tex", "scale"][..]),
        ("mix", &["tex1", "tex2", "amount"]),
        ("directionmix", &["tex1", "tex2"]),
        ("checkerboard", &["tex1", "tex2"]),
        ("dots", &["inside", "outside"]),
    ] {
        for name in names {
            let texture = format!("Texture \"t\" \"float\" \"{class}\"");
            let user = "Material \"dielectric\" \"texture roughness\" \"t\"";
            for way in FLOATS {
                check_accepted(&format!("{texture} {} {user}", way.replace("NAME", name)));
            }
            let of_numbers = ["scale", "amount"].contains(name);
            let ways = if of_numbers { FLOATS } else { COLORS };
            let texture = format!("Texture \"t\" \"spectrum\" \"{class}\"");
            let user = "Material \"diffuse\" \"texture reflectance\" \"t\"";
            for way in ways {
                check_accepted(&format!("{texture} {} {user}", way.replace("NAME", name)));
            }
        }
    }
    check_each("Shape \"sphere\"", &[("alpha", FLOATS)]);
    check_each("Shape \"disk\"", &[("alpha", FLOATS)]);
    check_each("Shape \"cylinder\"", &[("alpha", FLOATS)]);
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    check_each(
        mesh,
        &[
            ("N", &["\"normal NAME\" [0 0 1 0 0 1 0 0 1]"]),
            ("S", &["\"vector3 NAME\" [1 0 0 1 0 0 1 0 0]"]),
            ("uv", &["\"point2 NAME\" [0 0 1 0 0 1]"]),
            ("indices", &["\"integer NAME\" [0 1 2]"]),
            ("faceIndices", &["\"integer NAME\" [0]"]),
            ("alpha", FLOATS),
        ],
    );
}
