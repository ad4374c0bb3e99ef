//! Damaged film files, other files, existing files; the headers of films.

use crate::common::Workplace;
use std::fs;

/// Returns the offset of the checksum of the first block. Tests damage the checksum rather than packed bytes,
/// which may have several valid encodings.
fn checksum_of_pixels(film: &[u8]) -> usize {
    let header = u32::from_le_bytes(film[12..16].try_into().unwrap());
    16 + header as usize + 4 + 4
}

#[test]
fn errors_of_damaged_files_name_the_previous_file() {
    let place = Workplace::new();
    place.render_share("0..2", "a.film");
    let resume = "render room.pbrt -q --spp 4 --checkpoint a.film --resume -o a.exr";
    place.run(resume).expect(0);
    let whole = fs::read(place.path("a.film")).unwrap();
    let mut flipped = whole.clone();
    flipped[checksum_of_pixels(&whole)] ^= 4;
    let foreign = fs::read(place.path("a.exr")).unwrap();
    for bytes in [&whole[..whole.len() - 9], &flipped, &foreign, &[]] {
        fs::write(place.path("a.film"), bytes).unwrap();
        place.run(resume).expect(4).says("a.film.previous");
        place.run("film verify a.film").expect(4);
        assert_eq!(fs::read(place.path("a.film")).unwrap(), bytes);
    }
    place
        .run("film verify a.film.previous")
        .expect(0)
        .says("passes 0..2");
    place.run("film develop a.film -o b.exr").expect(4);
}

#[test]
fn a_damaged_file_never_replaces_the_previous_one() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --resume")
        .expect(0);
    let previous = fs::read(place.path("a.film.previous")).unwrap();
    fs::write(place.path("a.film"), b"BIDIRFLM and then nothing").unwrap();
    place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --restart")
        .expect(0);
    assert_eq!(fs::read(place.path("a.film.previous")).unwrap(), previous);
    fs::remove_file(place.path("a.film")).unwrap();
    let ran = place
        .run("render room.pbrt -q --spp 2 --checkpoint a.film --resume")
        .expect(2);
    ran.says("rename a.film.previous").says("--restart");
}

#[test]
fn a_film_file_is_replaced_only_with_a_flag() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    let render = "render room.pbrt -q --spp 2 --checkpoint a.film";
    place.run(&format!("{render} --restart")).expect(0);
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["passes"], "0..2");
    assert_eq!(info["stopping"], "fixed");
    assert_eq!(info["counts"]["samples"], 2 * 24 * 16);
    place.run("film develop a.film -o a.exr").expect(0);
    place.expect_same("a.exr", "room.exr");
}

#[test]
fn a_film_has_the_version_of_the_estimators() {
    let place = Workplace::new();
    place.render_share("0..1", "a.film");
    let version = bidir::ESTIMATOR_VERSION.to_string();
    let info = place.run("film info a.film --json").expect(0).json();
    assert_eq!(info["settings"]["estimator-version"], *version);
    place
        .run("film info a.film")
        .expect(0)
        .prints(&format!("  estimator-version    {version}\n"))
        .prints("  rays.connection      ");
}
