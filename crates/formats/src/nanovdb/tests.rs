use super::*;
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;

/// A grid as a file keeps it: one leaf that begins at a cell, with a value for each of its cells, in a tree of
/// background.
struct Kept {
    name: &'static str,
    first: [i32; 3],
    background: f32,
    value: fn([i32; 3]) -> f32,
}

const SMOKE: Kept = Kept {
    name: "density",
    first: [-8, 120, 0],
    background: 0.0,
    value: |[x, y, z]| (x + 8 * y + 64 * z) as f32,
};
const HEAT: Kept = Kept {
    name: "temperature",
    first: [-8, 120, 0],
    background: 300.0,
    value: |[x, _, _]| 300.0 + 500.0 * x as f32,
};

const UPPER_SIZE: usize = 8256 + 8 * 32768;
const LOWER_SIZE: usize = 1088 + 8 * 4096;
const LEAF_SIZE: usize = 96 + 4 * 512;
/// The places of the nodes.
const ROOT_AT: usize = GRID + 64;
const UPPER_AT: usize = ROOT_AT + 64 + 32;
const LOWER_AT: usize = UPPER_AT + UPPER_SIZE;
const LEAF_AT: usize = LOWER_AT + LOWER_SIZE;

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// The grid's bytes, whose cells are cubes of half a unit: x along the world's y, y along its z, and z along its x.
fn kept_bytes(kept: &Kept) -> Vec<u8> {
    let mut bytes = vec![0; LEAF_AT + LEAF_SIZE];
    let map = [0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 0.5, 0.0_f64];
    for (i, number) in map.iter().enumerate() {
        put(&mut bytes, 384 + 8 * i, &number.to_le_bytes());
    }
    put(&mut bytes, 528, &10.0_f64.to_le_bytes());
    let offset = |from: usize, to: usize| ((to - from) as u64).to_le_bytes();
    put(&mut bytes, GRID + 24, &offset(GRID, ROOT_AT));
    let last = kept.first.map(|n| n + 7);
    for (i, n) in kept.first.into_iter().chain(last).enumerate() {
        put(&mut bytes, ROOT_AT + 4 * i, &n.to_le_bytes());
    }
    put(&mut bytes, ROOT_AT + 24, &1_u32.to_le_bytes());
    put(&mut bytes, ROOT_AT + 28, &kept.background.to_le_bytes());
    let [x, y, z] = kept.first.map(|n| u64::from(n as u32 >> 12));
    put(
        &mut bytes,
        ROOT_AT + 64,
        &(x << 42 | y << 21 | z).to_le_bytes(),
    );
    put(&mut bytes, ROOT_AT + 72, &offset(ROOT_AT, UPPER_AT));
    let number = |bits: u32, shift: i32| {
        let [x, y, z] = kept.first.map(|n| n >> shift & ((1 << bits) - 1));
        ((x << bits | y) << bits | z) as usize
    };
    inner(
        &mut bytes,
        kept,
        (UPPER_AT, 4096, 8256),
        (number(5, 7), LOWER_AT),
    );
    inner(
        &mut bytes,
        kept,
        (LOWER_AT, 512, 1088),
        (number(4, 3), LEAF_AT),
    );
    for i in 0..512_usize {
        let at = [i >> 6, i >> 3 & 7, i & 7].map(|n| n as i32);
        put(
            &mut bytes,
            LEAF_AT + 96 + 4 * i,
            &(kept.value)(at).to_le_bytes(),
        );
    }
    bytes
}

/// Fills an inner node with background and one child.
fn inner(
    bytes: &mut [u8],
    kept: &Kept,
    (node, mask, table): (usize, usize, usize),
    (number, child): (usize, usize),
) {
    for i in 0..8 * mask {
        put(bytes, node + table + 8 * i, &kept.background.to_le_bytes());
    }
    bytes[node + 32 + mask + number / 8] |= 1 << (number % 8);
    put(
        bytes,
        node + table + 8 * number,
        &((child - node) as u64).to_le_bytes(),
    );
}

/// A file of one segment.
fn file(grids: &[Kept], codec: u16) -> Vec<u8> {
    let mut file = b"NanoVDB0".to_vec();
    file.extend((32_u32 << 21 | 3 << 10).to_le_bytes());
    file.extend((grids.len() as u16).to_le_bytes());
    file.extend(codec.to_le_bytes());
    let parts: Vec<_> = grids
        .iter()
        .map(|kept| (kept.name, kept_bytes(kept)))
        .collect();
    let stored = |bytes: &Vec<u8>| {
        if codec == 0 {
            return bytes.clone();
        }
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::default());
        packer.write_all(bytes).unwrap();
        let packed = packer.finish().unwrap();
        [&(packed.len() as u64).to_le_bytes(), &packed[..]].concat()
    };
    for (name, bytes) in &parts {
        let mut description = vec![0; DESCRIPTION];
        put(&mut description, 0, &(bytes.len() as u64).to_le_bytes());
        put(
            &mut description,
            8,
            &(stored(bytes).len() as u64).to_le_bytes(),
        );
        put(&mut description, 32, &1_u32.to_le_bytes());
        put(&mut description, 36, &2_u32.to_le_bytes());
        put(
            &mut description,
            136,
            &(name.len() as u32 + 1).to_le_bytes(),
        );
        put(&mut description, 168, &codec.to_le_bytes());
        file.extend(description);
        file.extend(name.bytes().chain([0]));
    }
    for (_, bytes) in &parts {
        file.extend(stored(bytes));
    }
    file
}

