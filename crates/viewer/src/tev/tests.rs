use super::*;
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::driver::{Resources, Session, Settings};
use bidir::film::{FilmSettings, Filter};
use bidir::light::{InfiniteLight, Light};
use bidir::math::{Affine3A, Vec2};
use bidir::scene::{Scene, SceneBuilder};
use bidir::view::View;
use std::io::Read;
use std::net::{TcpListener, TcpStream};

#[track_caller]
fn check_address(text: &str, expected: Option<&str>) {
    let address = text.parse::<TevAddress>().ok();
    let address = address.map(|address| address.to_string());
    assert_eq!(address.as_deref(), expected, "{text}");
}

#[test]
fn addresses_are_as_people_write_them() {
    check_address("127.0.0.1:7", Some("127.0.0.1:7"));
    check_address("localhost", Some("localhost:14158"));
    check_address("desk-2.example:9000", Some("desk-2.example:9000"));
    check_address("[::1]:7", Some("[::1]:7"));
    check_address("[::1]", Some("[::1]:14158"));
    check_address("::1", Some("[::1]:14158"));
    for wrong in [
        "", ":", ":7", "a:", "a:0", "a:65536", "a:x", "a:1:2", "[::1", "[a]:7", "[::1]7", "a b",
        "a/b",
    ] {
        check_address(wrong, None);
    }
}

/// Returns a crop of a film.
fn view() -> View {
    let mut film = FilmSettings::new([8, 6], Filter::default());
    (film.crop.min, film.crop.max) = ([2, 1], [7, 4]);
    let camera = Perspective::new(&PerspectiveSettings {
        world_from_camera: Affine3A::IDENTITY,
        resolution: Vec2::new(8.0, 6.0),
        screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
        lens_radius: 0.0,
        focal_distance: 1.0,
    });
    View::new(Camera::Perspective(camera.unwrap()), film).unwrap()
}

/// Returns a sky.
fn scene() -> Scene {
    let mut builder = SceneBuilder::new();
    builder.light(Light::Infinite(InfiniteLight::constant([0.1, 0.7, 2.0])));
    builder.build().unwrap()
}

fn session(scene: &Scene) -> Session<'_> {
    Session::new(scene, &view(), Settings::default(), &Resources::default()).unwrap()
}

fn tev_at(listener: &TcpListener) -> Tev {
    let address = listener.local_addr().unwrap().to_string();
    Tev::start(address.parse().unwrap(), "rooms/a.pbrt").unwrap()
}

/// Returns the packets of a connection, without their lengths.
fn packets(stream: &mut TcpStream) -> Vec<Vec<u8>> {
    let mut packets = Vec::new();
    let mut length = [0; 4];
    while stream.read_exact(&mut length).is_ok() {
        let mut packet = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut packet).unwrap();
        packets.push(packet);
    }
    packets
}

#[test]
fn the_last_frame_arrives_as_it_is() {
    let scene = scene();
    let mut session = session(&scene);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut tev = tev_at(&listener);
    let receiver = thread::spawn(move || packets(&mut listener.accept().unwrap().0));
    for _ in 0..3 {
        session.step(&());
        tev.add_pass(session.film());
    }
    tev.end(session.film()).unwrap();
    let packets = receiver.join().unwrap();
    assert_eq!(packets[0], b"\x02a.pbrt\0");
    let mut create = b"\x04\x01a.pbrt\0".to_vec();
    for number in [8u32, 6, 3] {
        create.extend(number.to_le_bytes());
    }
    create.extend(b"R\0G\0B\0");
    assert_eq!(packets[1], create);
    let mut update = b"\x06\x00a.pbrt\0\x03\0\0\0R\0G\0B\0".to_vec();
    for number in [2u32, 1, 5, 3] {
        update.extend(number.to_le_bytes());
    }
    for number in [0u64, 1, 2, 3, 3, 3] {
        update.extend(number.to_le_bytes());
    }
    for value in session.film().develop().pixels.as_flattened() {
        update.extend(value.to_le_bytes());
    }
    assert_eq!(packets.last(), Some(&update));
}

#[test]
fn who_begins_to_listen_late_gets_the_last_frame() {
    let scene = scene();
    let mut session = session(&scene);
    // A port on which nobody listens yet.
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = free.local_addr().unwrap();
    drop(free);
    let tev = Tev::start(address.to_string().parse().unwrap(), "a").unwrap();
    session.step(&());
    let listener = TcpListener::bind(address).unwrap();
    let receiver = thread::spawn(move || packets(&mut listener.accept().unwrap().0));
    tev.end(session.film()).unwrap();
    assert_eq!(receiver.join().unwrap().len(), 3);
}

#[test]
fn a_render_without_a_pass_shows_nothing() {
    let scene = scene();
    let session = session(&scene);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let tev = tev_at(&listener);
    let mut stream = listener.accept().unwrap().0;
    tev.end(session.film()).unwrap();
    assert_eq!(packets(&mut stream), Vec::<Vec<u8>>::new());
}
