//! The page is a part of the program: what changes or comes to its folder is taken up.

fn main() {
    println!("cargo:rerun-if-changed=page");
}
