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
fn light_paths_that_no_strategy_makes_are_told() {
    let place = Workplace::new();
    let glass = crate::common::SCENE.replace(
        "WorldBegin",
        "WorldBegin\nMaterial \"dielectric\"\nShape \"sphere\" \"float radius\" .01\n",
    );
    place.write("glass.pbrt", &glass);
    place
        .run("info glass.pbrt")
        .expect(0)
        .prints("bdpt         misses point, spot")
        .prints("bdpt         is noisy for caustics")
        .prints("path         misses caustics of point")
        .prints("light        misses everything seen in mirrors");
    place
        .run("info room.pbrt")
        .expect(0)
        .prints("bdpt         makes all light paths");
    let info = place.run("info glass.pbrt --json").expect(0).json();
    assert_eq!(info["blind_spots"]["bdpt"][0]["missing"], true);
}

#[test]
fn what_a_render_would_refuse_is_listed() {
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
        .prints("refused      odd.pbrt:")
        .prints("the shape `curve` is not supported");
    place.run("render odd.pbrt -o odd.exr").expect(3);
}

#[test]
fn what_is_odd_is_warned_of() {
    let place = Workplace::new();
    place.write(
        "odd.pbrt",
        &crate::common::SCENE.replace("\"sobol\"", "\"halton\""),
    );
    place
        .run("info odd.pbrt")
        .expect(0)
        .says("warning: odd.pbrt:6:9:");
    place
        .run("info odd.pbrt --strict")
        .expect(6)
        .says("1 warning, which --strict makes an error");
}
