//! Images: look-up, borders, smaller copies.

use super::super::*;
use super::{at, check, seen};
use crate::math::{Vec2, square_to_direction};
use crate::testing::{check_near, prelude::image_map};

fn map(wrap: Wrap, filter: ImageFilter) -> ImageMap<1> {
    let texels = vec![[1.0], [2.0], [3.0], [4.0]];
    ImageMap {
        wrap,
        ..image_map(2, texels, filter)
    }
}

#[test]
fn the_top_row_is_at_v_one() {
    let point = map(Wrap::all(Beyond::Repeat), ImageFilter::Point);
    for ([u, v], expected) in [
        ([0.25, 0.75], 1.0),
        ([0.75, 0.75], 2.0),
        ([0.25, 0.25], 3.0),
    ] {
        check(point.eval(&at(u, v))[0], expected);
    }
}

#[test]
fn texel_centres_keep_their_value_and_the_middle_is_the_mean() {
    for filter in [ImageFilter::Bilinear, ImageFilter::Trilinear] {
        let map = map(Wrap::all(Beyond::Repeat), filter);
        check(map.eval(&at(0.25, 0.75))[0], 1.0);
        check(map.eval(&at(0.5, 0.5))[0], 2.5);
    }
}

#[test]
fn borders_wrap_as_asked() {
    let value = |wrap, filter, u, v| map(wrap, filter).eval(&at(u, v))[0];
    let [repeat, mirrored, clamp, black] =
        [Beyond::Repeat, Beyond::Mirror, Beyond::Clamp, Beyond::Black].map(Wrap::all);
    let each = Wrap::Axes([Beyond::Clamp, Beyond::Repeat]);
    for (wrap, u, v, expected) in [
        (repeat, -0.75, 1.75, 1.0),
        (mirrored, -0.25, 0.75, 1.0),
        (mirrored, 1.25, 1.25, 2.0),
        (mirrored, 2.25, 0.75, 1.0),
        (each, 7.25, 1.75, 2.0),
        (each, -3.25, -0.25, 1.0),
        (clamp, 7.0, -3.0, 4.0),
        (black, 1.25, 0.5, 0.0),
    ] {
        check(value(wrap, ImageFilter::Point, u, v), expected);
    }
    check(value(black, ImageFilter::Bilinear, 0.0, 0.75), 0.5);
    for wrap in [repeat, mirrored, clamp, black, Wrap::OctahedralSphere] {
        let far = map(wrap, ImageFilter::Bilinear).eval(&at(f32::MAX, -1e30));
        assert!(far[0].is_finite());
    }
}

#[test]
fn values_are_scaled_before_they_are_inverted() {
    let mut map = map(Wrap::all(Beyond::Black), ImageFilter::Point);
    map.change = Change::ScaleAndInvert(0.25);
    check(map.eval(&at(0.25, 0.75))[0], 0.75);
    check(map.eval(&at(0.75, 0.25))[0], 0.0);
    check(map.eval(&at(7.0, 0.0))[0], 1.0);
}

/// Beyond a border lies what is near on the sphere: the direction of every texel that bilinear look-up
/// reaches is near the direction of its neighbours.
#[test]
fn octahedral_maps_have_no_border() {
    let n = 16;
    let directions = (0..n * n).map(|i| {
        let p = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
        square_to_direction(p).to_array()
    });
    let map = ImageMap {
        wrap: Wrap::OctahedralSphere,
        ..image_map(n, directions.collect(), ImageFilter::Point)
    };
    let texel = 1.0 / n as f32;
    for i in 0..n {
        let along = (i as f32 + 0.5) * texel;
        let (near, far) = (0.5 * texel, 1.0 - 0.5 * texel);
        for (uv, step) in [
            ([near, along], [-texel, 0.0]),
            ([far, along], [texel, 0.0]),
            ([along, near], [0.0, -texel]),
            ([along, far], [0.0, texel]),
        ] {
            let here = Vec3::from(map.eval(&at(uv[0], uv[1])));
            let beyond = Vec3::from(map.eval(&at(uv[0] + step[0], uv[1] + step[1])));
            assert!(here.distance(beyond) < 5.0 * texel, "{here} and {beyond}");
        }
    }
}

/// At a pixel as wide as 2^k texels the value is that of copy k, between copies it is between them;
/// far away it is the mean.
#[test]
fn copies_are_chosen_by_the_width_of_a_pixel() {
    let n = 64;
    let texels = (0..n * n).map(|i| [((i * 7919) % 251) as f32]);
    let map = image_map(n, texels.collect(), ImageFilter::Trilinear);
    let image = &map.image;
    let uv = Vec2::new(0.37, 0.61);
    let of_copy = |level: usize| {
        let copy = ImageMap {
            image: Arc::new(image.copy(level).clone()),
            filter: ImageFilter::Bilinear,
            ..map.clone()
        };
        copy.eval(&at(uv.x, uv.y))[0]
    };
    let texel = 1.0 / n as f32;
    check(map.eval(&seen(uv, 0.7 * texel))[0], of_copy(0));
    for level in 0..=6_usize {
        let width = texel * (1 << level) as f32;
        check_near(map.eval(&seen(uv, width))[0], of_copy(level), 1e-3, level);
    }
    let between = map.eval(&seen(uv, 2f32.sqrt() * texel))[0];
    let middle = f32::midpoint(of_copy(0), of_copy(1));
    check_near(between, middle, 1e-3, "between");
    let mean = image.texels().iter().map(|texel| texel[0]).sum::<f32>() / (n * n) as f32;
    check_near(map.eval(&seen(uv, 100.0))[0], mean, 1e-3, "far away");
}

/// Stretched parameters: the direction in which texels are widest decides, so nothing is blurred.
#[test]
fn stretched_images_are_not_blurred() {
    let mut map = map(Wrap::all(Beyond::Repeat), ImageFilter::Trilinear);
    map.mapping = Mapping::Parameters {
        scale: Vec2::new(100.0, 0.1),
        offset: Vec2::ZERO,
    };
    let uv = Vec2::new(0.0025, 7.5);
    check(map.eval(&seen(uv, 1.0))[0], 1.0);
}
