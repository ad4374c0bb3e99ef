use crate::common::{Place, SIZE, scene, settings};
use bidir::driver::{Resources, render};
use formats::image::{Format, decode, decode_layers};
use formats::scene::Loaded;
use std::fs;

/// A place whose two passes are done.
fn done() -> Place {
    let place = Place::ending(2);
    place.wait("end", |status| status["state"] == "done");
    place
}

#[test]
fn the_picture_is_that_of_a_render_bit_for_bit() {
    let place = done();
    let answer = place.get("/render.exr");
    assert!(
        answer.head.contains("attachment; filename=\"room.exr\""),
        "{}",
        answer.head
    );
    let image = decode(Format::Exr, &answer.body, None).unwrap();
    let Loaded { scene, view, .. } = scene(None);
    let film = render(&scene, &view, &settings(), 2, &Resources::default()).unwrap();
    let picture = film.develop();
    let expected: Vec<u32> = picture
        .pixels
        .iter()
        .flatten()
        .map(|v| v.to_bits())
        .collect();
    let found: Vec<u32> = image.rgb().flatten().map(f32::to_bits).collect();
    assert_eq!(found, expected);
    // And so are frames.
    let frame = place.client().frame(|frame| frame.passes == 2);
    let found: Vec<u32> = frame.values.iter().map(|v| v.to_bits()).collect();
    assert_eq!(found, expected);
    place.close();
}

#[test]
fn a_pixel_is_that_of_the_file() {
    let place = done();
    let file = decode_layers(&place.get("/render.exr").body).unwrap();
    let at = |channel: &str, i: usize| f64::from(file.channel(channel).unwrap()[i]);
    for [x, y] in [[0, 0], [24, 16], [47, 31]] {
        let pixel = place.json(&format!("/pixel?lane=a&x={x}&y={y}"));
        let i = (y * SIZE[0] + x) as usize;
        for (c, name) in ["R", "G", "B"].iter().enumerate() {
            let mean = pixel["mean"][c].as_f64().unwrap() as f32;
            assert_eq!(mean.to_bits(), (at(name, i) as f32).to_bits());
            let error = pixel["standardError"][c].as_f64().unwrap();
            let variance = at(&format!("Variance.{name}"), i);
            assert!((error * error - variance).abs() <= 1e-5 * variance);
        }
        assert_eq!(pixel["samples"], 2);
        assert_eq!(
            pixel["rays"].as_f64().map(f64::to_bits),
            Some(at("Rays", i).to_bits())
        );
    }
    for wrong in [
        "x=48&y=0",
        "x=0&y=32",
        "x=-1&y=0",
        "x=0",
        "x=a&y=0",
        "x=0&y=0&lane=c",
        "",
    ] {
        assert_eq!(place.get(&format!("/pixel?{wrong}")).code, 400, "{wrong}");
    }
    place.close();
}

#[test]
fn the_png_shows_the_film() {
    let place = done();
    let answer = place.get("/render.png");
    assert!(answer.head.contains("content-type: image/png"));
    assert!(answer.head.contains("cache-control: no-store"));
    let image = decode(Format::Png, &answer.body, None).unwrap();
    assert_eq!([image.width as u32, image.height as u32], SIZE);
    place.close();
}

#[test]
fn a_sample_comes_with_its_places_on_the_film() {
    let place = done();
    let sample = place.json("/sample?lane=a&x=24&y=20&pass=1");
    assert_eq!(sample["pixel"], serde_json::json!([24, 20]));
    assert_eq!(sample["generation"], 1);
    let vertices = sample["camera"]["vertices"].as_array().unwrap();
    let raster = &vertices[1]["raster"];
    assert!(
        (raster[0].as_f64().unwrap() - 24.5).abs() <= 0.51,
        "{raster}"
    );
    assert!(
        (raster[1].as_f64().unwrap() - 20.5).abs() <= 0.51,
        "{raster}"
    );
    assert_eq!(place.get("/sample?x=48&y=0&pass=0").code, 400);
    assert_eq!(place.get("/sample?x=0&y=0").code, 400);
    place.close();
}

