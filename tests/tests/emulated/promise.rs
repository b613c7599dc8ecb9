//! The promises as measured: each test prints its rows in the very form in which they stand in `firmware/README.md`, and
//! holds them against what stands there.
//!
//! `SWIMMER_WRITE_PROMISES=1 cargo test -p swimmer-tests --test emulated` writes what it measured into that table.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Another compiler makes other code, so times of the chip differ a little from build to build: numbers may be off by this
/// share, or by one of their last digit. Words may not. (The promises themselves are asserted where they are measured.)
const SHARE: f64 = 0.1;
const HEADING: &str = "| promise | seen |\n|---|---|\n";

/// Prints a row of a long run, and holds it against the README where such a row stands already.
pub(crate) fn seen_in_soak(promise: &str, told: &str) {
    let known = find(&fs::read_to_string(readme()).unwrap(), promise).is_some();
    if known || std::env::var_os("SWIMMER_WRITE_PROMISES").is_some() {
        seen(promise, told);
    } else {
        println!("| {promise} | {told} |");
    }
}

/// Prints a row of the table. Fails if the README differs.
pub(crate) fn seen(promise: &str, seen: &str) {
    let row = format!("| {promise} | {seen} |");
    println!("{row}");
    let path = readme();
    if std::env::var_os("SWIMMER_WRITE_PROMISES").is_some() {
        return write(&path, promise, &row);
    }
    let text = fs::read_to_string(&path).unwrap();
    let advice = "SWIMMER_WRITE_PROMISES=1 cargo test -p swimmer-tests --test emulated writes it";
    let stands = find(&text, promise)
        .unwrap_or_else(|| panic!("{} has no row of {promise}; {advice}", path.display()));
    assert!(
        alike(stands, &row),
        "{} says\n{stands}\nbut this was measured:\n{row}\n{advice}",
        path.display()
    );
}

fn readme() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/README.md")
}

fn find<'a>(text: &'a str, promise: &str) -> Option<&'a str> {
    let start = format!("| {promise} | ");
    text.lines().find(|line| line.starts_with(&start))
}

/// Puts the row in the place of the one that stands there, or at the table's end. Tests run side by side, in threads or
/// processes: one writes at a time.
fn write(path: &Path, promise: &str, row: &str) {
    let lock = File::open(path).unwrap();
    lock.lock().unwrap();
    let text = fs::read_to_string(path).unwrap();
    let written = if let Some(stands) = find(&text, promise) {
        text.replacen(stands, row, 1)
    } else {
        let table = text.find(HEADING).unwrap() + HEADING.len();
        let end = table
            + text[table..]
                .find("\n\n")
                .map_or(text.len() - table, |at| at + 1);
        format!("{}{row}\n{}", &text[..end], &text[end..])
    };
    fs::write(path, written).unwrap();
}

/// The same words, and nearly the same numbers.
fn alike(one: &str, other: &str) -> bool {
    let (one, other) = (words(one), words(other));
    one.len() == other.len()
        && one.iter().zip(&other).all(|(one, other)| {
            let (Some(a), Some(b)) = (number(one), number(other)) else {
                return one == other;
            };
            let digit = last_digit(one).max(last_digit(other));
            (a - b).abs() <= (SHARE * b.abs()).max(digit * 1.001)
        })
}

/// Numbers, and what stands between them.
fn words(row: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut in_number = false;
    for letter in row.chars() {
        let digit = letter.is_ascii_digit() || (letter == '.' && in_number);
        match words.last_mut() {
            Some(word) if digit == in_number => word.push(letter),
            _ => words.push(letter.to_string()),
        }
        in_number = digit;
    }
    words
}

fn number(word: &str) -> Option<f64> {
    word.trim_end_matches('.').parse().ok()
}

fn last_digit(number: &str) -> f64 {
    let decimals = number.trim_end_matches('.').split_once('.');
    0.1f64.powi(decimals.map_or(0, |(_, decimals)| i32::try_from(decimals.len()).unwrap()))
}

#[test]
fn rows_are_alike_but_for_their_numbers() {
    assert!(alike(
        "| R5 | after 417 to 488 ms, 0.146° |",
        "| R5 | after 440 to 488 ms, 0.147° |"
    ));
    assert!(!alike("| R5 | after 417 ms |", "| R5 | after 517 ms |"));
    assert!(!alike("| R5 | after 417 ms |", "| R5 | before 417 ms |"));
    assert!(!alike("| R5 | none of 10 |", "| R5 | none |"));
}
