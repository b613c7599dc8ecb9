//! Paths inside the checkout, written with `/`, without `.` and `..`.

/// Target of a link in a page, from the root. Returns `None` if it is outside the checkout.
pub(crate) fn joined(page: &str, link: &str) -> Option<String> {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

/// Relative link from one page to another file, both given from the root.
pub(crate) fn relative(page: &str, place: &str) -> String {
    let up = page.matches('/').count();
    format!("{}{place}", "../".repeat(up))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_seen_from_the_root() {
        let from = "docs/theory/model.md";
        assert_eq!(
            joined(from, "../../README.md").as_deref(),
            Some("README.md")
        );
        assert_eq!(
            joined(from, "./drag.md").as_deref(),
            Some("docs/theory/drag.md")
        );
        assert_eq!(joined(from, "../../../README.md"), None);
        assert_eq!(joined("README.md", "docs/").as_deref(), Some("docs"));
        assert_eq!(relative(from, "source/a.rs.html"), "../../source/a.rs.html");
        assert_eq!(
            relative("README.md", "source/a.rs.html"),
            "source/a.rs.html"
        );
    }
}