#[test]
fn strategies_have_images_where_they_are_asked_for() {
    let place = done();
    for path in ["/strategies", "/strategies.png?kind=raw&s=1&t=2"] {
        assert_eq!(place.get(path).code, 409);
    }
    let mut client = place.client();
    client.send(r#"{"command":"strategies","lane":"a","vertices":4}"#);
    let is_done = |status: &serde_json::Value| {
        status["lanes"][0]["strategyVertices"] == 4 && status["state"] == "done"
    };
    place.wait("strategies", is_done);
    let report = place.json("/strategies?lane=a");
    assert_eq!(report["vertices"], 4);
    let tiles = report["tiles"].as_array().unwrap();
    let direct = tiles
        .iter()
        .find(|tile| tile["s"] == 1 && tile["t"] == 2)
        .unwrap();
    assert!(direct["mean"].as_f64().unwrap() > 0.0 && direct["traced"].as_u64().unwrap() > 0);
    let image = |query: &str| {
        let answer = place.get(&format!("/strategies.png?kind=raw&s=1&t=2{query}"));
        decode(Format::Png, &answer.body, None).unwrap()
    };
    let (tile, bright) = (image(""), image("&exposure=2"));
    assert_eq!([tile.width as u32, tile.height as u32], SIZE);
    assert!(bright.data.iter().sum::<f32>() > tile.data.iter().sum::<f32>());
    for wrong in [
        "kind=none&s=1&t=2",
        "kind=raw&s=1",
        "kind=raw&s=9&t=9",
        "kind=raw&s=1&t=2&exposure=nan",
        "kind=weighted",
        "",
    ] {
        assert_eq!(
            place.get(&format!("/strategies.png?{wrong}")).code,
            400,
            "{wrong}"
        );
    }
    place.close();
}

#[test]
fn images_are_saved_where_the_server_was_started() {
    let place = done();
    let served = place.get("/render.exr").body;
    fs::write(place.folder.path().join("theirs.exr"), "theirs").unwrap();
    let mut client = place.client();
    for name in ["../room.exr", "theirs.exr", "room.png"] {
        client.send(&format!(r#"{{"command":"save","name":"{name}"}}"#));
        let refused = place.wait("refusal", |status| !status["message"].is_null());
        assert!(
            !refused["message"].as_str().unwrap().contains("wrote"),
            "{refused}"
        );
        // The next name is refused now.
        client.send(r#"{"command":"strategies","lane":"a","vertices":0}"#);
        place.wait("end", |status| {
            status["message"].is_null() && status["state"] == "done"
        });
    }
    client.send(r#"{"command":"save","name":"room.exr"}"#);
    place.wait("file", |status| {
        status["message"]
            .as_str()
            .is_some_and(|text| text.contains("wrote room.exr"))
    });
    let saved = fs::read(place.folder.path().join("room.exr")).unwrap();
    let pixels = |bytes: &[u8]| decode(Format::Exr, bytes, None).unwrap().data;
    assert_eq!(pixels(&saved), pixels(&served));
    let theirs = fs::read_to_string(place.folder.path().join("theirs.exr")).unwrap();
    assert_eq!(theirs, "theirs");
    assert_eq!(place.close(), ["room.exr"]);
}

#[test]
fn a_picture_of_a_view_of_its_own_says_so() {
    let place = done();
    let identity = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let at = text.find("bidir/identity").unwrap();
        text[at..at + 100].to_owned()
    };
    let own = place.get("/render.exr").body;
    let mut client = place.client();
    client.send(r#"{"command":"orbit","yaw":0.1,"pitch":0}"#);
    client.frame(|frame| frame.full == SIZE && frame.generation > 2 && frame.passes == 2);
    place.wait("end", |status| status["state"] == "done");
    let moved = place.get("/render.exr").body;
    assert!(String::from_utf8_lossy(&moved).contains("bidir/view"));
    assert!(!String::from_utf8_lossy(&own).contains("bidir/view"));
    assert_ne!(identity(&own), identity(&moved));
    place.close();
}
