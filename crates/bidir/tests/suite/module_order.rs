//! The order of the crate's modules: each uses those before it alone.

use std::fs;
use std::path::{Path, PathBuf};

/// From the lowest to the highest.
const ORDER: &str = "names math spectrum sampler strategy contribution medium locus shape texture bsdf material light \
                     camera film view scene stats guide path select integrator analysis settings driver";

fn level(module: &str) -> Option<usize> {
    ORDER.split(' ').position(|known| known == module)
}

/// The files of the crate below `folder`.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the folder of sources") {
        let path = entry.expect("an entry of the folder").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The modules that a source names as `crate::module`, in code that is no test.
fn used(source: &str) -> impl Iterator<Item = &str> {
    let product = source.split("#[cfg(test)]").next().unwrap_or_default();
    let code = product
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    let after = code.flat_map(|line| line.split("crate::").skip(1));
    after.map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        &rest[..end.unwrap_or(rest.len())]
    })
}

/// The modules that `source` of `module` uses and that are not below it.
fn upward<'a>(module: &str, source: &'a str) -> Vec<&'a str> {
    let own = level(module).unwrap_or_else(|| panic!("`{module}` has no place in the order"));
    let other = used(source).filter(|other| *other != module);
    other
        .filter(|other| level(other).is_none_or(|level| level >= own))
        .collect()
}

#[test]
fn modules_use_those_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut wrong = Vec::new();
    for file in &files {
        let relative = file.strip_prefix(&root).expect("it is below the root");
        let first = relative.iter().next().expect("it has a name");
        let module = Path::new(first).file_stem().and_then(|stem| stem.to_str());
        let module = module.expect("modules have plain names");
        let is_test = relative
            .iter()
            .any(|part| part == "tests" || part == "tests.rs");
        if is_test || ["lib", "testing"].contains(&module) {
            continue;
        }
        let source = fs::read_to_string(file).expect("the source is text");
        let named = upward(module, &source).into_iter();
        wrong.extend(named.map(|other| format!("{} uses {other}", relative.display())));
    }
    assert!(files.len() > 100 && wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_use_that_goes_up_is_seen() {
    let source = "use crate::math::Vec3;\n//! [`crate::driver`]\nlet x: crate::scene::Scene;\n\
                  #[cfg(test)]\nuse crate::driver;";
    assert_eq!(upward("light", source), ["scene"]);
    assert!(upward("path", source).is_empty());
    let source = "use crate::{Other}; use crate::unknown;";
    assert_eq!(upward("math", source), ["", "unknown"]);
}
