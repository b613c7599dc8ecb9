//! Times that are written as a clock shows them: `12:30:05.25`, `2026-08-04T15:53:42.776Z`.

use toml::value::{Date, Datetime, Offset};

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// A time as a clock shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stamp {
    /// Days since 1970, if there is a date.
    pub(super) day: Option<i64>,
    /// Seconds of that day.
    pub(super) seconds: f64,
}

impl Stamp {
    /// Parses `h:mm:ss` and `mm:ss` with or without a fraction, and ISO 8601 dates with times.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        if let Ok(stamp) = text.parse::<Datetime>()
            && let (Some(date), Some(time)) = (stamp.date, stamp.time)
        {
            let offset_s = match stamp.offset {
                Some(Offset::Custom { minutes }) => 60.0 * f64::from(minutes),
                _ => 0.0,
            };
            let whole = f64::from(time.hour) * 3600.0 + f64::from(time.minute) * 60.0;
            let seconds = f64::from(time.second.unwrap_or(0))
                + 1e-9 * f64::from(time.nanosecond.unwrap_or(0));
            return Some(Self {
                day: Some(days(date)),
                seconds: whole + seconds - offset_s,
            });
        }
        let mut parts = text.rsplit(':');
        let last = parts.next()?;
        let plain = |text: &str| {
            text.bytes()
                .all(|b| b.is_ascii_digit() || b == b'.' || b == b',')
        };
        if !plain(last) || last.is_empty() {
            return None;
        }
        let mut seconds: f64 = last.replacen(',', ".", 1).parse().ok()?;
        let mut unit = 60.0;
        let mut count = 1;
        for part in parts {
            let value: u32 = part.parse().ok()?;
            seconds += unit * f64::from(value);
            unit *= 60.0;
            count += 1;
        }
        let days = text.contains(':') && (2..=3).contains(&count);
        days.then_some(Self { day: None, seconds })
    }

    /// Seconds from midnight of this day.
    pub(super) fn since(&self, day: i64) -> f64 {
        self.day.map_or(0.0, |own| (own - day) as f64 * DAY_S) + self.seconds
    }
}

/// The seconds of a clock's text, in which its digits show.
pub(super) fn digits(text: &str) -> &str {
    let text = text.trim();
    let last = text.rsplit(':').next().unwrap_or(text);
    match text.find(['T', 't', ' ']) {
        // Of a date, up to the zone.
        Some(at) => {
            let time = text.get(at + 1..).unwrap_or("");
            let end = time.find(['Z', 'z', '+', '-']).unwrap_or(time.len());
            let time = time.get(..end).unwrap_or(time);
            time.rsplit(':').next().unwrap_or(time)
        }
        None => last,
    }
}

/// Days since 1970-01-01 in the Gregorian calendar.
fn days(date: Date) -> i64 {
    // Years from March on, so that leap days come last.
    let (month, day) = (i64::from(date.month), i64::from(date.day));
    let year = i64::from(date.year) - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    365 * year + year / 4 - year / 100 + year / 400 + of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_and_dates() {
        let since_1970 = |text: &str| Stamp::parse(text).map(|stamp| stamp.since(0));
        // By `date -u -d … +%s`.
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2026-08-04T15:53:42.776Z", 1_785_858_822.776),
            ("2026-08-04 15:53:42.776", 1_785_858_822.776),
            ("2026-08-04T17:53:42.776+02:00", 1_785_858_822.776),
            ("2024-02-29T23:59:59Z", 1_709_251_199.0),
            ("2024-03-01T00:00:00Z", 1_709_251_200.0),
            ("12:30:05.25", 45_005.25),
            ("0:00:05,5", 5.5),
            ("01:02.5", 62.5),
        ] {
            let read = since_1970(text).unwrap_or(f64::NAN);
            assert!((read - seconds).abs() < 1e-6, "{text}: {read}");
        }
        for text in [
            "",
            "12",
            "1.5",
            "a:b",
            "1:2:3:4:5",
            ":",
            "12:",
            "-1:00",
            "2026-13-01T00:00:00Z",
        ] {
            assert_eq!(Stamp::parse(text), None, "{text}");
        }
    }

    #[test]
    fn digits_are_those_of_the_seconds() {
        assert_eq!(digits("12:30:05.25"), "05.25");
        assert_eq!(digits("2026-08-04T15:53:42.776Z"), "42.776");
        assert_eq!(digits("2026-08-04 15:53:42.77+02:00"), "42.77");
    }
}
