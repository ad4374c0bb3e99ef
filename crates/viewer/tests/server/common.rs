//! A server with a small scene, and clients.

use bidir::driver::{Resources, Settings};
use bidir::integrator::IntegratorKind;
use bidir_viewer::interactive::{InteractiveRender, InteractiveSettings};
use bidir_viewer::web::{Server, listen};
use bidir_viewer::{Status, request_queue};
use formats::scene::Loaded;
use serde_json::Value;
use std::fs;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// A floor, a wall, a ball, a small light and a point light.
const SCENE: &str = include_str!("room.pbrt");

/// Nothing that is waited for takes so long.
pub const DEADLINE: Duration = Duration::from_secs(60);

/// The film of [`SCENE`].
pub const SIZE: [u32; 2] = [48, 32];

/// The settings of the render.
pub fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.set_integrator(IntegratorKind::Bdpt);
    settings.path.max_depth = Some(4);
    settings
}

/// The scene.
pub fn scene(size: Option<[u32; 2]>) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.pbrt");
    fs::write(&path, SCENE).unwrap();
    let options = formats::scene::LoadOptions {
        resolution: size,
        ..formats::scene::LoadOptions::default()
    };
    formats::scene::load(&path, &options).unwrap()
}

/// A render with its server.
pub struct Place {
    pub folder: TempDir,
    pub address: SocketAddr,
    pub url: String,
    server: Option<Server>,
    render: Option<InteractiveRender>,
}

impl Place {
    /// One that renders without end.
    pub fn new() -> Self {
        Self::with(None, None, "127.0.0.1:0")
    }

    /// One that ends after so many passes.
    pub fn ending(target: u64) -> Self {
        Self::with(None, Some(target), "127.0.0.1:0")
    }

    pub fn with(size: Option<[u32; 2]>, target: Option<u64>, address: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let listener: TcpListener = listen(address.parse().unwrap(), 0).unwrap();
        let port = listener.local_addr().unwrap().port();
        let loaded = scene(size);
        let first = Status::interactive(&loaded.name, loaded.view.film());
        let (queue, client) = request_queue(first);
        let server = Server::start(listener, client).unwrap();
        let render = InteractiveSettings {
            subject: loaded.subject(),
            settings: settings(),
            roulette: None,
            resources: Resources {
                threads: 1,
                ..Resources::default()
            },
            target,
            folder: folder.path().to_owned(),
        };
        Self {
            folder,
            address: SocketAddr::new([127, 0, 0, 1].into(), port),
            url: server.url().to_owned(),
            server: Some(server),
            render: Some(InteractiveRender::open(render, queue).unwrap()),
        }
    }

    /// Ends it. Returns the files that were saved.
    pub fn close(mut self) -> Vec<String> {
        self.server = None;
        self.render.take().unwrap().close().unwrap()
    }

    /// The answer to a request as it stands.
    pub fn raw(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(DEADLINE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        // A server that closes with something unread may reset the connection.
        let _ = stream.read_to_end(&mut bytes);
        Answer::new(&bytes)
    }

    pub fn get(&self, path: &str) -> Answer {
        let host = self.address;
        self.raw(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        ))
    }

    pub fn json(&self, path: &str) -> Value {
        let answer = self.get(path);
        assert_eq!(answer.code, 200, "{path}: {}", answer.text());
        serde_json::from_slice(&answer.body).unwrap()
    }

    /// Waits for a status of which `is_so` is true. While new lanes are made it is that of the lanes before.
    #[track_caller]
    pub fn wait(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let status = self.json("/status");
            if status["state"] != "preparing" && is_so(&status) {
                return status;
            }
            assert!(start.elapsed() < DEADLINE, "no {what}: {status}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The status of a render that has passes.
    #[track_caller]
    pub fn wait_for_passes(&self, passes: u64) -> Value {
        self.wait("passes", |status| {
            number(&status["lanes"][0]["passes"]) >= passes
        })
    }

    pub fn client(&self) -> Client {
        self.try_client(&format!("ws://{}/live", self.address), None)
            .unwrap()
    }

    /// A client that says it is of a page of `origin`; else the code of the refusal.
    pub fn try_client(&self, url: &str, origin: Option<&str>) -> Result<Client, u16> {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(DEADLINE)).unwrap();
        let mut request = url.into_client_request().unwrap();
        if let Some(origin) = origin {
            request
                .headers_mut()
                .insert("origin", origin.parse().unwrap());
        }
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(Client { socket }),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(answer))) => {
                Err(answer.status().as_u16())
            }
            Err(error) => panic!("{error}"),
        }
    }
}

pub fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or(0)
}

/// An answer over HTTP.
#[derive(Debug)]
pub struct Answer {
    pub code: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    fn new(bytes: &[u8]) -> Self {
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n");
        let end = end.unwrap_or(bytes.len());
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        let code = head.split(' ').nth(1).and_then(|code| code.parse().ok());
        Self {
            code: code.unwrap_or(0),
            head: head.to_ascii_lowercase(),
            body: bytes.get(end + 4..).unwrap_or_default().to_vec(),
        }
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// A client of `/live`.
pub struct Client {
    pub socket: WebSocket<TcpStream>,
}

/// A frame as it is sent.
#[derive(Clone, Debug)]
pub struct Frame {
    pub lane: u32,
    pub generation: u32,
    pub passes: u32,
    pub full: [u32; 2],
    /// Left, top, width and height.
    pub crop: [u32; 4],
    pub values: Vec<f32>,
}

impl Frame {
    fn new(bytes: &[u8]) -> Self {
        assert_eq!(&bytes[..4], b"BDF1");
        let words: Vec<[u8; 4]> = bytes[4..]
            .chunks_exact(4)
            .map(|w| w.try_into().unwrap())
            .collect();
        assert_eq!(bytes.len() % 4, 0);
        let head: Vec<u32> = words[..9]
            .iter()
            .map(|word| u32::from_le_bytes(*word))
            .collect();
        let values: Vec<_> = words[9..]
            .iter()
            .map(|word| f32::from_le_bytes(*word))
            .collect();
        assert_eq!(values.len() as u32, 3 * head[7] * head[8]);
        Self {
            lane: head[0],
            generation: head[1],
            passes: head[2],
            full: [head[3], head[4]],
            crop: [head[5], head[6], head[7], head[8]],
            values,
        }
    }
}

impl Client {
    pub fn send(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// The next frame that is as it is waited for.
    #[track_caller]
    pub fn frame(&mut self, is_so: impl Fn(&Frame) -> bool) -> Frame {
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < DEADLINE, "no such frame");
            if let Message::Binary(bytes) = self.socket.read().unwrap() {
                let frame = Frame::new(&bytes);
                if is_so(&frame) {
                    return frame;
                }
            }
        }
    }

    /// The next status that is sent.
    #[track_caller]
    pub fn status(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                return serde_json::from_str(&text).unwrap();
            }
        }
    }

    /// The code with which the server closes.
    #[track_caller]
    pub fn closed(&mut self) -> u16 {
        loop {
            match self.socket.read() {
                Ok(Message::Close(frame)) => return frame.unwrap().code.into(),
                Ok(_) => {}
                Err(error) => panic!("closed without a reason: {error}"),
            }
        }
    }
}
