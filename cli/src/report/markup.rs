//! Text filters of the page templates: `{{ markup::minus(text) }}`.

use askama::filters::{Html, Safe, escape};

use super::style::subscripts;

/// A true minus sign instead of a hyphen.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Text, escaped, in which `H_x` shows an x below the line.
pub(crate) fn sub(text: &str) -> Safe<String> {
    let Ok(escaped) = escape(text, Html);
    Safe(subscripts(&escaped.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_page() {
        let shown = sub("<b>'H_x' & \"b\"");
        assert_eq!(
            shown.0,
            "&#60;b&#62;&#39;H<sub>x</sub>&#39; &#38; &#34;b&#34;"
        );
    }
}
