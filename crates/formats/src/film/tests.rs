use super::*;
use crate::pbrt::{LoadOptions, build, parse_text};
use bidir::driver::{Budget, Progress};
use bidir::film::{Aov, FilmSettings, Filter, PassBuffer, PassSet, SplatPlace};
use bidir::math::Vec2;
use serde_json::json;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Returns a film of more than two blocks, with sums of both signs.
fn film(first_pass: u64) -> Film {
    let settings = FilmSettings::new([100, 90], Filter::default());
    let groups = ["lamp", "sky"].map(str::to_owned);
    let layers = Layers::new(&[Aov::Depth], &groups, 2).with_raw();
    let mut film = Film::with_layers(settings, layers, u64::MAX).unwrap();
    for pass in first_pass..first_pass + 2 {
        let buffer = PassBuffer::new(film.settings(), film.layers()).unwrap();
        for i in 0..9000 {
            let value = (i as f32 + pass as f32) * 0.37 - 900.0;
            buffer.set_camera_sample(i, [value, value * 1e-6, value * 1e6]);
            buffer.set_features(i, [value, 1.0].into_iter());
            buffer.add_to_part(i, i % film.layers().parts(), [value; 3]);
        }
        let place = SplatPlace {
            raster: Vec2::new(3.5, 80.5),
            u: Vec2::splat(0.5),
        };
        buffer.splat(film.settings(), place, [1e-3, 2.0, 1e9], [1].into_iter());
        film.add_pass(pass, &buffer);
    }
    film
}

fn header_with(seed: &str) -> FilmHeader {
    let settings = [("seed".to_owned(), seed.to_owned())].into();
    FilmHeader {
        seconds: 1.5,
        counts: json!({"rays": {"camera": 12}, "dropped": 0}),
        ..FilmHeader::new("bidir", "room.pbrt".to_owned(), settings)
    }
}

fn header() -> FilmHeader {
    header_with("1")
}

fn bytes() -> Vec<u8> {
    let film = film(0);
    encode(&header(), &film).unwrap()
}

#[test]
fn a_film_survives_the_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    let film = film(7);
    write(&path, &header(), &film).unwrap();
    let file = read(&path).unwrap();
    assert!(file.film == film);
    assert_eq!(file.header, header().of(&film));
    assert_eq!(file.header.passes, PassSet::from(7..9));
}

#[test]
fn planes_are_packed() {
    assert!(bytes().len() < film(0).sums().len() * 16 / 3);
}

#[test]
fn a_film_that_ends_early_is_damaged() {
    let bytes = bytes();
    for length in (0..bytes.len()).step_by(997).chain([bytes.len() - 1]) {
        let error = decode(&bytes[..length]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Data, "{length}");
    }
}

#[test]
fn no_memory_is_reserved_for_pixels_without_bytes_in_the_file() {
    let whole = bytes();
    let length = u32::from_le_bytes(whole[12..PREAMBLE].try_into().unwrap()) as usize;
    // Three blocks of no bytes, with their checksums.
    let file = [&whole[..PREAMBLE + length + 4], &[0; 3 * 8], END].concat();
    let message = decode(&file).unwrap_err().to_string();
    assert!(
        message.contains("shorter than any film of its size"),
        "{message}"
    );
    // A black film packs best.
    let settings = FilmSettings::new([640, 480], Filter::default());
    let black = Film::with_layers(settings, Layers::default(), u64::MAX).unwrap();
    let again = decode(&encode(&header(), &black).unwrap()).unwrap();
    assert!(again.film == black);
}

#[test]
fn a_flipped_bit_is_detected() {
    let bytes = bytes();
    for at in (0..bytes.len()).step_by(499).chain(0..64) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        // DEFLATE can encode the same film in two ways.
        if let Ok(file) = decode(&flipped) {
            assert!(file.film == film(0), "{at}");
        }
    }
}

