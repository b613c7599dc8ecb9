//! What may go wrong on a link, as numbers, and the text that names them on a command line.

use std::str::FromStr;
use std::time::Duration;

/// A time during which nothing passes, as when a Bluetooth module loses its peer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outage {
    /// When it begins, on the port's clock.
    pub from: Duration,
    /// How long it lasts.
    pub lasting: Duration,
}

/// The faults of a link. Chances are per frame and hold in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Chance that a frame vanishes, 0 to 1.
    pub drop: f64,
    /// Chance that one bit of a frame is inverted, 0 to 1.
    pub flip: f64,
    /// Chance that a frame arrives twice, 0 to 1.
    pub duplicate: f64,
    /// Added to the travel time of every frame, each way.
    pub delay: Duration,
    /// Bytes towards the host are held until this many lie ready or the oldest has waited
    /// [`Faults::LONGEST_HOLD`]; 0 for none. Towards the robot a module of this kind does not buffer.
    pub clump: usize,
    /// A time without any connection.
    pub disconnect: Option<Outage>,
}

impl Faults {
    /// How long a clumping link holds bytes back at most.
    pub const LONGEST_HOLD: Duration = Duration::from_secs(1);

    /// A link without faults.
    pub fn none() -> Self {
        Self::default()
    }
}

/// Why a list of faults was not understood.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FaultsError {
    /// An item that is not `name=value`.
    #[error(
        "reading the faults: `{0}` is not of the form name=value; write for example drop=5%,clump=230"
    )]
    NotAPair(String),
    /// A name that is none of ours.
    #[error(
        "reading the faults: there is no fault `{0}`; there are drop, flip, duplicate, delay, clump and disconnect"
    )]
    UnknownName(String),
    /// A chance that is no number from 0 to 1.
    #[error(
        "reading the faults: {name}={value} is not a chance; write a percentage from 0% to 100% or a number from 0 to 1"
    )]
    NotAChance {
        /// Which fault.
        name: String,
        /// What stood there.
        value: String,
    },
    /// A value that is no whole number.
    #[error("reading the faults: {name}={value} is not a whole number of {unit}")]
    NotACount {
        /// Which fault.
        name: String,
        /// What stood there.
        value: String,
        /// What is counted.
        unit: &'static str,
    },
    /// A disconnection that is not two times.
    #[error(
        "reading the faults: disconnect={0} is not START:LENGTH in milliseconds, as in disconnect=2000:1500"
    )]
    NotAnOutage(String),
    /// The same fault named twice.
    #[error("reading the faults: `{0}` stands there twice; leave one of them out")]
    Twice(String),
}

impl FromStr for Faults {
    type Err = FaultsError;

    /// Reads `drop=5%,flip=0.01,duplicate=2%,delay=100,clump=230,disconnect=2000:1500`; times are in milliseconds.
    fn from_str(text: &str) -> Result<Self, FaultsError> {
        let mut faults = Self::none();
        let mut seen: Vec<&str> = Vec::new();
        for item in text
            .split(',')
            .map(str::trim)
            .filter(|item| !item.is_empty())
        {
            let (name, value) = item
                .split_once('=')
                .ok_or_else(|| FaultsError::NotAPair(item.to_owned()))?;
            let (name, value) = (name.trim(), value.trim());
            if seen.contains(&name) {
                return Err(FaultsError::Twice(name.to_owned()));
            }
            seen.push(name);
            match name {
                "drop" => faults.drop = chance(name, value)?,
                "flip" => faults.flip = chance(name, value)?,
                "duplicate" => faults.duplicate = chance(name, value)?,
                "delay" => {
                    faults.delay = Duration::from_millis(count(name, value, "milliseconds")?);
                }
                "clump" => {
                    let bytes = count(name, value, "bytes")?;
                    faults.clump = usize::try_from(bytes).unwrap_or(usize::MAX);
                }
                "disconnect" => faults.disconnect = Some(outage(value)?),
                _ => return Err(FaultsError::UnknownName(name.to_owned())),
            }
        }
        Ok(faults)
    }
}

fn chance(name: &str, value: &str) -> Result<f64, FaultsError> {
    let (digits, scale) = match value.strip_suffix('%') {
        Some(percent) => (percent.trim(), 0.01),
        None => (value, 1.0),
    };
    digits
        .parse::<f64>()
        .ok()
        .map(|number| number * scale)
        .filter(|chance| (0.0..=1.0).contains(chance))
        .ok_or_else(|| FaultsError::NotAChance {
            name: name.to_owned(),
            value: value.to_owned(),
        })
}

fn count(name: &str, value: &str, unit: &'static str) -> Result<u64, FaultsError> {
    // A day in milliseconds bounds what can be meant, and keeps times addable.
    value
        .parse::<u64>()
        .ok()
        .filter(|&number| number <= 86_400_000)
        .ok_or_else(|| FaultsError::NotACount {
            name: name.to_owned(),
            value: value.to_owned(),
            unit,
        })
}

fn outage(value: &str) -> Result<Outage, FaultsError> {
    let bad = || FaultsError::NotAnOutage(value.to_owned());
    let (from, lasting) = value.split_once(':').ok_or_else(bad)?;
    let milliseconds =
        |text: &str| count("disconnect", text.trim(), "milliseconds").map_err(|_| bad());
    Ok(Outage {
        from: Duration::from_millis(milliseconds(from)?),
        lasting: Duration::from_millis(milliseconds(lasting)?),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_and_fractions_mean_the_same() {
        let percent: Faults = "drop=5%,flip=1%,clump=230,delay=100".parse().unwrap();
        let fraction: Faults = "drop=0.05, flip=0.01, delay=100, clump=230"
            .parse()
            .unwrap();
        assert!((percent.drop - fraction.drop).abs() < 1e-15);
        assert!((percent.flip - 0.01).abs() < 1e-15);
        assert_eq!(percent.clump, 230);
        assert_eq!(percent.delay, Duration::from_millis(100));
    }

    #[test]
    fn nothing_means_no_fault() {
        assert_eq!("".parse::<Faults>().unwrap(), Faults::none());
    }

    #[test]
    fn an_outage_has_a_start_and_a_length() {
        let faults: Faults = "disconnect=2000:1500".parse().unwrap();
        assert_eq!(
            faults.disconnect,
            Some(Outage {
                from: Duration::from_secs(2),
                lasting: Duration::from_millis(1500)
            })
        );
    }

    #[test]
    fn each_mistake_has_its_sentence() {
        for (text, word) in [
            ("drop", "name=value"),
            ("loss=5%", "there is no fault `loss`"),
            ("drop=150%", "not a chance"),
            ("drop=-1", "not a chance"),
            ("drop=nan", "not a chance"),
            ("clump=2.5", "whole number of bytes"),
            ("delay=99999999999999999999", "whole number of milliseconds"),
            ("disconnect=5", "START:LENGTH"),
            ("drop=1%,drop=2%", "twice"),
        ] {
            let error = text.parse::<Faults>().unwrap_err().to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
