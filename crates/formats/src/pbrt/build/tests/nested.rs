//! The parameter `priority`: volumes within each other, and what it cannot be given to.
//!
//! A camera of parallel rays looks along z through balls of index 1 at a sky of radiance 1.

use super::*;
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;

/// Media that keep a half and a quarter of light over a length of 1.
const MEDIA: &str = "\
    MakeNamedMedium \"half\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0 0 0] \
        \"rgb sigma_a\" [.6931472 .6931472 .6931472] \
    MakeNamedMedium \"quarter\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0 0 0] \
        \"rgb sigma_a\" [1.3862944 1.3862944 1.3862944] \
    LightSource \"infinite\" \"rgb L\" [1 1 1] ";

/// A ball of a medium, whose material has these parameters.
fn ball(medium: &str, parameters: &str, [z, radius]: [f32; 2]) -> String {
    format!(
        "AttributeBegin MediumInterface \"{medium}\" \"\" \
         Material \"dielectric\" \"float eta\" 1 {parameters} \
         Translate 0 0 {z} Shape \"sphere\" \"float radius\" {radius} AttributeEnd "
    )
}

fn priority(of: i32) -> String {
    format!("\"integer priority\" {of}")
}

fn load_balls(balls: &str) -> Loaded {
    let text = format!(
        "LookAt 0 0 -9 0 0 0 0 1 0 Camera \"orthographic\" \"float screenwindow\" \
         [-.001 .001 -.001 .001] Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 \
         WorldBegin {MEDIA} {balls}"
    );
    load_text(&text, &STRICT)
}

#[track_caller]
fn check_light(balls: &str, expected: f32) {
    let loaded = load_balls(balls);
    let (mut settings, resources) = (Settings::new(IntegratorKind::Path), Resources::default());
    settings.path.max_depth = Some(32);
    let session = Session::new(&loaded.scene, &loaded.view, settings, &resources);
    let mut session = session.expect("a small film");
    session.step(&());
    let light = session.film().develop().pixels[0][0];
    assert!(
        (light / expected - 1.0).abs() < 1e-3,
        "{light}, not {expected}"
    );
}

/// What is left of light over lengths of both media.
fn left(half: f32, quarter: f32) -> f32 {
    libm::powf(0.5, half) * libm::powf(0.25, quarter)
}

#[test]
fn the_higher_priority_fills_what_volumes_share() {
    let both = |a: i32, b: i32| {
        ball("half", &priority(a), [0.0, 1.0]) + &ball("quarter", &priority(b), [1.0, 1.0])
    };
    check_light(&both(2, 1), left(2.0, 1.0));
    check_light(&both(1, 2), left(1.0, 2.0));
    check_light(&both(-2, -1), left(1.0, 2.0));
}

#[test]
fn a_volume_of_higher_priority_hides_what_is_within_it() {
    let both = |outer: i32| {
        ball("half", &priority(outer), [0.0, 2.0]) + &ball("quarter", &priority(1), [0.0, 1.0])
    };
    check_light(&both(0), left(2.0, 2.0));
    check_light(&both(2), left(4.0, 0.0));
    // Of equal priorities the smaller fills it.
    check_light(&both(1), left(2.0, 2.0));
}

#[test]
fn shapes_of_one_material_bound_one_volume() {
    let inwards =
        ball("half", &priority(1), [0.0, 0.5]).replace("Translate", "ReverseOrientation Translate");
    let glass = "MakeNamedMaterial \"glass\" \"string type\" \"dielectric\" \"float eta\" 1 \
                 \"integer priority\" 1 NamedMaterial \"glass\" MediumInterface \"half\" \"\" ";
    let shell = format!(
        "{glass} Shape \"sphere\" AttributeBegin ReverseOrientation Shape \"sphere\" \
         \"float radius\" .5 AttributeEnd "
    );
    check_light(&shell, left(1.0, 0.0));
    let within = ball("quarter", &priority(0), [0.0, 0.75]);
    check_light(&(shell + &within), left(1.0, 1.0));
    let pair = format!("{glass} Shape \"sphere\" Translate 0 0 1 Shape \"sphere\" ");
    check_light(&pair, left(3.0, 0.0));
    assert!(load_balls(&inwards).warnings[0].contains("enclose nothing"));
}

#[test]
fn instances_of_volumes_nest_too() {
    let object = format!(
        "ObjectBegin \"two\" {}{} ObjectEnd",
        ball("half", &priority(1), [0.0, 1.0]),
        ball("quarter", &priority(2), [0.0, 0.5]),
    );
    let placed = "ObjectInstance \"two\" Translate 0 0 3 ObjectInstance \"two\"";
    check_light(&format!("{object} {placed}"), left(2.0, 2.0));
}

/// A boundary of media within a volume is none: the volume fills the place, and names the medium behind it.
#[test]
fn boundaries_within_a_volume_count_for_nothing() {
    let fog = "AttributeBegin MediumInterface \"quarter\" \"\" Material \"interface\" \
               Translate 0 0 1 Shape \"sphere\" AttributeEnd ";
    let glass = ball("half", &priority(1), [0.0, 1.0]) + &ball("half", &priority(2), [-0.5, 0.25]);
    check_light(&(glass + fog), left(2.0, 0.0));
}

#[test]
fn without_a_priority_the_file_names_media_and_index() {
    let balls = ball("half", "", [0.0, 2.0]) + &ball("quarter", "", [0.0, 1.0]);
    // Behind the inner ball, the file has the vacuum.
    check_light(&balls, left(1.0, 2.0));
}
