use super::*;
use crate::cases;
use expect_test::expect_file;
use proptest::prelude::*;

const QUAD: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nproperty float s\nproperty float t\nproperty uchar red\n\
    element face 3\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n\
    0 0 0 0 0 1\n1 0 0 1 0 2\n1 1 0 1 1 3\n0 1 0 0 1 4\n\
    4 0 1 2 3\n2 0 1\n3 2 1 0\n7\n";

/// Returns the same mesh as [`QUAD`], with normals, in binary.
fn binary_quad(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\r\nformat {format} 1.0\r\nelement face 2\r\nproperty int id\r\n\
         property list ushort uint vertex_indices\r\nelement vertex 4\r\nproperty double x\r\n\
         property double y\r\nproperty double z\r\nproperty float nx\r\nproperty float ny\r\n\
         property float nz\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |little: &[u8]| {
        let mut little = little.to_vec();
        if format == "binary_big_endian" {
            little.reverse();
        }
        bytes.extend(little);
    };
    for corners in [&[0u32, 1, 2, 3][..], &[2, 1, 0]] {
        put(&5i32.to_le_bytes());
        put(&(corners.len() as u16).to_le_bytes());
        for corner in corners {
            put(&corner.to_le_bytes());
        }
    }
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0f64]] {
        for value in [x, y, 0.0] {
            put(&value.to_le_bytes());
        }
        for value in [0.0, 0.0, 1.0f32] {
            put(&value.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn ascii_is_read_with_uv_and_skipped_faces() {
    let mesh = parse(QUAD.as_bytes()).unwrap();
    assert_eq!(
        mesh.positions,
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]
    );
    assert_eq!(mesh.uvs, [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
    assert_eq!((mesh.normals.len(), mesh.repairs.faces), (0, 1));
}

#[test]
fn both_byte_orders_give_the_same_mesh_whatever_the_order_of_elements() {
    let little = parse(&binary_quad("binary_little_endian")).unwrap();
    let big = parse(&binary_quad("binary_big_endian")).unwrap();
    assert_eq!(little, big);
    assert_eq!(little.positions, parse(QUAD.as_bytes()).unwrap().positions);
    assert_eq!(little.normals, [[0., 0., 1.]; 4]);
    assert_eq!(little.triangles, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
}

/// Lines that say nothing about the mesh may have any bytes.
#[test]
fn comments_of_headers_are_no_text() {
    let plain = parse(QUAD.as_bytes()).unwrap();
    for line in [
        &b"comment caf\xe9"[..],
        b"comment \xff\xfe\x80",
        b"comment end_header",
        b"obj_info Gr\xf6\xdfe",
        b"comment \xe4\xb8",
        b"\t comment\t\xa0",
    ] {
        let [before, after] =
            ["comment c", "\nelement vertex"].map(|part| QUAD.find(part).unwrap());
        let quad = QUAD.as_bytes();
        let bytes = [&quad[..before], line, &quad[after..]].concat();
        assert_eq!(parse(&bytes).unwrap(), plain, "{line:?}");
    }
}

#[test]
fn errors_of_broken_files_name_element_and_line() {
    cases::check(&expect_file!["./cases.txt"], |change| {
        let (from, to) = change.split_once(" => ").unwrap();
        let [from, to] = [from, to].map(cases::unescaped);
        assert!(QUAD.contains(&from), "{from}");
        let broken = QUAD.replacen(&from, &to, 1);
        let error = parse(broken.as_bytes()).unwrap_err();
        error.in_file(Path::new("m.ply")).to_string()
    });
}

#[test]
fn a_binary_file_with_a_nan_is_repaired_or_names_the_vertex() {
    let with_nan = |back: usize| {
        let mut bytes = binary_quad("binary_little_endian");
        let at = bytes.len() - back;
        bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        parse(&bytes)
    };
    let mesh = with_nan(4).unwrap();
    assert_eq!((mesh.normals[3], mesh.repairs.normals), ([0., 0., 1.], 1));
    let mut bytes = binary_quad("binary_little_endian");
    let z = bytes.len() - 20;
    bytes[z..z + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let error = parse(&bytes).unwrap_err();
    assert_eq!(error.to_string(), "vertex 3: `z` is not a finite number");
}

/// Reads a mesh of vertices, each with a normal and texture coordinates, and faces.
fn with_attributes(vertices: &[&str], faces: &[&str]) -> PlyMesh {
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n\
         element face {}\nproperty list uchar int vertex_index\nend_header\n",
        vertices.len(),
        faces.len()
    );
    let text = header + &vertices.join("\n") + "\n" + &faces.join("\n") + "\n";
    parse(text.as_bytes()).unwrap()
}

#[test]
fn attributes_that_cannot_be_used_are_repaired_and_counted() {
    let vertices = [
        "0 0 0 nan 0 1 0 0",
        "1 0 0 0 0 0 inf 0",
        "1 1 0 0 1e99 0 1 1",
        "0 1 0 0 0 -2 0 nan",
    ];
    let faces = ["3 0 1 2", "3 0 2 3", "3 1 1 2", "2 0 1", "0"];
    let mesh = with_attributes(&vertices, &faces);
    // The first triangle has no other normal; the second lies on the side of its last one.
    let bits = |normal: [f32; 3]| normal.map(f32::to_bits);
    assert_eq!(bits(mesh.normals[1]), bits([0., 0., 1.]));
    assert_eq!(bits(mesh.normals[3]), bits([0., 0., -2.]));
    assert_eq!(mesh.uvs, [[0., 0.], [0., 0.], [1., 1.], [0., 0.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 1, 2]]);
    let expected = Repairs {
        faces: 3,
        normals: 3,
        uvs: 2,
        ..Repairs::default()
    };
    assert_eq!(mesh.repairs, expected);
}

/// Returns the area of all triangles of a mesh in the plane z = 0.
fn total_area(mesh: &PlyMesh) -> f64 {
    let area = |&triangle: &[u32; 3]| repair::area(&mesh.positions, triangle).z / 2.0;
    mesh.triangles.iter().map(area).sum()
}

#[test]
fn polygons_of_any_number_of_corners_are_covered() {
    let at = |x: i32, y: i32| format!("{x} {y} 0 0 0 1 0 0");
    let arrow = [at(0, 0), at(4, 0), at(1, 1), at(0, 4)];
    let hexagon = [at(0, 0), at(2, 0), at(2, 1), at(1, 1), at(1, 2), at(0, 2)];
    let check = |corners: &[String], face: &str, area: f64| {
        let corners: Vec<&str> = corners.iter().map(String::as_str).collect();
        let mesh = with_attributes(&corners, &[face]);
        assert!((total_area(&mesh) - area).abs() < 1e-6, "{face}");
        assert_eq!(mesh.repairs, Repairs::default());
    };
    // Split at either diagonal.
    check(&arrow, "4 0 1 2 3", 4.0);
    check(&arrow, "4 1 2 3 0", 4.0);
    check(&hexagon, "6 0 1 2 3 4 5", 3.0);
    check(&hexagon, "6 2 3 4 5 0 1", 3.0);
    check(&hexagon, "5 0 1 2 3 5", 2.5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes);
        let _ = parse(&[b"ply\nformat binary_little_endian 1.0\n".as_slice(), &bytes].concat());
    }

    #[test]
    fn mutated_files_never_panic(at in 0usize..400, byte in any::<u8>(), length in 0usize..600) {
        for mut bytes in [QUAD.as_bytes().to_vec(), binary_quad("binary_big_endian")] {
            let index = at % bytes.len();
            bytes[index] = byte;
            bytes.truncate(length.max(100));
            if let Ok(mesh) = parse(&bytes) {
                let count = mesh.positions.len() as u32;
                prop_assert!(mesh.triangles.iter().flatten().all(|&corner| corner < count));
            }
        }
    }
}
