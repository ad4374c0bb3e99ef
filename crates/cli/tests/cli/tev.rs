use crate::common::{Ran, Workplace};
use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::thread;

/// The image of a listener as drawn by packets.
#[derive(Debug, Default)]
struct Image {
    name: String,
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
    /// The number of packets that drew pixels.
    updates: usize,
}

/// Takes values from a packet.
struct Packet(Vec<u8>);

impl Packet {
    fn take(&mut self, count: usize) -> Vec<u8> {
        let rest = self.0.split_off(count);
        std::mem::replace(&mut self.0, rest)
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap();
        let text = self.take(end + 1);
        String::from_utf8(text[..end].to_vec()).unwrap()
    }

    fn number(&mut self) -> usize {
        u32::from_le_bytes(self.take(4).try_into().unwrap()) as usize
    }

    fn long(&mut self) -> usize {
        u64::from_le_bytes(self.take(8).try_into().unwrap()) as usize
    }

    fn names(&mut self) -> Vec<String> {
        let count = self.number();
        (0..count).map(|_| self.text()).collect()
    }
}

impl Image {
    /// Receives packets, and returns the image at the end of the connection.
    fn receive(mut stream: TcpStream) -> Self {
        let mut image = Self::default();
        let mut length = [0; 4];
        while stream.read_exact(&mut length).is_ok() {
            let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
            stream.read_exact(&mut bytes).unwrap();
            image.obey(Packet(bytes));
        }
        image
    }

    fn obey(&mut self, mut packet: Packet) {
        match packet.take(1)[0] {
            2 => assert_eq!(packet.text(), "room.pbrt"),
            4 => {
                packet.take(1);
                self.name = packet.text();
                self.size = [packet.number(), packet.number()];
                assert_eq!((packet.number(), packet.0.len()), (3, 6));
                self.pixels = vec![[0.0; 3]; self.size[0] * self.size[1]];
            }
            6 => {
                packet.take(1);
                assert_eq!(packet.text(), self.name);
                assert_eq!(packet.names(), ["R", "G", "B"]);
                self.draw(packet);
            }
            other => panic!("a packet of type {other}"),
        }
    }

    fn draw(&mut self, mut packet: Packet) {
        let [x, y, width, height] = [(); 4].map(|()| packet.number());
        let [offsets, strides] = [(); 2].map(|()| [(); 3].map(|()| packet.long()));
        let (values, rest) = packet.0.as_chunks::<4>();
        assert!(rest.is_empty());
        for i in 0..width * height {
            let place = (y + i / width) * self.size[0] + x + i % width;
            for channel in 0..3 {
                let value = values[offsets[channel] + i * strides[channel]];
                self.pixels[place][channel] = f32::from_le_bytes(value);
            }
        }
        self.updates += 1;
    }
}

/// Returns the bits of pixels.
fn bits(pixels: impl IntoIterator<Item = [f32; 3]>) -> Vec<[u32; 3]> {
    let bits = pixels.into_iter().map(|pixel| pixel.map(f32::to_bits));
    bits.collect()
}

/// Reads the pixels of an EXR.
fn exr(place: &Workplace, name: &str) -> Vec<[u32; 3]> {
    bits(formats::image::read(&place.path(name), None).unwrap().rgb())
}

#[test]
fn tev_shows_the_pixels_of_the_image() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let receiver = thread::spawn(move || Image::receive(listener.accept().unwrap().0));
    let place = Workplace::new();
    let command = "render room.pbrt -q --crop 5,3,21,14 --integrator";
    place
        .run(&format!(
            "{command} bdpt -o a.exr --spp 40 --display-server {address}"
        ))
        .expect(0);
    let image = receiver.join().unwrap();
    assert_eq!((&*image.name, image.size), ("room.pbrt", [24, 16]));
    let crop = (3..14).flat_map(|y| (5..21).map(move |x| y * 24 + x));
    let shown = crop.clone().map(|i| image.pixels[i]);
    assert_eq!(bits(shown), exr(&place, "a.exr"));
    let outside = (0..24 * 16).filter(|i| !crop.clone().any(|j| j == *i));
    let mut outside = outside.flat_map(|i| image.pixels[i]);
    assert!(outside.all(|value| value.to_bits() == 0));
    assert!(image.updates > 0);
}

#[test]
fn tev_shows_the_light_image() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let receiver = thread::spawn(move || Image::receive(listener.accept().unwrap().0));
    let place = Workplace::new();
    // The picture has nothing else.
    let command = "render room.pbrt -q --integrator light -o a.exr";
    place
        .run(&format!("{command} --display-server {address}"))
        .expect(0);
    let image = receiver.join().unwrap();
    assert_eq!(bits(image.pixels), exr(&place, "a.exr"));
}

/// Checks that a render without and with a viewer at `address`, which accepts no images, has the same bits.
#[track_caller]
fn check_unseen(address: &str) -> Ran {
    let place = Workplace::new();
    place.run("render room.pbrt -o alone.exr").expect(0);
    let ran = place
        .run(&format!(
            "render room.pbrt -o seen.exr --display-server {address}"
        ))
        .expect(0);
    assert_eq!(exr(&place, "seen.exr"), exr(&place, "alone.exr"));
    assert_eq!(ran.stderr.matches("warning").count(), 1, "{}", ran.stderr);
    ran
}

#[test]
fn a_render_does_not_need_a_listener() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    drop(listener);
    let said = format!("--display-server: cannot connect to {address}");
    check_unseen(&address).says(&said);
}

#[test]
fn a_listener_that_never_reads_stops_nothing() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let place = Workplace::new();
    // The image is larger than the buffer of an unread connection.
    let command = "render room.pbrt --size 1600x1000 --integrator path --max-depth 1 --spp 1";
    place.run(&format!("{command} -q -o alone.exr")).expect(0);
    let ran = place
        .run(&format!("{command} -o seen.exr --display-server {address}"))
        .expect(0);
    ran.says(&format!("--display-server: {address}"));
    assert_eq!(exr(&place, "seen.exr"), exr(&place, "alone.exr"));
    drop(listener);
}

#[test]
fn an_invalid_address_is_refused() {
    let place = Workplace::new();
    for wrong in ["", ":14158", "host:port", "host:0", "[::1"] {
        let mut command = place.command("render room.pbrt --display-server");
        let ran = Ran::of(command.arg(wrong)).expect(2);
        ran.says("expected HOST or HOST:PORT");
    }
    place
        .run("render room.pbrt --replay 1,1,1 --display-server a")
        .expect(2)
        .says("--replay");
}
