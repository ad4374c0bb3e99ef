use crate::common::{DEADLINE, Place};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;
use tungstenite::Message;
use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{Data, OpCode};

#[test]
fn nothing_is_answered_but_what_there_is() {
    let place = Place::new();
    for path in [
        "/nothing",
        "/assets/nothing.js",
        "/assets/../Cargo.toml",
        "/assets/..%2fCargo.toml",
        "/assets/%2e%2e/%2e%2e/Cargo.toml",
        "/assets//etc/passwd",
        "/assets/%2fetc%2fpasswd",
        "/../../../etc/passwd",
        "//etc/passwd",
    ] {
        let answer = place.get(path);
        assert_eq!(answer.code, 404, "{path}: {}", answer.text());
        let error: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
        assert!(error["error"].is_string());
    }
    let own = format!("HTTP/1.1\r\nHost: {}\r\n", place.address);
    let long = format!("GET /status {own}{}", "A: b\r\n".repeat(101));
    for (head, code) in [
        (format!("POST /status {own}Content-Length: 0\r\n"), 405),
        (long, 431),
        ("nonsense\r\n".to_owned(), 400),
    ] {
        let answer = place.raw(&format!("{head}Connection: close\r\n\r\n"));
        assert_eq!(answer.code, code, "{head:.40}");
    }
    assert_eq!(place.get("/live").code, 400);
    place.close();
}

#[test]
fn all_answers_have_the_headers_that_keep_pages_apart() {
    let place = Place::new();
    for path in ["/", "/status", "/log", "/nothing"] {
        let head = place.get(path).head;
        assert!(
            head.contains("content-security-policy: default-src 'self'"),
            "{path}: {head}"
        );
        assert!(head.contains("x-content-type-options: nosniff"), "{path}");
        assert!(head.contains("referrer-policy: no-referrer"), "{path}");
    }
    let page = place.get("/");
    assert!(page.head.contains("content-type: text/html"));
    assert!(!page.text().contains("<script>") && !page.text().contains("style="));
    place.close();
}

#[test]
fn pages_of_others_are_refused() {
    let place = Place::new();
    let port = place.address.port();
    let request = "GET /status HTTP/1.1\r\nHost: example.org\r\nConnection: close\r\n\r\n";
    assert_eq!(place.raw(request).code, 403);
    let url = format!("ws://127.0.0.1:{port}/live");
    assert_eq!(
        place.try_client(&url, Some("http://example.org")).err(),
        Some(403)
    );
    assert_eq!(
        place.try_client("ws://example.org/live", None).err(),
        Some(403)
    );
    let own = format!("http://127.0.0.1:{port}");
    assert!(place.try_client(&url, Some(&own)).is_ok());
    place.close();
}

#[test]
fn elsewhere_than_on_this_machine_a_token_is_asked_for() {
    let place = Place::with(None, None, "0.0.0.0:0");
    let (_, token) = place.url.split_once("?token=").unwrap();
    let wrong: String = token.chars().rev().collect();
    for path in ["/", "/status", "/render.png", "/log", "/pixel?x=0&y=0"] {
        assert_eq!(place.get(path).code, 403, "{path}");
    }
    let wrong = place.get(&format!("/status?token={wrong}"));
    assert_eq!(wrong.code, 403);
    place.json(&format!("/status?token={token}"));
    let live = format!("ws://{}/live", place.address);
    assert_eq!(place.try_client(&live, None).err(), Some(403));
    let mut client = place
        .try_client(&format!("{live}?token={token}"), None)
        .unwrap();
    client.frame(|_| true);
    place.close();
}

#[test]
fn what_is_no_command_closes_the_conversation() {
    let place = Place::new();
    let text = |text: &str| Message::text(text.to_owned());
    let many = format!(r#"{{"command":"save","name":"{}"}}"#, "a".repeat(5000));
    let most = format!(r#"{{"command":"save","name":"{}"}}"#, "a".repeat(60_000));
    for (message, code) in [
        (text("not json"), 1007),
        (text(r#"{"command":"explode"}"#), 1008),
        (text(r#"{"command":"orbit","yaw":"1","pitch":0}"#), 1008),
        (text(r#"{"command":"pause","more":1}"#), 1008),
        (Message::binary(vec![1, 2, 3]), 1003),
        (
            Message::Frame(Frame::message(
                vec![0xff; 4],
                OpCode::Data(Data::Text),
                true,
            )),
            1007,
        ),
        (text(&many), 1009),
        (text(&most), 1009),
    ] {
        let mut client = place.client();
        let name = format!("{message:.60?}");
        // A body that is too large may be refused before all of it is written.
        let _ = client.socket.send(message);
        assert_eq!(client.closed(), code, "{name}");
    }
    // A body that is far too large is not read to its end.
    let mut client = place.client();
    let _ = client.socket.send(Message::binary(vec![0; 1 << 24]));
    while client.socket.read().is_ok() {}
    // The render took no harm.
    let passes = crate::common::number(&place.json("/status")["lanes"][0]["passes"]);
    place.wait_for_passes(passes + 1);
    place.close();
}

#[test]
fn there_is_an_end_to_connections() {
    let place = Place::new();
    let mut watching = place.client();
    let connect = || TcpStream::connect(place.address).unwrap();
    let idle: Vec<_> = std::iter::repeat_with(connect).take(127).collect();
    let mut next = connect();
    let request = format!("GET /status HTTP/1.1\r\nHost: {}\r\n\r\n", place.address);
    next.write_all(request.as_bytes()).unwrap();
    next.set_read_timeout(Some(Duration::from_millis(200)))
        .unwrap();
    let waits = next.read(&mut [0]).unwrap_err();
    assert!(matches!(
        waits.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut
    ));
    watching.frame(|frame| frame.passes > 0);
    drop(idle);
    next.set_read_timeout(Some(DEADLINE)).unwrap();
    assert_eq!(next.read(&mut [0]).unwrap(), 1);
    place.close();
}

#[test]
fn there_is_an_end_to_clients() {
    let place = Place::new();
    let url = format!("ws://{}/live", place.address);
    let clients: Vec<_> = (0..64).map(|_| place.client()).collect();
    assert_eq!(place.try_client(&url, None).err(), Some(429));
    drop(clients);
    // Places are free again when the server has noticed.
    for _ in 0..1000 {
        if place.try_client(&url, None).is_ok() {
            place.close();
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no place became free");
}
