//! A headless browser opens a report from a file and uses its viewer.
//!
//! `CHROME` names the browser; otherwise the test takes the first common name on the path. Without a browser,
//! the test is skipped with a message.

#[path = "../../examples/report/sample.rs"]
mod sample;

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome-headless-shell",
];

fn browser() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("CHROME") {
        return Some(named.into());
    }
    let path = std::env::var_os("PATH")?;
    let folders: Vec<_> = std::env::split_paths(&path).collect();
    let places = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.into_iter().find(|place| place.is_file())
}

/// Returns the DOM of a page after its scripts have run.
fn opened(browser: &Path, folder: &Path, address: &str) -> io::Result<String> {
    let dom = folder.join("dom.html");
    let out = std::fs::File::create(&dom)?;
    let child = Command::new(browser)
        .args([
            "--headless",
            "--disable-gpu",
            "--no-first-run",
            "--hide-scrollbars",
        ])
        // The page is our own, and root has no sandbox.
        .arg("--no-sandbox")
        .args([
            "--disable-background-networking",
            "--disable-component-update",
        ])
        // Requests to other hosts fail.
        .arg("--host-resolver-rules=MAP * ~NOTFOUND")
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .args([
            "--window-size=1000,900",
            "--virtual-time-budget=20000",
            "--dump-dom",
            address,
        ])
        .stdout(out)
        .stderr(Stdio::null())
        .spawn()?;
    wait(child)?;
    std::fs::read_to_string(dom)
}

/// Waits at most 90 seconds.
fn wait(mut child: Child) -> io::Result<()> {
    let start = Instant::now();
    while child.try_wait()?.is_none() {
        if start.elapsed() > Duration::from_secs(90) {
            child.kill()?;
            child.wait()?;
            panic!("the browser does not end");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    Ok(())
}

#[test]
fn the_viewer_works_in_a_browser() {
    let Some(browser) = browser() else {
        println!("skipped: no browser is installed; CHROME names one");
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report-browser");
    std::fs::create_dir_all(&folder).unwrap();
    let page = folder.join("report.html");
    std::fs::write(&page, sample::Sample::new().page()).unwrap();
    let address = format!("file://{}#selftest", page.display());
    let dom = opened(&browser, &folder, &address).unwrap();

    let (_, lines) = dom.split_once("<pre id=\"selftest\">").unwrap_or_else(|| {
        panic!(
            "no self-test in what {} made of the page",
            browser.display()
        )
    });
    let (lines, _) = lines.split_once("</pre>").unwrap();
    println!("{lines}");
    assert!(!lines.contains("FAILED"), "{lines}");
    assert_eq!(lines.lines().last(), Some("end"));
    assert!(lines.lines().count() >= 15, "{lines}");
    for (part, at_least) in [
        ("<svg", 3),
        ("<table", 8),
        ("<canvas", 2),
        ("<article", 4),
        ("<img", 2),
    ] {
        let count = dom.matches(part).count();
        assert!(count >= at_least, "{part}: {count}");
    }
}