/// A valid checksum does not make invalid blocks valid.
#[test]
fn invalid_blocks_with_valid_checksums_are_damaged() {
    let bytes = bytes();
    let header = u32::from_le_bytes(bytes[12..PREAMBLE].try_into().unwrap()) as usize;
    let block = PREAMBLE + header + 4;
    let length = u32::from_le_bytes(bytes[block..block + 4].try_into().unwrap()) as usize;
    let packed = block + 8..block + 8 + length;
    let mut refused = 0;
    for at in packed.clone().take(300).chain(packed.clone().step_by(2111)) {
        for value in [2, 255] {
            let mut forged = bytes.clone();
            forged[at] = value;
            let checksum = block::checksum(&forged[packed.clone()]);
            forged[block + 4..block + 8].copy_from_slice(&checksum.to_le_bytes());
            if let Err(error) = decode(&forged) {
                assert_eq!(error.kind(), ErrorKind::Data, "{at}");
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused} were refused");
}

#[test]
fn other_files_and_versions_are_errors() {
    let check = |bytes: &[u8], text: &str| {
        let error = decode(bytes).unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
    };
    check(b"\x89PNG and more than that", "not a film file");
    let mut newer = bytes();
    newer[8] = 9;
    check(&newer, "version 9");
    let mut longer = bytes();
    longer.push(0);
    check(&longer, "the end is missing");
    check(&bytes()[..bytes().len() / 2], "ends too early");
}

#[test]
fn a_difference_is_named() {
    assert_eq!(header().difference(&header()), None);
    assert_eq!(
        header().difference(&header_with("2")).unwrap(),
        "seed is 1 here and 2 there"
    );
    // Other differences follow from the integrator, or matter less.
    let with = |candidates: &str, integrator: &str| {
        let settings = [("candidates", candidates), ("integrator", integrator)];
        let settings = settings.map(|(name, value)| (name.to_owned(), value.to_owned()));
        FilmHeader::new("bidir", "room.pbrt".to_owned(), settings.into())
    };
    assert_eq!(
        with("12,1", "lvc")
            .difference(&with("auto", "auto"))
            .unwrap(),
        "integrator is lvc here and auto there"
    );
    assert_eq!(
        with("12,1", "lvc").difference(&with("8", "lvc")).unwrap(),
        "candidates is 12,1 here and 8 there"
    );
}

#[test]
fn headers_add_up() {
    let joined = header().joined(&header());
    assert_eq!(joined.counts, json!({"rays": {"camera": 24}, "dropped": 0}));
    assert!((joined.seconds - 3.0).abs() < 1e-9);
}

/// A host whose clock goes on by a second with each reading.
#[derive(Default)]
struct Readings(AtomicU64);

impl Progress for Readings {
    fn advance(&self, _samples: u64) {}

    fn nanoseconds(&self) -> u64 {
        self.0.fetch_add(1_000_000_000, Ordering::Relaxed)
    }
}

#[test]
fn a_render_ends_by_its_budget_or_its_host_and_can_be_continued() {
    let text = "Integrator \"path\" Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 \
                WorldBegin LightSource \"infinite\"";
    let scene = parse_text("s.pbrt", text).unwrap();
    let loaded = build(&scene, &LoadOptions::default()).unwrap();
    let (subject, settings) = (loaded.subject(), loaded.settings.render_settings());
    let (host, resources) = (Readings::default(), Resources::default());
    let run = |time: Option<u64>, earlier: Option<FilmFile>, most: u64| {
        let budget = Budget {
            passes: Some(5),
            time: time.map(Duration::from_secs),
            ..Budget::default()
        };
        let opened = subject.open(&settings, &resources, &budget, earlier, &host);
        let mut render = opened.unwrap();
        let rule = render.run(&budget, &host, &mut |render| render.spent.passes < most);
        (rule, render.into_file())
    };
    let (rule, whole) = run(None, None, 9);
    assert_eq!(rule, Some(Stopping::Fixed));
    assert_eq!(whole.header.stopping, Stopping::Fixed);
    // Training and each pass take a second.
    assert_eq!(whole.header.seconds as u64, 6);
    let (rule, part) = run(None, None, 2);
    assert_eq!((rule, part.header.stopping), (None, Stopping::Time));
    let (rule, rest) = run(None, Some(part), 9);
    assert_eq!(rule, Some(Stopping::Fixed));
    assert!(rest.film == whole.film && rest.header.counts == whole.header.counts);
    let (rule, short) = run(Some(4), None, 9);
    assert_eq!((rule, short.header.passes.len()), (Some(Stopping::Time), 3));
    let (rule, late) = run(Some(1), None, 9);
    assert_eq!((rule, late.header.passes.len()), (None, 0));
    let beyond = subject.check(&settings, &whole.header, 0..3).unwrap_err();
    assert_eq!(beyond, OpenError::Beyond(PassSet::from(3..5)));
}

#[test]
fn a_continued_render_repeats_its_training() {
    let trained = |more: &[(&str, &str)]| {
        let settings = [("trained-mean", "1e0")].iter().chain(more);
        let settings = settings.map(|&(name, value)| (name.to_owned(), value.to_owned()));
        FilmHeader::new("bidir", "room.pbrt".to_owned(), settings.collect())
    };
    let second = Some(Duration::from_secs(1));
    for (time, earlier, expected) in [
        (second, None, (u64::MAX, second)),
        (second, Some(trained(&[])), (u64::MAX, None)),
        (second, Some(trained(&[("training", "64")])), (64, None)),
        (None, None, (u64::MAX, None)),
    ] {
        let rules = TrainingLimits::new(time, earlier.as_ref());
        assert_eq!((rules.samples, rules.time), expected);
    }
}
