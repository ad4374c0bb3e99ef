//! A client that never reads, beside one that does: in a process of its own, whose memory is
//! looked at.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails the test")]
#![allow(
    unreachable_pub,
    missing_docs,
    dead_code,
    reason = "shared with another test"
)]

#[path = "../server/common.rs"]
mod common;

use common::Place;

/// Frames of a megabyte, and so many that no socket takes them all.
const SIZE: [u32; 2] = [320, 288];
const FRAMES: usize = 24;

/// The memory of this process. None: the system does not report it. Unit: bytes.
fn memory() -> Option<usize> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: usize = text.split(' ').nth(1)?.parse().ok()?;
    Some(pages * 4096)
}

#[test]
fn a_client_that_never_reads_costs_nobody_anything() {
    let place = Place::with(Some(SIZE), None, "127.0.0.1:0");
    let stalled = place.client();
    let mut client = place.client();
    // The least of rays: frames follow each other quickly.
    client.send(r#"{"command":"method","lane":"a","integrator":"path","shadowRays":"all"}"#);
    let mut last = (0, 0);
    let mut next = |client: &mut common::Client| {
        let newest = client.frame(|frame| (frame.generation, frame.passes) > last);
        last = (newest.generation, newest.passes);
    };
    for _ in 0..4 {
        next(&mut client);
    }
    let before = memory();
    for frame in 0..FRAMES {
        // The first frames of a render follow each other more quickly than later ones.
        if frame % 8 == 0 {
            client.send(r#"{"command":"restart"}"#);
        }
        next(&mut client);
    }
    assert_eq!(place.get("/render.png").code, 200);
    if let (Some(before), Some(after)) = (before, memory()) {
        let grown = after.saturating_sub(before);
        let sent = FRAMES * 12 * (SIZE[0] * SIZE[1]) as usize;
        assert!(
            grown < sent / 2,
            "{grown} bytes more after {sent} were sent"
        );
    }
    drop(stalled);
    place.close();
}
