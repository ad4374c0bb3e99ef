use crate::common::Workplace;
use crate::signals::send;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A running server with its URL.
struct Served {
    child: Child,
    url: String,
}

impl Drop for Served {
    /// Ends the server if a test fails.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Served {
    fn new(place: &Workplace, arguments: &str) -> Self {
        let mut command = place.command(arguments);
        let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut url = String::new();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        stdout.read_line(&mut url).unwrap();
        let url = url.strip_suffix('\n').unwrap_or_default().to_owned();
        Self { child, url }
    }

    /// Returns the answer to a request for `path`, with its head.
    fn get(&self, path: &str) -> String {
        let host = self.url.strip_prefix("http://").unwrap();
        let host = host.split('/').next().unwrap();
        let mut stream = TcpStream::connect(host).unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Returns the exit code of the command, and its messages.
    fn end(mut self) -> (Option<i32>, String) {
        let mut said = String::new();
        let stderr = self.child.stderr.as_mut().unwrap();
        stderr.read_to_string(&mut said).unwrap();
        (self.child.wait().unwrap().code(), said)
    }
}

#[test]
fn view_prints_a_url_that_answers_until_a_signal() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let place = Workplace::new();
        let served = Served::new(&place, "view room.pbrt --port 0 --threads 1");
        assert!(
            served.url.starts_with("http://127.0.0.1:"),
            "{}",
            served.url
        );
        assert!(served.url.ends_with('/'), "{}", served.url);
        assert!(served.get("/").contains("text/html"));
        let status = served.get("/status");
        assert!(status.contains(r#""scene":"room.pbrt""#), "{status}");
        assert!(status.contains(r#""controls":true"#), "{status}");
        send(signal, &served.child);
        let (ended, said) = served.end();
        assert_eq!(ended, Some(code), "{said}");
        assert!(said.contains("nothing was saved"), "{said}");
        assert_eq!(place.names(), ["room.pbrt"]);
    }
}

#[test]
fn on_other_addresses_the_url_has_a_token() {
    let place = Workplace::new();
    let served = Served::new(&place, "view room.pbrt --bind 0.0.0.0 --port 0 --spp 1 -q");
    let (_, token) = served.url.split_once("/?token=").unwrap();
    assert_eq!(token.len(), 32);
    assert!(served.get("/status").starts_with("HTTP/1.1 403"));
    let answer = served.get(&format!("/status?token={token}"));
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    send("INT", &served.child);
    assert_eq!(served.end(), (Some(130), String::new()));
}

#[test]
fn a_port_that_is_taken_is_an_error_with_a_hint() {
    let place = Workplace::new();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    for command in [
        format!("view room.pbrt --port {port}"),
        format!("render room.pbrt --serve {port}"),
    ] {
        place
            .run(&command)
            .expect(4)
            .says(&format!("cannot serve on 127.0.0.1:{port}"))
            .says("hint: another program uses it");
    }
    // An address reserved for documentation.
    place
        .run("view room.pbrt --bind 192.0.2.1")
        .expect(4)
        .says("hint: use an address of this machine");
    assert_eq!(place.names(), ["room.pbrt"]);
}

#[test]
fn without_a_port_the_next_free_one_is_taken() {
    let place = Workplace::new();
    // Another process may have the port.
    let taken = TcpListener::bind("127.0.0.1:8080");
    let served = Served::new(&place, "view room.pbrt --threads 1 --spp 1");
    assert!(!served.url.contains(":8080/"), "{}", served.url);
    assert!(served.url.contains(":80"), "{}", served.url);
    send("INT", &served.child);
    assert_eq!(served.end().0, Some(130));
    drop(taken);
}

#[test]
fn an_error_of_the_scene_comes_before_serving() {
    let place = Workplace::new();
    let ran = place.run("view none.pbrt --port 0").expect(4);
    assert_eq!(ran.stdout, "");
    place.write("odd.pbrt", "Shap");
    assert_eq!(place.run("view odd.pbrt --port 0").expect(3).stdout, "");
}

#[test]
fn a_render_is_watched_until_it_ends() {
    let place = Workplace::new();
    let command =
        "render room.pbrt --serve :0 --spp 1000000000 --time 2 --threads 1 -q -o served.exr";
    let served = Served::new(&place, command);
    let start = Instant::now();
    while !served.get("/status").contains(r#""state":"rendering""#) {
        assert!(start.elapsed() < Duration::from_secs(60));
    }
    let status = served.get("/status");
    assert!(status.contains(r#""controls":false"#), "{status}");
    assert!(status.contains(r#""camera":null"#), "{status}");
    let image = served.get("/render.exr");
    assert!(image.starts_with("HTTP/1.1 200") && image.contains("bidir/identity"));
    let url = served.url.clone();
    assert_eq!(served.end(), (Some(0), String::new()));
    assert_eq!(place.names(), ["room.pbrt", "served.exr", "served.png"]);
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    assert!(
        TcpStream::connect(host).is_err(),
        "it is served after its end"
    );
}

#[test]
fn watching_changes_no_bit() {
    let place = Workplace::new();
    place.run("render room.pbrt -q -o alone.exr").expect(0);
    let served = Served::new(&place, "render room.pbrt -q -o served.exr --serve 0");
    assert_eq!(served.end().0, Some(0));
    place.run("compare alone.exr served.exr --exact").expect(0);
}
