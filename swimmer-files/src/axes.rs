//! Axes of a recording that are the tank's x and y.

use std::fmt;
use std::str::FromStr;

/// Two of a recording's axes with their signs: the tank's x and y. `x,-y` is an image, whose y runs down; `z,x` is a
/// motion-capture system with Y up, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axes {
    /// The tank's x: which axis (0, 1, 2 for x, y, z), and whether it runs the other way.
    pub x: (usize, bool),
    /// The tank's y.
    pub y: (usize, bool),
}

impl Axes {
    /// An image: y runs down.
    pub const IMAGE: Self = Self {
        x: (0, false),
        y: (1, true),
    };
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = [self.x, self.y].map(|(axis, down)| {
            let letter = ['x', 'y', 'z'].get(axis).copied().unwrap_or('?');
            format!("{}{letter}", if down { "-" } else { "" })
        });
        write!(f, "{x},{y}")
    }
}

impl FromStr for Axes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let axis = |text: &str| {
            let text = text.trim();
            let (down, letter) = match text.strip_prefix('-') {
                Some(rest) => (true, rest),
                None => (false, text.strip_prefix('+').unwrap_or(text)),
            };
            let letters = ["x", "y", "z"];
            let index = letters
                .iter()
                .position(|l| l.eq_ignore_ascii_case(letter))?;
            Some((index, down))
        };
        text.split_once(',')
            .and_then(|(x, y)| Some((axis(x)?, axis(y)?)))
            .filter(|(x, y)| x.0 != y.0)
            .map(|(x, y)| Self { x, y })
            .ok_or_else(|| {
                format!(
                    "`{text}` are no axes; write which of the recording's axes are the tank's x and y, as x,y or x,-y (an image) \
                     or z,x (Y up)"
                )
            })
    }
}

#[cfg(test)]
mod tests {
    use super::Axes;

    #[test]
    fn axes_are_read_as_they_are_written() {
        for text in ["x,y", "x,-y", "z,x", "-z,-x"] {
            assert_eq!(text.parse::<Axes>().unwrap().to_string(), text);
        }
        assert_eq!("X, -Y".parse(), Ok(Axes::IMAGE));
        for text in ["", "x", "x,x", "x,-x", "x,y,z", "a,b"] {
            assert!(
                text.parse::<Axes>().unwrap_err().contains("no axes"),
                "{text}"
            );
        }
    }
}
