//! The exact messages of errors.

use crate::pbrt::parse_text;
use miette::{GraphicalReportHandler, GraphicalTheme};

#[track_caller]
fn check(text: &str, expected: &str) {
    let error = parse_text("s.pbrt", text).expect_err("the text is broken");
    assert_eq!(error.to_string(), expected);
}

/// Checks the error of `text` after `WorldBegin` on the first line.
#[track_caller]
fn check_world(text: &str, expected: &str) {
    check(&format!("WorldBegin\n{text}"), expected);
}

#[test]
fn grammar() {
    check("[ 1 ]", "s.pbrt:1:1: expected a directive, found `[`");
    check(
        "\"x\"",
        "s.pbrt:1:1: expected a directive, found the string \"x\"",
    );
    check(
        "Camra \"perspective\"",
        "s.pbrt:1:1: unknown directive `Camra`; did you mean `Camera`?",
    );
    check(
        "worldbegin",
        "s.pbrt:1:1: unknown directive `worldbegin`; did you mean `WorldBegin`?",
    );
    check("Quux", "s.pbrt:1:1: unknown directive `Quux`");
    check(
        "Film",
        "s.pbrt:1:1: expected a type, found the end of the file",
    );
    check(
        "Film rgb",
        "s.pbrt:1:6: expected a type in quotes, found `rgb`",
    );
    check(
        "Camera \"perspective\" \"fov\" 45",
        "s.pbrt:1:22: expected a parameter `\"type name\"`, found \"fov\"",
    );
    check(
        "Camera \"perspective\" \"flot fov\" 45",
        "s.pbrt:1:22: unknown parameter type `flot`; did you mean `float`?",
    );
    check(
        "Camera \"perspective\" \"float fov\" 45x",
        "s.pbrt:1:34: expected a number, found `45x`",
    );
    check(
        "Camera \"perspective\" \"float fov\" nan",
        "s.pbrt:1:34: expected a number, found `nan`",
    );
    check(
        "Camera \"perspective\" \"float fov\" 1e39",
        "s.pbrt:1:34: the number `1e39` is too large",
    );
    check(
        "Camera \"perspective\" \"float fov\" [[1]]",
        "s.pbrt:1:35: brackets do not nest",
    );
    check(
        "Camera \"perspective\" \"float fov\" \"a\"",
        "s.pbrt:1:34: expected a number, found the string \"a\"",
    );
    check(
        "Camera \"perspective\" \"float fov\" [ 4",
        "s.pbrt:1:36: expected a value of `float fov` or `]`, found the end of the file",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" 5.0",
        "s.pbrt:1:34: expected an integer of 32 bits, found `5.0`",
    );
    check(
        "Film \"rgb\" \"integer xresolution\" 9999999999",
        "s.pbrt:1:34: expected an integer of 32 bits, found `9999999999`",
    );
    check(
        "Film \"rgb\" \"bool savefp16\" yes",
        "s.pbrt:1:28: expected `true` or `false`, found `yes`",
    );
    check(
        "Film \"rgb\" \"string filename\" a.png",
        "s.pbrt:1:30: expected a string in quotes, found `a.png`",
    );
    check(
        "Film \"rgb\" \"string filename\" \"a\n\"",
        "s.pbrt:1:30: the string does not end on its line; add the closing `\"`",
    );
}

/// An unclosed string ends where the next one begins.
#[test]
fn closing_quotes() {
    check(
        "Film \"rgb \"integer xresolution\" 5",
        "s.pbrt:1:6: the string has no closing quote; write `\"rgb\"`",
    );
    check(
        "Camera \"perspective\" \"float fov 45 \"float frameaspectratio\" 1",
        "s.pbrt:1:22: the string has no closing quote; write `\"float fov 45\"`",
    );
}

#[test]
fn transformations() {
    check(
        "Translate 1 2",
        "s.pbrt:1:13: expected a number, found the end of the file",
    );
    check(
        "Translate [1 2 3]",
        "s.pbrt:1:11: expected a number, found `[`",
    );
    check("Transform 1 0 0", "s.pbrt:1:11: expected `[`, found `1`");
    check(
        "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0]",
        "s.pbrt:1:44: expected `]` after 16 numbers, found `0`",
    );
    check(
        "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]",
        "s.pbrt:1:1: `Transform`: the numbers 4, 8 and 12 of a matrix must be 0 and its last \
         must not: perspective is not allowed",
    );
    check(
        "Rotate 90 0 0 0",
        "s.pbrt:1:1: `Rotate`: the axis of a rotation must not be zero",
    );
    check(
        "LookAt 0 0 0  0 1 0  0 1 0",
        "s.pbrt:1:1: `LookAt`: the up vector must not be zero or parallel to the view",
    );
    check(
        "ActiveTransform Both",
        "s.pbrt:1:17: expected `All`, `StartTime` or `EndTime`, found `Both`",
    );
    check_world(
        "Scale 1 0 1\nShape \"sphere\"",
        "s.pbrt:3:7: the current transformation is not invertible; look for a scale by zero or \
         numbers out of range",
    );
}

