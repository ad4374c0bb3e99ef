use crate::cases;
use crate::scene::{LoadOptions, load};
use expect_test::expect_file;
use std::path::Path;

/// Returns what is wrong with a scene, without its folder.
fn message(path: &Path) -> String {
    let folder = format!(
        "{}{}",
        path.parent().unwrap().display(),
        std::path::MAIN_SEPARATOR
    );
    match load(path, &LoadOptions::default()) {
        Ok(_) => "a scene".to_owned(),
        Err(error) => error.to_string().replace(&folder, ""),
    }
}

#[test]
fn files_of_other_programs_are_named() {
    let folder = tempfile::tempdir().unwrap();
    cases::check(&expect_file!["./cases.txt"], |input| {
        let (name, content) = cases::file(input);
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        message(&path)
    });
}

#[test]
fn a_folder_is_named_with_a_scene_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let said = || message(folder.path());
    assert!(said().ends_with("is a folder; name a scene: .pbrt, .gltf or .glb"));
    std::fs::write(folder.path().join("b.pbrt"), "").unwrap();
    std::fs::write(folder.path().join("a.glb"), "").unwrap();
    let scene = folder.path().file_name().unwrap();
    let expected = format!(
        "name a scene in it, such as {}",
        Path::new(scene).join("a.glb").display()
    );
    assert!(said().ends_with(&expected), "{}", said());
}
