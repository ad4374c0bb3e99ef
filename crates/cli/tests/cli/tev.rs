use crate::common::Workplace;
use std::io::Read;
use std::net::TcpListener;
use std::thread;

/// Flags of a render whose image is larger than the buffer of an unread connection.
const LARGE: &str = "--size 1600x1000 --integrator path --max-depth 1 --spp 1";

/// Checks that a render has the same bits with a viewer at `address`. Returns its messages, and the bytes of a
/// row of the image.
#[track_caller]
fn check_shown(flags: &str, address: &str) -> (String, Vec<u8>) {
    let place = Workplace::new();
    let render = format!("render room.pbrt {flags}");
    place.run(&format!("{render} -q -o alone.exr")).expect(0);
    let shown = format!("{render} -o shown.exr --display-server {address}");
    let ran = place.run(&shown).expect(0);
    place.run("compare alone.exr shown.exr --exact").expect(0);
    let image = formats::image::read(&place.path("shown.exr"), None).unwrap();
    let row = image.rgb().skip(8 * image.width).take(image.width);
    let row = row.flatten().flat_map(f32::to_le_bytes).collect();
    (ran.stderr, row)
}

fn listen() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    (listener, address)
}

#[test]
fn tev_shows_the_image_and_the_light_image() {
    for integrator in ["--integrator bdpt", "--integrator light"] {
        let (listener, address) = listen();
        let receiver = thread::spawn(move || {
            let mut bytes = Vec::new();
            let (mut stream, _) = listener.accept().unwrap();
            stream.read_to_end(&mut bytes).unwrap();
            bytes
        });
        let (said, row) = check_shown(integrator, &address);
        assert!(!said.contains("warning"), "{said}");
        let bytes = receiver.join().unwrap();
        let has = |text: &[u8]| bytes.windows(text.len()).any(|part| part == text);
        assert!(has(b"room.pbrt\0") && has(&row), "{integrator}");
    }
}

#[test]
fn a_render_does_not_need_a_listener() {
    let (listener, address) = listen();
    drop(listener);
    let (said, _) = check_shown("", &address);
    let warning = format!("warning: --display-server: cannot connect to {address}");
    assert!(said.contains(&warning), "{said}");
    assert_eq!(said.matches("warning").count(), 1, "{said}");
}

#[test]
fn a_listener_that_never_reads_stops_nothing() {
    let (listener, address) = listen();
    let (said, _) = check_shown(LARGE, &address);
    assert!(
        said.contains(&format!("--display-server: {address}")),
        "{said}"
    );
    drop(listener);
}
