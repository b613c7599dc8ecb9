//! Damage of text files on their way from the laboratory: more than forty kinds, each at a seeded place.

// Each damage takes a text and a generator and gives bytes, whether it needs all of them or not.
#![allow(clippy::needless_pass_by_value)]
#![allow(clippy::assigning_clones)] // lines are small

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A file taken apart: lines with their ends, the first few of which are the header.
#[derive(Clone)]
pub(crate) struct Text {
    pub(crate) lines: Vec<String>,
    pub(crate) header: usize,
    pub(crate) delimiter: char,
}

pub(crate) type Damage = fn(&mut ChaCha8Rng, Text) -> Vec<u8>;

impl Text {
    fn bytes(self) -> Vec<u8> {
        self.lines.concat().into_bytes()
    }

    /// A line of data.
    fn data(&self, rng: &mut ChaCha8Rng) -> usize {
        rng.random_range(self.header..self.lines.len())
    }

    fn head(&self, rng: &mut ChaCha8Rng) -> usize {
        rng.random_range(0..self.header)
    }

    /// Changes one cell of a line of data that holds a number; `None` where the line has none.
    fn cell(mut self, rng: &mut ChaCha8Rng, change: impl Fn(&str) -> String) -> Vec<u8> {
        for _ in 0..100 {
            let line = self.data(rng);
            let (body, end) = body(&self.lines[line]);
            let mut cells: Vec<String> = body.split(self.delimiter).map(str::to_owned).collect();
            let at = rng.random_range(0..cells.len());
            if cells[at].trim().contains(|c: char| c.is_ascii_digit()) {
                cells[at] = change(&cells[at]);
                self.lines[line] = cells.join(&self.delimiter.to_string()) + end;
                break;
            }
        }
        self.bytes()
    }
}

fn body(line: &str) -> (&str, &str) {
    let body = line.trim_end_matches(['\r', '\n']);
    (body, &line[body.len()..])
}

fn between(rng: &mut ChaCha8Rng, text: Text, from: f64, to: f64) -> Vec<u8> {
    let mut bytes = text.bytes();
    let length = bytes.len() as f64;
    let at = (length * rng.random_range(from..to)) as usize;
    bytes.truncate(at);
    bytes
}

fn insert(rng: &mut ChaCha8Rng, text: Text, what: &[u8]) -> Vec<u8> {
    let mut bytes = text.bytes();
    let at = rng.random_range(0..bytes.len());
    bytes.splice(at..at, what.iter().copied());
    bytes
}

fn every_line(text: Text, change: impl Fn(usize, &str, &str) -> String) -> Vec<u8> {
    let lines = text.lines.iter().enumerate();
    lines
        .map(|(index, line)| {
            let (body, end) = body(line);
            change(index, body, end)
        })
        .collect::<String>()
        .into_bytes()
}