#[test]
fn blocks() {
    check(
        "",
        "s.pbrt:1:1: the file ends without `WorldBegin`; put it before the first shape, light or \
         material",
    );
    check(
        "Shape \"sphere\"",
        "s.pbrt:1:1: `Shape` stands before `WorldBegin`",
    );
    check_world(
        "Film \"rgb\"",
        "s.pbrt:2:1: `Film` stands after `WorldBegin`",
    );
    check_world(
        "WorldBegin",
        "s.pbrt:2:1: `WorldBegin` stands after `WorldBegin`",
    );
    check_world(
        "AttributeBegin",
        "s.pbrt:2:1: `AttributeBegin` is never closed; `AttributeEnd` is missing",
    );
    check_world(
        "AttributeEnd",
        "s.pbrt:2:1: `AttributeEnd` without `AttributeBegin`",
    );
    check_world(
        "AttributeBegin\nObjectBegin \"o\"\nAttributeEnd",
        "s.pbrt:4:1: `AttributeEnd` closes the `ObjectBegin` of line 3; `ObjectEnd` is missing",
    );
    check_world(
        "Material \"difuse\"",
        "s.pbrt:2:10: unknown material `difuse`; did you mean `diffuse`?",
    );
    check_world("Shape \"torus\"", "s.pbrt:2:7: unknown shape `torus`");
    check_world(
        "LightSource \"infnite\"",
        "s.pbrt:2:13: unknown light source `infnite`; did you mean `infinite`?",
    );
}

#[test]
fn definitions() {
    check_world(
        "MakeNamedMaterial \"Glass\" \"string type\" \"dielectric\"\nNamedMaterial \"Glas\"",
        "s.pbrt:3:15: unknown material `Glas`; did you mean `Glass`?",
    );
    check_world(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"a\" \"string \
         type\" \"diffuse\"",
        "s.pbrt:3:19: the material `a` is defined a second time",
    );
    check_world(
        "MakeNamedMaterial \"a\"",
        "s.pbrt:2:19: the parameter `string type` is missing",
    );
    check_world(
        "MakeNamedMaterial \"a\" \"string type\" [\"x\" \"y\"]",
        "s.pbrt:2:37: `string type` has one value",
    );
    check_world(
        "ObjectInstance \"chair\"",
        "s.pbrt:2:16: unknown object `chair`",
    );
    check_world(
        "ObjectBegin \"a\" ObjectBegin \"b\"",
        "s.pbrt:2:29: an object is defined within an object",
    );
    check_world(
        "ObjectBegin \"a\" ObjectEnd ObjectBegin \"a\" ObjectEnd",
        "s.pbrt:2:39: the object `a` is defined a second time",
    );
    check_world(
        "ObjectBegin \"a\" ObjectInstance \"a\"",
        "s.pbrt:2:32: an object is placed within an object",
    );
    let texture = "Texture \"t\" \"float\" \"constant\"";
    check_world(
        &format!("{texture} {texture}"),
        "s.pbrt:2:40: the texture `t` is defined a second time",
    );
    check_world(
        "Shape \"trianglemesh\" \"point3 P\" [0 1]",
        "s.pbrt:2:33: `point3 P` takes 3 numbers a value, found 2 in all",
    );
    check(
        "ColorSpace \"sRBG\"",
        "s.pbrt:1:12: unknown colour space `sRBG`; did you mean `srgb`?",
    );
    check(
        "Option \"sed\" 3",
        "s.pbrt:1:8: unknown option `sed`; did you mean `seed`?",
    );
    check(
        "Attribute \"shapes\"",
        "s.pbrt:1:11: unknown target `shapes` of an attribute; did you mean `shape`?",
    );
    check(
        "Include \"no.pbrt\"",
        "s.pbrt:1:9: cannot open `no.pbrt`: no such file",
    );
}

#[test]
fn version_3_is_recognised_by_its_marks() {
    let check = |text: &str, expected: &str| {
        let end = ", or convert the file with `pbrt --upgrade`";
        check(text, &format!("s.pbrt:{expected}{end}"));
    };
    check(
        "Film \"image\"",
        "1:6: this is a pbrt-v3 file: the film `image` is not part of version 4; write `rgb`, \
         and `iso` = 100·scale for `scale`",
    );
    check(
        "WorldBegin\nWorldEnd",
        "2:1: this is a pbrt-v3 file: `WorldEnd` is not part of version 4; leave it out: the \
         world ends with the file",
    );
    check(
        "PixelFilter \"box\" \"float xwidth\" 1",
        "1:19: this is a pbrt-v3 file: the parameter `xwidth` is not part of version 4; write \
         `xradius`",
    );
    check(
        "WorldBegin Material \"matte\"",
        "1:21: this is a pbrt-v3 file: the material `matte` is not part of version 4; write \
         `diffuse`, and `reflectance` for `Kd`",
    );
    check(
        "WorldBegin LightSource \"point\" \"color I\" [1 1 1]",
        "1:32: this is a pbrt-v3 file: the parameter type `color` is not part of version 4; \
         write `rgb`",
    );
    check(
        "Film \"rgb\" \"bool savefp16\" \"true\"",
        "1:28: this is a pbrt-v3 file: a quoted truth value is not part of version 4; write true \
         or false without quotes",
    );
}

#[test]
fn the_fancy_report_marks_the_place() {
    let text = "WorldBegin\n# walls\nMaterial \"difuse\" # red\nShape \"sphere\"\n";
    let error = parse_text("box.pbrt", text).unwrap_err();
    let mut report = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .render_report(&mut report, &error)
        .unwrap();
    let expected = "  × box.pbrt:3:10: unknown material `difuse`; did you mean `diffuse`?
   ╭─[box.pbrt:3:10]
 2 │ # walls
 3 │ Material \"difuse\" # red
   ·          ────────
 4 │ Shape \"sphere\"
   ╰────
";
    assert_eq!(report, expected);
}
