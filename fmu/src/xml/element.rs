//! A small element tree to be written. What reads XML (roxmltree) does not write it, and elements with
//! attributes and no text need no library: a document is what this file holds.

/// An XML element with its attributes in the order in which they were added.
pub(crate) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    pub(crate) fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), children: Vec::new() }
    }

    pub(crate) fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// An attribute where there is a value.
    pub(crate) fn maybe(self, name: &'static str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// An attribute whose empty value says nothing.
    pub(crate) fn text(self, name: &'static str, value: &str) -> Self {
        self.maybe(name, (!value.is_empty()).then_some(value))
    }

    /// An attribute that is false where it is absent.
    pub(crate) fn flag(self, name: &'static str, value: bool) -> Self {
        self.maybe(name, value.then_some("true"))
    }

    pub(crate) fn child(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    pub(crate) fn children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// A child only where it would not be empty.
    pub(crate) fn list(self, list: Element) -> Self {
        if list.children.is_empty() { self } else { self.child(list) }
    }

    /// The document, UTF-8.
    pub(crate) fn to_xml(&self) -> String {
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        self.write(&mut text, 0);
        text
    }

    fn write(&self, text: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        text.extend([indent.as_str(), "<", self.name]);
        for (name, value) in &self.attributes {
            text.extend([" ", name, "=\""]);
            escape(value, text);
            text.push('"');
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.write(text, depth + 1);
        }
        text.extend([indent.as_str(), "</", self.name, ">\n"]);
    }
}

/// The five characters that stand for themselves nowhere in XML (section 2.4). Control characters are
/// refused before anything is written.
fn escape(value: &str, text: &mut String) {
    for character in value.chars() {
        match character {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '\'' => text.push_str("&apos;"),
            '"' => text.push_str("&quot;"),
            other => text.push(other),
        }
    }
}

/// The shortest decimal that reads back as the same double; `xs:double` knows exponents.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}

#[cfg(all(test, feature = "import"))]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let value = "<a & b> 'c' \"d\" \u{b5}";
        let inner = Element::new("inner").with("x", value).flag("yes", true).flag("no", false);
        let text = Element::new("outer").child(inner).list(Element::new("none")).to_xml();
        let document = crate::xml::read::parse(&text).expect("well-formed");
        let inner = document.root_element().first_element_child().expect("a child");
        let attributes: Vec<_> = inner.attributes().map(|it| (it.name(), it.value())).collect();
        assert_eq!(attributes, [("x", value), ("yes", "true")]);
        assert_eq!(document.root_element().children().filter(|it| it.is_element()).count(), 1);
    }
}
