//! Parsing any bytes gives an error or a scene, never a panic.

use crate::pbrt::parse_text;
use proptest::prelude::*;

const VALID: &str = "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [45]\n\
    Film \"rgb\" \"integer xresolution\" 40 \"string filename\" \"a\\\"b.exr\" # µ\nWorldBegin\n\
    AttributeBegin Rotate 30 0 1 0 Attribute \"shape\" \"float radius\" 3\n\
    MakeNamedMaterial \"m\" \"string type\" \"conductor\" \"spectrum eta\" \"metal-Cu-eta\"\n\
    NamedMaterial \"m\" AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"bool twosided\" true\n\
    Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\nAttributeEnd\n\
    ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n\
    Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"x.png\"\n\
    Transform [1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1] CoordinateSystem \"c\" CoordSysTransform \"c\"\n";

/// Words between bars.
const WORDS: &str = "WorldBegin|AttributeBegin|AttributeEnd|ObjectBegin|ObjectEnd|ObjectInstance|Shape|Material|\
    MakeNamedMaterial|NamedMaterial|Texture|Transform|LookAt|Scale|[|]|\"|\"a\"|\"float x\"|\
    \"string type\"|\"point3 P\"|1|-0|1e38|0x|true|#|\n|\\|µ|\"sphere\"|\"diffuse\"|\"spectrum\"|\
    TransformBegin|TransformEnd|Option|ActiveTransform|All|Attribute|\"shape\"|MediumInterface|\
    ColorSpace";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_text_never_panics(text in any::<String>()) {
        let _ = parse_text("s", &text).map_err(|error| error.to_string());
    }

    #[test]
    fn words_in_any_order_never_panic(
        words in proptest::collection::vec(proptest::sample::select(WORDS.split('|').collect::<Vec<_>>()), 0..40)
    ) {
        let _ = parse_text("s", &words.join(" ")).map_err(|error| error.to_string());
    }

    #[test]
    fn mutated_scenes_never_panic(
        at in any::<proptest::sample::Index>(),
        length in 0usize..6,
        new in "[\\PC\\n]{0,4}",
    ) {
        let mut characters: Vec<char> = VALID.chars().collect();
        let start = at.index(characters.len());
        let end = (start + length).min(characters.len());
        characters.splice(start..end, new.chars());
        let text: String = characters.into_iter().collect();
        if let Err(error) = parse_text("s", &text) {
            prop_assert!(error.line().is_some() && error.column().is_some());
            let mut report = String::new();
            miette::GraphicalReportHandler::new().render_report(&mut report, &error).unwrap();
        }
    }
}

#[test]
fn the_scene_that_is_mutated_is_valid() {
    parse_text("s", VALID).unwrap();
}
