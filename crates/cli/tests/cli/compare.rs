use crate::common::Workplace;

/// Renders the scene at a size.
fn image(place: &Workplace, name: &str, arguments: &str) {
    place
        .run(&format!("render room.pbrt -q -o {name} {arguments}"))
        .expect(0);
}

#[test]
fn metrics_are_printed_as_text_and_as_json() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
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
fn exact_sets_the_exit_code() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
    image(&place, "c.exr", "--size 12x8");
    place.run("compare a.exr a.exr --exact").expect(0);
    place
        .run("compare a.exr b.exr --exact")
        .expect(6)
        .prints("identical    no");
    let other = place
        .run("compare a.exr c.exr --exact --json")
        .expect(6)
        .json();
    assert!(other["size"].is_null() && other["mean_ratio"].is_null());
    place
        .run("compare a.exr c.exr --reference a.exr --exact")
        .expect(6)
        .prints("rmse         none: the sizes differ");
}

#[test]
fn images_of_other_sizes_are_averaged() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--size 12x8");
    place
        .run("compare a.exr b.exr --resample")
        .expect(0)
        .prints("resampled    A to 12x8");
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

#[test]
fn all_metrics_have_keys_and_flip_needs_its_flag() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
    let fast = [
        "rmse",
        "relmse",
        "rmse_trim",
        "relmse_trim",
        "relmse_block",
        "mape",
        "mean_ratio",
    ];
    let json = place.run("compare a.exr b.exr --json").expect(0).json();
    for key in fast {
        assert!(json[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert!(json["rmse_trim"].as_f64() < json["rmse"].as_f64());
    assert!(json.get("flip").is_none() && json.get("flip_hdr").is_none());
    let json = place
        .run("compare a.exr b.exr --json --flip")
        .expect(0)
        .json();
    for key in ["flip", "flip_hdr"] {
        let value = json[key].as_f64().unwrap();
        assert!(value > 0.0 && value < 1.0, "{key} {value}");
    }
    place
        .run("compare a.exr b.exr --flip")
        .expect(0)
        .prints("relmse_trim  ")
        .prints("flip_hdr     ");
}

#[test]
fn several_seeds_have_intervals() {
    let place = Workplace::new();
    for seed in 0..4 {
        image(&place, &format!("{seed}.exr"), &format!("--seed {seed}"));
    }
    let json = place
        .run("compare 1.exr 2.exr 3.exr --reference 0.exr --json")
        .expect(0)
        .json();
    let number = |key: &str| json["rmse"][key].as_f64().unwrap();
    assert!(number("low") < number("mean") && number("mean") < number("high"));
    let one = place.run("compare 2.exr 0.exr --json").expect(0).json();
    assert_eq!(json["rmse"]["values"][1], one["rmse"]);
    assert_eq!(
        (&json["images"], &json["confidence"]),
        (&3.into(), &0.95.into())
    );
    place
        .run("compare 1.exr 2.exr --reference 0.exr")
        .expect(0)
        .prints("images       2, with intervals of 95 %");
    for (images, warning) in [
        ("1.exr 1.exr", "`1.exr` is given twice"),
        ("1.exr copy.exr", "`1.exr` and `copy.exr` are identical"),
        (
            "1.exr more.exr",
            "`1.exr` and `more.exr` have the same seed, 1",
        ),
    ] {
        std::fs::copy(place.path("1.exr"), place.path("copy.exr")).unwrap();
        image(&place, "more.exr", "--seed 1 --spp 3");
        place
            .run(&format!("compare {images} --reference 0.exr"))
            .expect(0)
            .says(&format!(
                "warning: {warning}: intervals need images with different seeds\n"
            ));
    }
    let independent = place.run("compare 1.exr 2.exr --reference 0.exr");
    assert!(independent.stderr.is_empty(), "{}", independent.stderr);
    // A single image has no interval.
    let same = place
        .run("compare 2.exr --reference 0.exr --json")
        .expect(0);
    assert_eq!(same.json(), one);
    place
        .run("compare 0.exr 0.exr --reference 0.exr --exact")
        .expect(0);
    place
        .run("compare 0.exr 1.exr --reference 0.exr --exact")
        .expect(6);
}

#[test]
fn error_maps_are_written_as_numbers_and_as_colours() {
    let place = Workplace::new();
    image(&place, "a.exr", "");
    image(&place, "b.exr", "--seed 1");
    place
        .run("compare a.exr b.exr --error-map map.exr --metric mape")
        .expect(0)
        .says("wrote map.exr");
    let map = formats::image::read(&place.path("map.exr"), None).unwrap();
    assert_eq!((map.width, map.height, map.channels), (24, 16, 1));
    let mean = map.data.iter().map(|&e| f64::from(e)).sum::<f64>() / (24.0 * 16.0);
    let json = place.run("compare a.exr b.exr --json").expect(0).json();
    assert!((mean / json["mape"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    place
        .run("compare a.exr b.exr --error-map map.png --metric flip --error-max 0.5")
        .expect(0)
        .prints("flip         ");
    let map = formats::image::read(&place.path("map.png"), None).unwrap();
    assert_eq!((map.width, map.height, map.channels), (24, 16, 3));
}
