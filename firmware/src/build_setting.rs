//! Build settings: environment variables with a whole number, evaluated at compile time.

/// Parses a setting. Returns `None` if it is not set. An invalid value fails the build.
pub(crate) const fn number(setting: Option<&str>) -> Option<u32> {
    let Some(text) = setting else { return None };
    match u32::from_str_radix(text, 10) {
        Ok(number) => Some(number),
        Err(_) => panic!("a setting of the build is no whole number"),
    }
}
