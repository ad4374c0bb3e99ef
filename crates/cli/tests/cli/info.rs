use crate::common::Workplace;

#[test]
fn a_scene_is_described() {
    let place = Workplace::new();
    let ran = place.run("info room.pbrt").expect(0);
    ran.prints("24x16")
        .prints("triangles    6")
        .prints("1 point")
        .prints("BVH memory");
    let info = place.run("info room.pbrt --json").expect(0).json();
    assert_eq!(
        info["shapes"],
        serde_json::json!({ "mesh": 3, "sphere": 1 })
    );
    assert_eq!(info["lights"], serde_json::json!({ "area": 1, "point": 1 }));
    assert_eq!(info["light_groups"], serde_json::json!({ "default": 2 }));
    assert_eq!(info["settings"]["integrator"], "bdpt");
    assert_eq!((&info["spp"], &info["triangles"]), (&2.into(), &6.into()));
    assert_eq!(info["bounds"][1], serde_json::json!([2.0, 3.0, 2.0]));
}

#[test]
fn light_paths_that_no_strategy_makes_are_listed() {
    let place = Workplace::new();
    let glass = crate::common::SCENE.replace(
        "WorldBegin",
        "WorldBegin\nMaterial \"dielectric\"\nShape \"sphere\" \"float radius\" .01\n",
    );
    place.write("glass.pbrt", &glass);
    place
        .run("info glass.pbrt")
        .expect(0)
        .prints("bdpt, auto, lvc miss point, spot")
        .prints("bdpt, auto, lvc are noisy for caustics")
        .prints("path         misses caustics of point")
        .prints("light        misses everything seen in mirrors");
    place
        .run("info room.pbrt")
        .expect(0)
        .prints("bdpt, auto, light, lvc, path find all light paths")
        .prints("light groups 1: default (2 lights)");
    let info = place.run("info glass.pbrt --json").expect(0).json();
    assert_eq!(info["blind_spots"]["bdpt"][0]["missing"], true);
}

#[test]
fn features_that_a_render_would_refuse_are_listed() {
    let place = Workplace::new();
    let odd = crate::common::SCENE.replace(
        "WorldBegin",
        "WorldBegin\nMaterial \"hair\"\nShape \"sphere\"\nShape \"curve\"\n",
    );
    place.write("odd.pbrt", &odd);
    place
        .run("info odd.pbrt")
        .expect(0)
        .prints("the material `hair` is not supported")
        .once("the material `hair` is not supported")
        .prints("refused      odd.pbrt:")
        .prints("the shape `curve` is not supported");
    place.run("render odd.pbrt -o odd.exr").expect(3);
}

#[test]
fn oddities_of_a_scene_cause_warnings() {
    let place = Workplace::new();
    place.write(
        "odd.pbrt",
        &crate::common::SCENE.replace("\"sobol\"", "\"halton\""),
    );
    place
        .run("info odd.pbrt")
        .expect(0)
        .once("odd.pbrt:6:9:")
        .says("warning: odd.pbrt:6:9:");
    let ran = place.run("info odd.pbrt --json").expect(0);
    assert_eq!(ran.once("odd.pbrt:6:9:").stderr, "");
    place
        .run("info odd.pbrt --strict")
        .expect(6)
        .says("1 warning, an error under --strict");
}

/// A spot through glass: the image of `path` lacks the caustic.
#[test]
fn a_render_warns_of_missing_light() {
    let place = Workplace::new();
    let spot = "WorldBegin\nMaterial \"dielectric\"\nShape \"sphere\" \"float radius\" .01\n  \
                LightSource \"spot\"\nLightSource \"point\" \"rgb I\" [0 0 0]\n";
    let glass = crate::common::SCENE.replace("WorldBegin", spot);
    let before = glass
        .split("LightSource \"spot\"")
        .next()
        .unwrap_or_default();
    let line = before.lines().count();
    place.write("glass.pbrt", &glass);
    let render = |flags: &str| {
        let command = format!("render glass.pbrt --size 12x8 --spp 1 {flags}");
        place.run(&command).expect(0).stderr
    };
    let missed = format!(
        "warning: `path` misses caustics of point, spot, distant and hidden lights (L S+ D), here of the \
         spot light at glass.pbrt:{line}:15 and 2 other lights; `light`, `bdpt`, `lvc` and `auto` find it by \
         strategy t1\n"
    );
    let dark = format!(
        "warning: glass.pbrt:{}:13: the point light has no power",
        line + 1
    );
    let path = render("--integrator path");
    assert_eq!(path.matches(&missed).count(), 1, "{path}");
    assert_eq!(path.matches(&dark).count(), 1, "{path}");
    let reference = "reference glass.pbrt --size 12x8 --spp 16 --estimator path --against bdpt -o glass.reference";
    let reference = place.run(reference).stderr;
    assert_eq!(reference.matches(&missed).count(), 1, "{reference}");
    // Paths of one scattering event are no caustics.
    let short = render("--integrator path --max-depth 1");
    assert!(!short.contains("misses"), "{short}");
    for (integrator, says) in [
        ("bdpt", "no strategy finds it unless the lights have a size"),
        ("light", "find it by strategies s0 and s1"),
    ] {
        let text = render(&format!("--integrator {integrator}"));
        assert!(
            text.contains(&format!("warning: `{integrator}` misses")),
            "{text}"
        );
        assert!(text.contains(says), "{text}");
    }
    let strict = "render glass.pbrt --spp 1 --strict --integrator path";
    place
        .run(strict)
        .expect(6)
        .says("2 warnings, errors under --strict");
}
