//! Every parameter of the format that is supported, alone, with every type that it may have.

use super::{LENIENT, load_text};
use std::collections::BTreeMap;

/// A scene with textures, materials and media that the parameters name.
const BEFORE: &str = "Camera \"perspective\" Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n\
    MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nWorldBegin\n\
    Texture \"f\" \"float\" \"constant\" \"float value\" .5\n\
    Texture \"s\" \"spectrum\" \"constant\" \"rgb value\" [.5 .5 .5]\n\
    MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
    MakeNamedMaterial \"i\" \"string type\" \"interface\"\n";

#[track_caller]
fn check_accepted(directive: &str) {
    let text = format!("{BEFORE}{directive} Shape \"sphere\" LightSource \"infinite\"");
    let refused = load_text(&text, &LENIENT).refused;
    assert!(refused.is_empty(), "{directive}: {refused:?}");
}

#[test]
fn parameters_have_all_types_of_the_format() {
    let lines = include_str!("accepted.txt").lines();
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let mut ways: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for line in lines {
        if let Some((kind, all)) = line.split_once(" = ") {
            ways.insert(kind, all.split(" | ").collect());
            continue;
        }
        let Some((directive, parameters)) = line.split_once(" : ") else {
            check_accepted(line);
            continue;
        };
        for group in parameters.split("; ") {
            let (kind, names) = group.split_once(' ').expect("a type before names");
            for (name, way) in names
                .split(' ')
                .flat_map(|name| ways[kind].iter().map(move |way| (name, way)))
            {
                check_accepted(&directive.replace('@', &way.replace("NAME", name)));
            }
        }
    }
    assert!(!ways.is_empty(), "no parameters");
}
