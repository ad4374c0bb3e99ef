//! The page is a part of the program: what changes or comes to its folder is taken up.

#![expect(clippy::print_stdout, reason = "so cargo is told")]

fn main() {
    println!("cargo:rerun-if-changed=page");
}
