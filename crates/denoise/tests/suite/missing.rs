//! Tests of the errors for a missing or unusable Open Image Denoise.

use bidir_denoise::{DenoiseError, Denoiser, Input, names};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Returns the error of loading `named`.
#[track_caller]
fn refused(named: &Path) -> DenoiseError {
    Denoiser::load_named(Some(named), 1).unwrap_err()
}

#[track_caller]
fn check_unusable(named: &Path, part: &str) {
    let error = refused(named);
    let message = error.to_string();
    let begin = format!(
        "{}: cannot be used as Open Image Denoise: ",
        named.display()
    );
    assert!(message.starts_with(&begin), "{message}");
    assert!(message.contains(part), "{message}");
    assert!(error.is_missing());
    assert!(error.hint().unwrap().contains("set BIDIR_OIDN"));
}

#[test]
fn files_and_folders_without_a_library_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    check_unusable(&folder.path().join("nothing.so"), "");
    check_unusable(folder.path(), &format!("has no {}", names()[0]));
    let text = folder.path().join(names()[0]);
    fs::write(&text, "a text").unwrap();
    // The message is the system's, which names the file.
    check_unusable(&text, names()[0]);
    check_unusable(folder.path(), names()[0]);
}

/// Loads the C library, which every program has in its memory.
#[cfg(target_os = "linux")]
#[test]
fn another_library_is_refused() {
    let maps = fs::read_to_string("/proc/self/maps").unwrap();
    let library = maps.split_whitespace().find(|word| word.contains("/libc"));
    let Some(library) = library else {
        eprintln!("skipped: the C library is linked statically");
        return;
    };
    check_unusable(Path::new(library), "it has no function oidnNewDevice");
}

#[test]
fn the_hint_names_ways_to_get_the_library() {
    let error = DenoiseError::NotFound {
        names: names().to_vec(),
        reason: "no such file".to_owned(),
    };
    assert!(names().iter().all(|name| error.to_string().contains(name)));
    let hint = error.hint().unwrap();
    assert!(hint.contains("pip install") && hint.contains("BIDIR_OIDN"));
}

/// The source of a library with all functions of version 2. Its version is `MAJOR.7.0`, it returns the device
/// `DEVICE`, and it fails with `ERROR` unless that is empty.
const FAKE: &str = r#"
#![allow(non_snake_case)]
use std::ffi::{CStr, c_char, c_int};
#[unsafe(no_mangle)] extern "C" fn oidnNewDevice(_: c_int) -> usize { DEVICE }
#[unsafe(no_mangle)] extern "C" fn oidnReleaseDevice(_: usize) {}
#[unsafe(no_mangle)] extern "C" fn oidnCommitDevice(_: usize) {}
#[unsafe(no_mangle)] extern "C" fn oidnSetDeviceBool(_: usize, _: *const c_char, _: bool) {}
#[unsafe(no_mangle)] extern "C" fn oidnSetDeviceInt(_: usize, _: *const c_char, _: c_int) {}
#[unsafe(no_mangle)] extern "C" fn oidnGetDevice1i(_: usize, _: *const c_char) -> c_int { 0 }
#[unsafe(no_mangle)] extern "C" fn GET_INT(_: usize, name: *const c_char) -> c_int {
    match unsafe { CStr::from_ptr(name) }.to_bytes() {
        b"versionMajor" => MAJOR, b"versionMinor" => 7, _ => 0,
    }
}
#[unsafe(no_mangle)] extern "C" fn oidnGetDeviceError(_: usize, message: *mut *const c_char) -> c_int {
    let error: &CStr = ERROR;
    if error.is_empty() { return 0 }
    unsafe { *message = error.as_ptr() };
    1
}
#[unsafe(no_mangle)] extern "C" fn oidnNewFilter(_: usize, _: *const c_char) -> usize { 0 }
#[unsafe(no_mangle)] extern "C" fn oidnReleaseFilter(_: usize) {}
#[unsafe(no_mangle)] extern "C" fn oidnSetSharedFilterImage() {}
#[unsafe(no_mangle)] extern "C" fn oidnSetFilterBool(_: usize, _: *const c_char, _: bool) {}
#[unsafe(no_mangle)] extern "C" fn oidnCommitFilter(_: usize) {}
#[unsafe(no_mangle)] extern "C" fn oidnExecuteFilter(_: usize) {}
"#;

/// Compiles the fake library into a folder with the layout of an archive.
fn fake(words: &[(&str, &str)]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("fake.rs");
    let defaults = [
        ("MAJOR", "2"),
        ("DEVICE", "8"),
        ("ERROR", "c\"\""),
        ("GET_INT", "oidnGetDeviceInt"),
    ];
    let text = words.iter().chain(&defaults);
    let text = text.fold(FAKE.to_owned(), |text, (word, value)| {
        text.replace(word, value)
    });
    fs::write(&source, text).unwrap();
    fs::create_dir(folder.path().join("lib")).unwrap();
    let library = folder.path().join("lib").join(names()[0]);
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let compiled = Command::new(rustc)
        .args(["--edition=2024", "--crate-type=cdylib", "-o"])
        .args([&library, &source])
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{stderr}");
    let library = library.canonicalize().unwrap();
    (folder, library)
}

#[test]
fn other_versions_are_refused() {
    for (words, version) in [
        (&[("GET_INT", "another")], "1"),
        (&[("MAJOR", "3")], "3.7.0"),
    ] {
        let (folder, library) = fake(words);
        let error = refused(folder.path());
        let file = library.display();
        let expected = format!("{file}: Open Image Denoise {version}, where version 2 is needed");
        assert_eq!(error.to_string(), expected);
        assert!(error.is_missing() && error.hint().is_some());
    }
}

#[test]
fn errors_have_the_message_of_the_library() {
    let (_folder, library) = fake(&[("DEVICE", "0"), ("ERROR", "c\"no such processor\"")]);
    let error = refused(&library);
    assert_eq!(error.to_string(), "Open Image Denoise: no such processor");
    assert!(!error.is_missing() && error.hint().is_none());
    let (_folder, library) = fake(&[("DEVICE", "0")]);
    let expected = "Open Image Denoise: an error without a message";
    assert_eq!(refused(&library).to_string(), expected);
}

#[test]
fn a_filter_that_cannot_be_made_is_an_error() {
    let (folder, _) = fake(&[]);
    let denoiser = Denoiser::load_named(Some(folder.path()), 1).unwrap();
    assert_eq!(denoiser.version(), "2.7.0");
    let input = Input {
        size: [1, 1],
        color: &[[1.0; 3]],
        albedo: None,
        normal: None,
    };
    let expected = "Open Image Denoise: an error without a message";
    assert_eq!(denoiser.denoise(&input).unwrap_err().to_string(), expected);
}
