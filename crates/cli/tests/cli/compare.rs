use crate::common::Workplace;

/// Renders the scene at a size.
fn image(place: &Workplace, name: &str, arguments: &str) {
    place
        .run(&format!("render room.pbrt -q -o {name} {arguments}"))
        .expect(0);
}

#[test]
fn numbers_come_as_text_and_as_json() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
    place
        .run("compare a.exr a.exr")
        .expect(0)
        .prints("identical   yes")
        .prints("mean_ratio  1.0000");
    let same = place.run("compare a.exr a.exr --json").expect(0).json();
    assert_eq!(
        (&same["rmse"], &same["identical"]),
        (&0.0.into(), &true.into())
    );
    let other = place.run("compare a.exr b.exr --json").expect(0).json();
    assert!(other["rmse"].as_f64().unwrap() > 0.0 && other["relmse"].as_f64().unwrap() > 0.0);
    assert!((other["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.5);
    assert_eq!(other["identical"], false);
}

#[test]
fn exactness_is_told_by_the_exit_code() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
    image(&place, "c.exr", "--size 12x8");
    place.run("compare a.exr a.exr --exact").expect(0);
    place
        .run("compare a.exr b.exr --exact")
        .expect(6)
        .prints("identical   no");
    place.run("compare a.exr c.exr --exact").expect(6);
}

#[test]
fn other_sizes_are_an_error_unless_averaged() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--size 12x8");
    place
        .run("compare a.exr b.exr")
        .expect(4)
        .says("A is 24x16, B is 12x8")
        .says("--resample");
    place
        .run("compare a.exr b.exr --resample")
        .expect(0)
        .prints("resampled   A to 12x8");
    let json = place
        .run("compare b.exr a.exr --resample --json")
        .expect(0)
        .json();
    assert_eq!(
        (&json["resampled"], &json["identical"]),
        (&"B".into(), &false.into())
    );
    assert!((json["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.5);
}
