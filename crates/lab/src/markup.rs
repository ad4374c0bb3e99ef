//! HTML and SVG as a tree, so that no text can become markup.

use std::fmt::{self, Display, Formatter};

/// An element with its attributes and content.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    content: Vec<Node>,
}

#[derive(Clone, Debug)]
enum Node {
    Element(Element),
    Text(String),
    Code(String),
}

/// Returns an element without attributes and content.
pub(crate) fn element(name: &'static str) -> Element {
    Element {
        name,
        attributes: Vec::new(),
        content: Vec::new(),
    }
}

impl Element {
    pub(crate) fn with(mut self, attribute: &'static str, value: impl Display) -> Self {
        self.attributes.push((attribute, value.to_string()));
        self
    }

    pub(crate) fn class(self, name: &'static str) -> Self {
        self.with("class", name)
    }

    pub(crate) fn text(mut self, text: impl Display) -> Self {
        self.content.push(Node::Text(text.to_string()));
        self
    }

    pub(crate) fn child(mut self, child: Self) -> Self {
        self.content.push(Node::Element(child));
        self
    }

    pub(crate) fn children(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.content.extend(children.into_iter().map(Node::Element));
        self
    }

    /// Adds the content of a `script` or `style` without escapes, which HTML does not have there.
    pub(crate) fn code(mut self, code: impl Into<String>) -> Self {
        let code = code.into();
        debug_assert!(!code.contains("</"), "the code ends its element");
        self.content.push(Node::Code(code));
        self
    }

    /// Returns true for elements of HTML that have no end tag.
    fn is_void(&self) -> bool {
        self.name == "meta"
    }

    /// Returns true for elements within a line. All others begin on a new line, so that the source can be read.
    fn is_inline(&self) -> bool {
        self.name == "b"
    }
}

impl Display for Element {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if !self.is_inline() {
            writeln!(f)?;
        }
        write!(f, "<{}", self.name)?;
        for (attribute, value) in &self.attributes {
            write!(f, " {attribute}=\"{}\"", escaped(value))?;
        }
        write!(f, ">")?;
        for node in &self.content {
            match node {
                Node::Element(element) => write!(f, "{element}")?,
                Node::Text(text) => write!(f, "{}", escaped(text))?,
                Node::Code(code) => write!(f, "{code}")?,
            }
        }
        if self.is_void() {
            return Ok(());
        }
        write!(f, "</{}>", self.name)
    }
}

/// Escapes a text for content and attributes.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // Other control characters are errors in HTML, however they are written.
            '\0'..='\x08' | '\x0b' | '\x0e'..='\x1f' | '\x7f' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Escapes JSON for a `script`, so that nothing in it can end the element or begin a comment.
pub(crate) fn script_json(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_attributes_are_escaped() {
        let hostile = "</p><script>\"'&\0";
        let markup = element("p").with("title", hostile).text(hostile);
        let safe = "&lt;/p&gt;&lt;script&gt;&quot;&#39;&amp;\u{fffd}";
        assert_eq!(
            markup.to_string(),
            format!("\n<p title=\"{safe}\">{safe}</p>")
        );
    }

    #[test]
    fn json_cannot_end_its_script() {
        let json = serde_json::to_string("</script><!-- \u{2028}").unwrap();
        let safe = script_json(&json);
        assert!(!safe.contains('<'));
        let back: String = serde_json::from_str(&safe).unwrap();
        assert_eq!(back, "</script><!-- \u{2028}");
    }

    #[test]
    fn elements_nest_and_void_ones_have_no_end() {
        let line = element("b")
            .child(element("i").text(1))
            .child(element("meta"));
        assert_eq!(line.to_string(), "<b>\n<i>1</i>\n<meta></b>");
    }
}
