//! The script modules of the page. The viewer serves them as files; a report has all of them in one script.
//!
//! The policy of a report's page forbids loading, so a script in it cannot import another one. Therefore each
//! module becomes a function in the report, which returns the exports of the module.

/// Returns the name of each module with its text.
macro_rules! modules {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../../page/", $name, ".js")))),*]
    };
}

/// All modules, each after the modules that it imports.
const MODULES: [(&str, &str); 21] = modules![
    "dom" "format" "number" "glossary" "table" "axis" "plot" "sections" "falsecolor" "view"
    "pixels" "shaders" "picture" "stage" "gestures" "divider" "values" "tiles" "strategies"
    "images" "report"
];

/// Returns the text of the module with the file name `name`. None: there is none.
pub fn module(name: &str) -> Option<&'static str> {
    let stem = name.strip_suffix(".js")?;
    let mut modules = MODULES.iter();
    modules
        .find(|(name, _)| *name == stem)
        .map(|(_, text)| *text)
}

/// Returns all modules as one script.
pub(super) fn script() -> String {
    let functions = MODULES.iter().map(|(name, text)| function(name, text));
    std::iter::once("const modules = {};\n".to_owned())
        .chain(functions)
        .collect()
}

/// Converts a module to a function. Each import and export has to begin a line.
fn function(name: &str, text: &str) -> String {
    let (mut body, mut exports) = (String::new(), Vec::new());
    for line in text.lines() {
        let line = if let Some(import) = line.strip_prefix("import ") {
            let (names, file) = import
                .split_once(" from ")
                .expect("an import names its module");
            let path = file.trim_matches(['"', ';', '.', '/']);
            let module = path.trim_end_matches(".js");
            format!("const {names} = modules[\"{module}\"];")
        } else if let Some(exported) = line.strip_prefix("export ") {
            exports.push(exported_name(exported));
            exported.to_owned()
        } else {
            line.to_owned()
        };
        body += &(line + "\n");
    }
    let exports = exports.join(", ");
    format!("modules[\"{name}\"] = (() => {{\n{body}return {{ {exports} }};\n}})();\n")
}

/// Returns the name in `function name(…`, `const name = …` or `class name …`.
fn exported_name(declaration: &str) -> &str {
    let is_keyword = |word: &&str| !["async", "function", "const", "class"].contains(word);
    let mut words = declaration.split([' ', '(']);
    words.find(is_keyword).unwrap_or(declaration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_import_is_an_export_of_a_module_before() {
        let mut known: Vec<(&str, Vec<&str>)> = Vec::new();
        for (name, text) in MODULES {
            let imports = text.lines().filter_map(|line| line.strip_prefix("import "));
            for import in imports {
                let (names, file) = import.split_once(" from ").unwrap();
                let module = file.trim_start_matches("\"./").trim_end_matches(".js\";");
                let exports = known.iter().find(|(known, _)| *known == module);
                let (_, exports) = exports.unwrap_or_else(|| panic!("{name} imports {module}"));
                for wanted in names.trim_matches(['{', '}', ' ']).split(", ") {
                    assert!(exports.contains(&wanted), "{name}: {wanted} of {module}");
                }
            }
            let exports = text.lines().filter_map(|line| line.strip_prefix("export "));
            known.push((name, exports.map(exported_name).collect()));
        }
        assert_eq!(known.last().map(|(name, _)| *name), Some("report"));
    }

    #[test]
    fn a_module_becomes_a_function_of_its_exports() {
        let text = "import { a, b } from \"./other.js\";\n\nexport const two = a;\n\
                    export async function f(x) {}\nexport class C extends b {}\n";
        let expected = "modules[\"one\"] = (() => {\nconst { a, b } = modules[\"other\"];\n\n\
                        const two = a;\nasync function f(x) {}\nclass C extends b {}\n\
                        return { two, f, C };\n})();\n";
        assert_eq!(function("one", text), expected);
        assert_eq!(module("dom.js"), Some(MODULES[0].1));
        assert_eq!((module("dom"), module("none.js")), (None, None));
    }
}
