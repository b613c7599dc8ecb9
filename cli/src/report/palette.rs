//! Colours of continuous fields: the same stops in the figures of the command and of the book, and in the lab page
//! (`lab/page/src/style/palette.json`).

use plotters::style::RGBColor;

/// Stops of a palette, from its low end to its high end.
type Stops = [[u8; 3]; 9];

/// `RdBu` of `ColorBrewer` without its darkest ends, on which no curve stands out: blue below zero, white at zero, red above. It reads
/// in grey and to the colour-blind.
const DIVERGING: Stops = [
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
];

/// *viridis*: its lightness rises evenly.
const SEQUENTIAL: Stops = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// A palette of a continuous field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Palette {
    /// For a field with a sign; zero is in the middle.
    Diverging,
    /// For a field that has none.
    Sequential,
}

impl Palette {
    /// Colour at a share of the range, 0 at its low end and 1 at its high end.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // places among nine, parts of a byte
    pub(crate) fn color(self, share: f64) -> RGBColor {
        let stops = match self {
            Self::Diverging => &DIVERGING,
            Self::Sequential => &SEQUENTIAL,
        };
        let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let below = (place.floor() as usize).min(stops.len() - 2);
        let part = place - below as f64;
        let mixed = |channel: usize| {
            let [low, high] = [below, below + 1].map(|stop| f64::from(stops[stop][channel]));
            (low + part * (high - low)).round() as u8
        };
        RGBColor(mixed(0), mixed(1), mixed(2))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn the_page_has_the_same_stops() {
        let text = include_str!("../../../lab/page/src/style/palette.json");
        let page: BTreeMap<String, Stops> = serde_json::from_str(text).unwrap();
        assert_eq!(page["diverging"], DIVERGING);
        assert_eq!(page["sequential"], SEQUENTIAL);
    }

    #[test]
    fn lightness_rises_or_has_its_top_at_zero() {
        let lightness = |color: RGBColor| {
            0.2126 * f64::from(color.0) + 0.7152 * f64::from(color.1) + 0.0722 * f64::from(color.2)
        };
        let at = |palette: Palette, step: u32| lightness(palette.color(f64::from(step) / 100.0));
        for step in 0..100 {
            let rises = |palette| at(palette, step + 1) > at(palette, step) - 0.6;
            assert!(rises(Palette::Sequential), "{step}");
            assert_eq!(rises(Palette::Diverging), step < 50, "{step}");
        }
    }
}
