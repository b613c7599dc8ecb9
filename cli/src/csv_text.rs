//! Tables as CSV: SI units, one line each, numbers that read back exactly.

use csv::Writer;
use serde::Serialize;

use crate::failure::{Failure, Outcome};

/// A heading, then a line for each row: a tuple of what stands in its fields; what is `None` leaves its field empty.
///
/// # Errors
/// As the writer's: for rows of other lengths than the heading.
pub(crate) fn csv_text(
    heading: impl IntoIterator<Item = impl AsRef<[u8]>>,
    rows: impl IntoIterator<Item = impl Serialize>,
) -> Outcome<String> {
    let mut writer = Writer::from_writer(Vec::new());
    let written = writer
        .write_record(heading)
        .and_then(|()| rows.into_iter().try_for_each(|row| writer.serialize(row)));
    let broken =
        |why: &dyn std::fmt::Display| Failure::Tried(format!("cannot write a table: {why}"));
    written.map_err(|error| broken(&error))?;
    let bytes = writer.into_inner().map_err(|error| broken(&error))?;
    String::from_utf8(bytes).map_err(|error| broken(&error))
}

#[cfg(test)]
mod tests {
    use super::csv_text;

    #[test]
    fn fields_stay_one_field_and_numbers_what_they_are() {
        let rows = [
            ("a, \"b\".csv", 0.1 + 0.2, None),
            ("c", f64::MIN_POSITIVE, Some([1, 2])),
        ];
        let written = csv_text("name,number,one,two".split(','), rows).unwrap_err();
        assert!(written.to_string().contains("cannot write a table"));
        let rows = rows.map(|(name, number, _)| (name, number, None::<f64>));
        let written = csv_text("name,number,none".split(','), rows).unwrap();
        assert_eq!(
            written,
            "name,number,none\n\"a, \"\"b\"\".csv\",0.30000000000000004,\nc,2.2250738585072014e-308,\n"
        );
    }
}
