//! Parser of the links, pictures and formulas of a page, with their positions in the text.

use std::ops::Range;

use pulldown_cmark::{Event, LinkType, Options, Parser, Tag};

/// Link or picture: its target and the range of the target in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Link {
    pub(crate) range: Range<usize>,
    pub(crate) target: String,
}

/// Formula: its range in the text and its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Formula {
    pub(crate) range: Range<usize>,
    pub(crate) tex: String,
    pub(crate) display: bool,
}

/// Inline links and pictures, and `<img src="…">`, which a README needs for sizes.
pub(crate) fn links(text: &str) -> Vec<Link> {
    let mut links = Vec::new();
    for (event, range) in parser(text).into_offset_iter() {
        match event {
            Event::Start(
                Tag::Link {
                    link_type: LinkType::Inline,
                    dest_url,
                    ..
                }
                | Tag::Image {
                    link_type: LinkType::Inline,
                    dest_url,
                    ..
                },
            ) => links.extend(place_of(
                text,
                &range,
                &format!("]({dest_url}"),
                2,
                &dest_url,
            )),
            Event::Html(html) | Event::InlineHtml(html) => {
                for attribute in ["src=\"", "href=\""] {
                    for (at, _) in html.match_indices(attribute) {
                        let start = range.start + at + attribute.len();
                        let target = text[start..].split('"').next().unwrap_or_default();
                        links.push(Link {
                            range: start..start + target.len(),
                            target: target.to_owned(),
                        });
                    }
                }
            }
            _ => {}
        }
    }
    links
}

fn place_of(
    text: &str,
    range: &Range<usize>,
    written: &str,
    skip: usize,
    target: &str,
) -> Option<Link> {
    let within = text.get(range.clone())?;
    let start = range.start + within.rfind(written)? + skip;
    Some(Link {
        range: start..start + target.len(),
        target: target.to_owned(),
    })
}

/// Formulas, `$inline$` or `$$displayed$$`.
pub(crate) fn formulas(text: &str) -> Vec<Formula> {
    let formulas = parser(text).into_offset_iter();
    formulas
        .filter_map(|(event, range)| match event {
            Event::InlineMath(tex) => Some((tex, range, false)),
            Event::DisplayMath(tex) => Some((tex, range, true)),
            _ => None,
        })
        .map(|(tex, range, display)| Formula {
            range,
            tex: tex.into_string(),
            display,
        })
        .collect()
}

/// Returns the text with some ranges replaced. The ranges are in order and do not overlap.
pub(crate) fn replaced(text: &str, changes: &[(Range<usize>, String)]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut end = 0;
    for (range, words) in changes {
        out.push_str(&text[end..range.start]);
        out.push_str(words);
        end = range.end;
    }
    out.push_str(&text[end..]);
    out
}

fn parser(text: &str) -> Parser<'_> {
    Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_MATH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_where_they_are_meant() {
        let text = "See [the `model`](../a.rs#item), ![a](b.png) and `[no](link)`.\n\n    [no](code)\n\n<img src=\"c.gif\" width=\"40%\">\n";
        let found = links(text);
        let targets: Vec<_> = found.iter().map(|link| link.target.as_str()).collect();
        assert_eq!(targets, ["../a.rs#item", "b.png", "c.gif"]);
        for link in found {
            assert_eq!(&text[link.range], link.target);
        }
    }

    #[test]
    fn formulas_are_no_code() {
        let text = "With $a_1$ and\n\n$$\nb^2\n$$\n\n```sh\n$ cost $5\n```\n";
        let found = formulas(text);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].tex.as_str(), found[0].display), ("a_1", false));
        assert!(found[1].display && found[1].tex.trim() == "b^2");
        let changes: Vec<_> = found
            .into_iter()
            .map(|one| (one.range, "X".to_owned()))
            .collect();
        assert!(replaced(text, &changes).starts_with("With X and\n\nX\n"));
    }
}
