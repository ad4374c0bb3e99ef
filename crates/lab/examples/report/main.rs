//! Writes a report of invented numbers, to look at: `cargo run --release -p bidir-lab --example report -- report.html`.

mod sample;

fn main() -> std::io::Result<()> {
    let file = std::env::args_os().nth(1);
    let file = file.unwrap_or_else(|| "report.html".into());
    std::fs::write(file, sample::Sample::new().page())
}
