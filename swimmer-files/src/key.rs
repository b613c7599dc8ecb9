//! The key file: what robot and host share, as text.

use link_protocol::Key;

/// Reads a key: 32 hexadecimal digits in one line; lines that begin with # are remarks.
///
/// # Errors
/// Place and reason, to be appended to the file's name.
///
/// ```
/// let key = swimmer_files::parse_key("# the robot's\n000102030405060708090a0b0c0d0e0f\n").unwrap();
/// assert_eq!(key.0[15], 15);
/// assert!(swimmer_files::parse_key("00\n").unwrap_err().contains("line 1: 2 digits"));
/// ```
pub fn parse_key(text: &str) -> Result<Key, String> {
    let advice = "write 32 hexadecimal digits in one line, or let `swimmer robot key make FILE` write a new file";
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (number, digits) = lines
        .next()
        .ok_or_else(|| format!(": there is none; {advice}"))?;
    if let Some((number, _)) = lines.next() {
        return Err(format!(
            ", line {number}: there is a second one; leave one out"
        ));
    }
    if let Some(column) = digits.chars().position(|c| !c.is_ascii_hexdigit()) {
        let column = column + 1;
        return Err(format!(
            ", line {number}, column {column}: not a hexadecimal digit; {advice}"
        ));
    }
    let count = digits.len();
    u128::from_str_radix(digits, 16)
        .ok()
        .filter(|_| count == 2 * Key::LEN)
        .map(|key| Key(key.to_be_bytes()))
        .ok_or_else(|| format!(", line {number}: {count} digits; {advice}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_32_digits_and_a_mistake_has_its_place() {
        let digits = "000102030405060708090a0b0c0d0e0F";
        let key = Key(core::array::from_fn(|place| u8::try_from(place).unwrap()));
        assert_eq!(parse_key(&format!("# the robot's\n  {digits}\n")), Ok(key));
        for (text, part) in [
            ("# nothing\n", "there is none"),
            ("00\n", ", line 1: 2 digits"),
            ("\n00010203g", ", line 2, column 9"),
            ("00\n11\n", ", line 2: there is a second"),
            (&digits.repeat(2), ": 64 digits"),
            ("+0000102030405060708090a0b0c0d0e", "column 1"),
        ] {
            let error = parse_key(text).unwrap_err();
            assert!(error.contains(part), "{text:?}: {error}");
        }
    }
}