/// Smoke with temperatures, for tests of scenes: 8³ cells of half a unit.
pub(crate) fn smoke_and_heat() -> Vec<u8> {
    file(&[SMOKE, HEAT], 1)
}

#[track_caller]
fn found(bytes: &[u8], name: &str) -> Grid {
    match find(bytes, name) {
        Ok(Found::Grid(grid)) => grid,
        other => panic!("{other:?}"),
    }
}

#[test]
fn cells_have_their_values_and_others_the_background() {
    for (codec, segments) in [(0, 1), (1, 1), (0, 2), (1, 2)] {
        let mut bytes = file(&[SMOKE, HEAT], codec);
        if segments == 2 {
            bytes = [file(&[SMOKE], codec), file(&[HEAT], codec)].concat();
        }
        for kept in [SMOKE, HEAT] {
            let grid = found(&bytes, kept.name);
            let (first, last) = (kept.first, kept.first.map(|n| n + 7));
            assert_eq!(grid.bounds, CellBox { first, last });
            let values = grid.values(grid.bounds.grown()).unwrap();
            for (i, value) in values.iter().enumerate() {
                let at = [i % 10, i / 10 % 10, i / 100].map(|n| n as i32 - 1);
                let is_kept = at.iter().all(|n| (0..8).contains(n));
                let expected = if is_kept {
                    (kept.value)(at)
                } else {
                    kept.background
                };
                assert!((value - expected).abs() <= 0.0, "{at:?}: {value}");
            }
        }
        assert!(matches!(find(&bytes, "velocity"), Ok(Found::Nothing)));
    }
}

#[test]
fn cells_are_placed_by_the_rows_of_the_map() {
    let bytes = file(&[SMOKE], 0);
    let grid = found(&bytes, "density");
    let placed = grid
        .world_from_cells
        .transform_point3(DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(placed, DVec3::new(11.5, 0.5, 1.0));
}

#[test]
fn parts_of_a_tree_are_found_without_the_rest() {
    let bytes = file(&[SMOKE], 0);
    let grid = found(&bytes, "density");
    let one = CellBox {
        first: [-6, 123, 4],
        last: [-5, 123, 4],
    };
    assert_eq!(
        grid.values(one).unwrap(),
        [2.0 + 24.0 + 256.0, 3.0 + 24.0 + 256.0]
    );
    let far = CellBox {
        first: [5000, 0, 0],
        last: [5000, 0, 1],
    };
    assert_eq!(grid.values(far).unwrap(), [0.0; 2]);
}

#[track_caller]
fn check_refused(bytes: &[u8], expected: &str) {
    let message = match find(bytes, "density") {
        Ok(Found::Grid(grid)) => grid.values(grid.bounds.grown()).unwrap_err().to_string(),
        Ok(Found::Unsupported(what)) => what,
        Ok(Found::Nothing) => "nothing".to_owned(),
        Err(error) => error.to_string(),
    };
    assert!(message.contains(expected), "{message}");
}

#[test]
fn files_that_are_not_read_say_why() {
    let changed = |at: usize, value: &[u8]| {
        let mut bytes = file(&[SMOKE], 0);
        put(&mut bytes, at, value);
        bytes
    };
    check_refused(b"PF 1 1", "ends within");
    check_refused(b"#!bin/sh and more of it", "not NanoVDB");
    check_refused(&changed(8, &(31_u32 << 21).to_le_bytes()), "NanoVDB 31.0");
    check_refused(
        &changed(HEADER + 32, &[2]),
        "of other cells than 32-bit numbers",
    );
    check_refused(&changed(HEADER + 36, &[1]), "of a surface");
    check_refused(&changed(HEADER + 168, &[2]), "of another codec than zip");
    let grid = HEADER + DESCRIPTION + "density".len() + 1;
    check_refused(
        &changed(grid + ROOT_AT + 12, &(-9_i32).to_le_bytes()),
        "empty",
    );
    check_refused(&changed(grid + ROOT_AT + 24, &[9]), "occurs twice");
    check_refused(&changed(grid + ROOT_AT + 72, &[0xff; 8]), "lies outside");
}

#[test]
fn any_shorter_file_is_refused() {
    let first = CellBox {
        first: SMOKE.first,
        last: SMOKE.first,
    };
    for codec in [0, 1] {
        let bytes = file(&[SMOKE], codec);
        for end in (1..bytes.len()).step_by(1 + bytes.len() / 500) {
            let is_read = match find(&bytes[..end], "density") {
                Ok(Found::Grid(grid)) => grid.values(first).is_ok(),
                other => other.is_ok(),
            };
            assert!(!is_read, "{end}");
        }
    }
}

/// Whatever a byte of a header or of a root says, reading ends.
#[test]
fn changed_bytes_of_headers_do_not_panic() {
    let bytes = file(&[SMOKE], 0);
    let root_end = HEADER + DESCRIPTION + "density".len() + 1 + UPPER_AT + 64;
    for at in 0..root_end {
        for value in [0, 1, 0x7f, 0x80, 0xff] {
            let mut bytes = bytes.clone();
            bytes[at] = value;
            if let Ok(Found::Grid(grid)) = find(&bytes, "density") {
                let within = grid.bounds.grown();
                if within.count() < 1 << 16 {
                    let _ = grid.values(within);
                }
            }
        }
    }
}