fn utf16(text: Text, mark: bool) -> Vec<u8> {
    let all = text.lines.concat();
    let mark = if mark { "\u{feff}" } else { "" };
    let units = mark.encode_utf16().chain(all.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

fn word(text: Text, from: &[&str], to: &str) -> Vec<u8> {
    let all = text.lines.concat();
    let found = from.iter().find(|word| all.contains(**word));
    found
        .map_or(all.clone(), |word| all.replace(word, to))
        .into_bytes()
}

const UNITS: [&str; 8] = [
    "Meters",
    "Centimeters",
    "Millimeters",
    "\tmm\t",
    ",mm",
    "_px",
    "metres",
    "\u{0}",
];
const RATES: [&str; 6] = [
    "Export Frame Rate,100.000000",
    "Export Frame Rate,100",
    "Export Frame Rate;100",
    "\n100.0\t",
    "FREQUENCY\t100",
    "Trajectories\r\n100",
];

pub(crate) const DAMAGES: [(&str, Damage); 45] = [
    ("emptied", |_, _| Vec::new()),
    ("cut in the first tenth", |r, t| between(r, t, 0.0, 0.1)),
    ("cut in the first half", |r, t| between(r, t, 0.1, 0.5)),
    ("cut in the second half", |r, t| between(r, t, 0.5, 1.0)),
    ("cut in the last line", |r, t| {
        let last = t.lines.last().map_or(0, String::len);
        let mut bytes = t.bytes();
        bytes.truncate(bytes.len() - r.random_range(1..last));
        bytes
    }),
    ("first line lost", |_, mut t| {
        t.lines.remove(0);
        t.bytes()
    }),
    ("header lost", |_, mut t| {
        t.lines.drain(..t.header);
        t.bytes()
    }),
    ("data lost", |_, mut t| {
        t.lines.truncate(t.header);
        t.bytes()
    }),
    ("header line lost", |r, mut t| {
        t.lines.remove(t.head(r));
        t.bytes()
    }),
    ("header line twice", |r, mut t| {
        let at = t.head(r);
        t.lines.insert(at, t.lines[at].clone());
        t.bytes()
    }),
    ("header lines exchanged", |r, mut t| {
        let (a, b) = (t.head(r), t.head(r));
        t.lines.swap(a, b);
        t.bytes()
    }),
    ("header shuffled", |r, mut t| {
        for i in (1..t.header).rev() {
            t.lines.swap(i, r.random_range(0..=i));
        }
        t.bytes()
    }),
    ("header behind the data", |_, mut t| {
        t.lines.rotate_left(t.header);
        t.bytes()
    }),
    ("header cell lost", |r, mut t| {
        let at = t.head(r);
        let (line, end) = body(&t.lines[at]);
        let mut cells: Vec<&str> = line.split(t.delimiter).collect();
        cells.remove(r.random_range(0..cells.len()));
        t.lines[at] = cells.join(&t.delimiter.to_string()) + end;
        t.bytes()
    }),
    ("row lost", |r, mut t| {
        t.lines.remove(t.data(r));
        t.bytes()
    }),
    ("row twice", |r, mut t| {
        let at = t.data(r);
        t.lines.insert(at, t.lines[at].clone());
        t.bytes()
    }),
    ("rows exchanged", |r, mut t| {
        let (a, b) = (t.data(r), t.data(r));
        t.lines.swap(a, b);
        t.bytes()
    }),
    ("rows backwards", |_, mut t| {
        t.lines[t.header..].reverse();
        t.bytes()
    }),
    ("rows run together", |r, mut t| {
        let at = r.random_range(t.header..t.lines.len() - 1);
        t.lines[at] = body(&t.lines[at]).0.to_owned();
        t.bytes()
    }),
    ("row broken in two", |r, mut t| {
        let at = t.data(r);
        let place = r.random_range(1..body(&t.lines[at]).0.len());
        t.lines[at].insert(place, '\n');
        t.bytes()
    }),
    // With its last cell: digits that a number lost in the middle of a file show nowhere.
    ("row cut", |r, mut t| {
        let at = t.data(r);
        let (line, end) = body(&t.lines[at]);
        let last = line.rfind(t.delimiter).unwrap();
        t.lines[at] = line[..r.random_range(1..=last)].to_owned() + end;
        t.bytes()
    }),
    ("cell lost", |r, mut t| {
        let at = t.data(r);
        let (line, end) = body(&t.lines[at]);
        let mut cells: Vec<&str> = line.split(t.delimiter).collect();
        cells.remove(r.random_range(0..cells.len()));
        t.lines[at] = cells.join(&t.delimiter.to_string()) + end;
        t.bytes()
    }),
    ("cell too many", |r, mut t| {
        let at = t.data(r);
        let (line, end) = body(&t.lines[at]);
        let mut cells: Vec<&str> = line.split(t.delimiter).collect();
        cells.insert(r.random_range(0..=cells.len()), "7.25");
        t.lines[at] = cells.join(&t.delimiter.to_string()) + end;
        t.bytes()
    }),
    ("cell blank", |r, t| t.cell(r, |_| String::new())),
    ("cell NaN", |r, t| t.cell(r, |_| "NaN".into())),
    ("cell 1.#QNAN0", |r, t| t.cell(r, |_| "1.#QNAN0".into())),
    ("cell a word", |r, t| t.cell(r, |_| "lost".into())),
    ("cell infinite", |r, t| t.cell(r, |_| "inf".into())),
    ("cell too large", |r, t| t.cell(r, |_| "1e999".into())),
    ("letter O for a digit", |r, t| {
        t.cell(r, |cell| {
            let at = cell.find(|c: char| c.is_ascii_digit()).unwrap();
            format!("{}O{}", &cell[..at], &cell[at + 1..])
        })
    }),
    ("decimal comma in one cell", |r, t| {
        t.cell(r, |cell| cell.replace('.', ","))
    }),
    ("quote left open in a row", |r, t| {
        t.cell(r, |cell| format!("\"{cell}"))
    }),
    ("quote left open in the header", |r, mut t| {
        let at = t.head(r);
        let place = t.lines[at].find(t.delimiter).map_or(0, |place| place + 1);
        t.lines[at].insert(place, '"');
        t.bytes()
    }),
    ("unit unknown", |_, t| word(t, &UNITS, "Feet")),
    ("rate in words", |_, t| {
        word(t, &RATES, "Export Frame Rate,fast")
    }),
    ("other delimiter", |_, t| {
        let (from, to) = (
            t.delimiter.to_string(),
            if t.delimiter == ';' { "," } else { ";" },
        );
        t.lines.concat().replace(&from, to).into_bytes()
    }),
    ("decimal commas", |_, t| {
        t.lines.concat().replace('.', ",").into_bytes()
    }),
    ("zero bytes inside", |r, t| insert(r, t, &[0; 5])),
    ("noise inside", |r, t| {
        let noise: Vec<u8> = (0..40).map(|_| r.random::<u8>()).collect();
        insert(r, t, &noise)
    }),
    ("twice in one file", |_, t| {
        let bytes = t.bytes();
        [bytes.clone(), bytes].concat()
    }),
    ("a line of 5 MB", |_, mut t| {
        t.lines.insert(t.header, "1".repeat(5_000_000) + "\n");
        t.bytes()
    }),
    ("UTF-16", |_, t| utf16(t, true)),
    ("UTF-16 without its mark", |_, t| utf16(t, false)),
    ("other line ends and a mark", |_, t| {
        let text = t.lines.concat();
        let text = if text.contains("\r\n") {
            text.replace("\r\n", "\n")
        } else {
            text.replace('\n', "\r\n")
        };
        format!("\u{feff}{text}").into_bytes()
    }),
    ("delimiters at the end", |_, t| {
        let delimiter = t.delimiter;
        every_line(t, |_, body, end| {
            format!("{body}{delimiter}{delimiter}{end}")
        })
    }),
];
