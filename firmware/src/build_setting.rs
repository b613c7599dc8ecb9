//! Settings of a build: environment variables with a whole number, read by the compiler.

/// The number of a setting; `None` where it is not set. Anything else stops the build.
pub(crate) const fn number(setting: Option<&str>) -> Option<u32> {
    let Some(text) = setting else { return None };
    match u32::from_str_radix(text, 10) {
        Ok(number) => Some(number),
        Err(_) => panic!("a setting of the build is no whole number"),
    }
}
