//! Places of words next to points of a chart, so that they cover neither each other nor the points.

/// Left, top, right and bottom, pixels of the drawing.
type Box = [i32; 4];

/// Boxes that a chart's words must not cover.
#[derive(Debug, Default)]
pub(super) struct Obstacles(Vec<Box>);

/// A word's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placed {
    /// From the point to the left top corner of the word.
    pub(super) offset: (i32, i32),
    /// The word is so far from its point that a line must join them.
    pub(super) is_far: bool,
}

/// Steps outwards that are tried; beyond them the word stays at its usual place.
const STEPS: i32 = 8;

impl Obstacles {
    /// Keeps words off a disc.
    pub(super) fn disc(&mut self, (x, y): (i32, i32), radius: i32) {
        self.0
            .push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Finds a place for a word of this size next to a point: right of it if that is free, otherwise around it, nearest first.
    /// `usual` is the offset of the word right of its point; `within` is the drawing.
    pub(super) fn word(
        &mut self,
        at: (i32, i32),
        size: (i32, i32),
        usual: (i32, i32),
        within: (i32, i32),
    ) -> Placed {
        let (width, height) = size;
        let (gap, middle) = (usual.0, usual.1);
        let around = |step: i32| {
            let out = gap + step * height / 2;
            [
                (out, middle),
                (out, middle - out),
                (out, middle + out),
                (-width / 2, middle - out - height / 2),
                (-width / 2, middle + out + height / 2),
                (-width - out, middle),
                (-width - out, middle - out),
                (-width - out, middle + out),
            ]
            .map(|offset| (step, offset))
        };
        let covers = |(x, y): (i32, i32)| {
            let (left, top) = (at.0 + x, at.1 + y);
            [left, top, left + width, top + height]
        };
        let is_free = |[left, top, right, bottom]: Box| {
            left >= 0
                && top >= 0
                && right <= within.0
                && bottom <= within.1
                && self.0.iter().all(|other| {
                    right <= other[0] || other[2] <= left || bottom <= other[1] || other[3] <= top
                })
        };
        let free = (0..STEPS)
            .flat_map(around)
            .find(|(_, offset)| is_free(covers(*offset)));
        let (step, offset) = free.unwrap_or((0, usual));
        self.0.push(covers(offset));
        Placed {
            offset,
            is_far: step > 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (i32, i32) = (40, 15);
    const USUAL: (i32, i32) = (6, -8);
    const WITHIN: (i32, i32) = (500, 400);

    #[test]
    fn a_lone_word_is_right_of_its_point() {
        let placed = Obstacles::default().word((100, 100), SIZE, USUAL, WITHIN);
        assert_eq!((placed.offset, placed.is_far), (USUAL, false));
    }

    #[test]
    fn words_at_one_point_do_not_cover_each_other() {
        let mut places = Obstacles::default();
        places.disc((250, 200), 4);
        for _ in 0..20 {
            places.word((250, 200), SIZE, USUAL, WITHIN);
        }
        let boxes = &places.0;
        for (index, one) in boxes.iter().enumerate() {
            for other in &boxes[..index] {
                let apart = one[2] <= other[0]
                    || other[2] <= one[0]
                    || one[3] <= other[1]
                    || other[3] <= one[1];
                assert!(apart, "{one:?} covers {other:?}");
            }
        }
    }

    #[test]
    fn a_word_stays_in_the_drawing() {
        let placed = Obstacles::default().word((498, 100), SIZE, USUAL, WITHIN);
        assert!(498 + placed.offset.0 + SIZE.0 <= WITHIN.0);
    }
}
