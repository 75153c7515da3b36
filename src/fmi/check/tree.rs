//! modelDescription.xml as a tree of elements with places: read whatever is wrong with it.

use crate::fmi::import::xml::{self, Broken, Element};

/// An element with those inside it.
pub(super) struct Node {
    pub(super) element: Element,
    pub(super) children: Vec<Node>,
}

impl Node {
    /// Reads the XML; fails if it is not well-formed.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Broken> {
        // The elements that are open, outermost first.
        let mut open: Vec<Node> = Vec::new();
        xml::read::<Broken>(bytes, |path, element| {
            while open.len() > path.len() {
                close(&mut open);
            }
            open.push(Node { element: element.clone(), children: Vec::new() });
            Ok(())
        })?;
        while open.len() > 1 {
            close(&mut open);
        }
        open.pop().ok_or_else(|| Broken { place: None, what: "there is no element in the file".into() })
    }

    pub(super) fn name(&self) -> &str {
        self.element.name()
    }

    pub(super) fn text(&self, attribute: &str) -> Option<&str> {
        self.element.text(attribute)
    }

    /// The first element called `name` inside this one.
    pub(super) fn child(&self, name: &str) -> Option<&Node> {
        self.children.iter().find(|c| c.name() == name)
    }

    /// The elements called `name` inside this one.
    pub(super) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Node> {
        self.children.iter().filter(move |c| c.name() == name)
    }
}

fn close(open: &mut Vec<Node>) {
    if let Some(node) = open.pop()
        && let Some(parent) = open.last_mut()
    {
        parent.children.push(node);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(node: &Node) -> String {
        let children: Vec<String> = node.children.iter().map(outline).collect();
        format!("{}({})", node.name(), children.join(" "))
    }

    #[test]
    fn keeps_order_and_nesting() {
        let text = b"<a><b><c/><d></d></b><e/><b x='1'><f><g/></f></b></a>";
        let tree = Node::parse(text).unwrap_or_else(|b| panic!("{}", b.what));
        assert_eq!(outline(&tree), "a(b(c() d()) e() b(f(g())))");
        assert_eq!(tree.all("b").nth(1).and_then(|b| b.text("x")), Some("1"));
        assert!(Node::parse(b"").is_err() && Node::parse(b"<a>").is_err());
    }
}
