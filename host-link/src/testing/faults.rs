//! Fault parameters of a link, and their text form on a command line.

use std::str::FromStr;
use std::time::Duration;

/// Interruption of the link, as when a Bluetooth module loses its peer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outage {
    /// Start, on the port's clock.
    pub from: Duration,
    /// Duration.
    pub duration: Duration,
    /// Period of repeated interruptions; `None` for a single one.
    pub every: Option<Duration>,
}

impl Outage {
    /// Single interruption from `from` on, for `duration`.
    pub fn once(from: Duration, duration: Duration) -> Self {
        Self {
            from,
            duration,
            every: None,
        }
    }

    /// Returns true if the link is interrupted at this time.
    pub fn covers(&self, at: Duration) -> bool {
        let Some(since) = at.checked_sub(self.from) else {
            return false;
        };
        let since = match self.every {
            Some(every) if !every.is_zero() => {
                Duration::from_nanos_u128(since.as_nanos() % every.as_nanos())
            }
            _ => since,
        };
        since < self.duration
    }
}

/// Fault parameters of a link. Probabilities are per frame and hold in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Probability that a frame is lost, 0 to 1.
    pub drop: f64,
    /// Probability that one bit of a frame is inverted, 0 to 1.
    pub flip: f64,
    /// Probability that a frame arrives twice, 0 to 1.
    pub duplicate: f64,
    /// Probability that frames sent up to [`Faults::LONGEST_DETOUR`] later overtake a frame, 0 to 1.
    pub reorder: f64,
    /// Additional delay of every frame, each way.
    pub delay: Duration,
    /// Bytes towards the host are held until this many are ready or the oldest has waited [`Faults::LONGEST_HOLD`]; 0 disables
    /// it. Such a module does not buffer towards the robot.
    pub clump: usize,
    /// Number of old bytes that the module sends again, ahead of new ones, when traffic resumes after [`Faults::QUIET`] or a
    /// disconnection; 0 disables it.
    pub stale: usize,
    /// Baud rate of the far end, if it differs from the robot's 115 200.
    pub baud: Option<u32>,
    /// Bytes per second towards the robot; more are buffered. `None` means unlimited.
    pub rate: Option<u32>,
    /// Capacity of that buffer, bytes; a frame that does not fit is lost. 0 means unlimited.
    pub buffer: usize,
    /// Interruptions of the connection.
    pub disconnect: Option<Outage>,
}

impl Faults {
    /// Longest time for which a link that buffers in lumps holds bytes.
    pub const LONGEST_HOLD: Duration = Duration::from_secs(1);
    /// Largest additional delay of a reordered frame.
    pub const LONGEST_DETOUR: Duration = Duration::from_millis(100);
    /// Silence after which traffic counts as a new connection; an open session is never silent that long.
    pub const QUIET: Duration = Duration::from_millis(300);
    /// Baud rate of the robot's line.
    pub const BAUD: u32 = 115_200;

    /// Parameters of a link without faults.
    pub fn none() -> Self {
        Self::default()
    }
}

/// Parse error of a fault list, with its position.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("reading the faults at column {column}: {problem}")]
pub struct FaultsError {
    /// Column of the item, in characters from 1.
    pub column: usize,
    /// Problem of the item.
    pub problem: FaultsProblem,
}

/// Problem of an item in a fault list.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FaultsProblem {
    /// The item is not `name=value`.
    #[error("`{0}` is not of the form name=value; write for example drop=5%,clump=230")]
    NotAPair(String),
    /// The name is unknown.
    #[error(
        "there is no fault `{0}`; there are drop, flip, duplicate, reorder, delay, clump, stale, baud, rate, buffer and disconnect"
    )]
    UnknownName(String),
    /// The probability is not a number from 0 to 1.
    #[error(
        "{name}={value} is not a chance; write a percentage from 0% to 100% or a number from 0 to 1"
    )]
    NotAChance {
        /// Name of the fault.
        name: String,
        /// Given value.
        value: String,
    },
    /// The value is not a whole number, or too large.
    #[error("{name}={value} is not a whole number of {unit} up to {most}")]
    NotACount {
        /// Name of the fault.
        name: String,
        /// Given value.
        value: String,
        /// Unit of the value.
        unit: &'static str,
        /// Largest allowed value.
        most: u64,
    },
    /// The rate passes nothing.
    #[error("rate={0} is no number of bytes a second above 0, as in rate=200,buffer=8192")]
    NotARate(String),
    /// The baud rate is not supported by serial ports.
    #[error("baud={0} is no rate of a serial line; write one from 300 to 4000000, as baud=38400")]
    NotABaudRate(String),
    /// The disconnection is not two or three times.
    #[error(
        "disconnect={0} is not START:LENGTH or START:LENGTH:EVERY in milliseconds, EVERY longer than LENGTH, as in disconnect=2000:1500"
    )]
    NotAnOutage(String),
    /// The fault occurs twice.
    #[error("`{0}` stands there twice; leave one of them out")]
    Twice(String),
}

/// One day: the largest allowed time, which also prevents overflow.
const MOST_MILLISECONDS: u64 = 86_400_000;
/// One mebibyte: the largest allowed buffer.
const MOST_BYTES: u64 = 1 << 20;

impl FromStr for Faults {
    type Err = FaultsError;

    /// Parses
    /// `drop=5%,flip=0.01,duplicate=2%,reorder=1%,delay=100,clump=230,stale=400,baud=38400,rate=200,buffer=8192,disconnect=2000:1500`;
    /// times are in milliseconds.
    fn from_str(text: &str) -> Result<Self, FaultsError> {
        let mut faults = Self::none();
        let mut seen: Vec<&str> = Vec::new();
        let mut column = 1;
        for item in text.split(',') {
            let indent = item.chars().take_while(|c| c.is_whitespace()).count();
            let at = column + indent;
            column += item.chars().count() + 1;
            let item = item.trim();
            if item.is_empty() {
                continue;
            }
            faults
                .take(item, &mut seen)
                .map_err(|problem| FaultsError {
                    column: at,
                    problem,
                })?;
        }
        Ok(faults)
    }
}

impl Faults {
    fn take<'a>(&mut self, item: &'a str, seen: &mut Vec<&'a str>) -> Result<(), FaultsProblem> {
        let (name, value) = item
            .split_once('=')
            .ok_or_else(|| FaultsProblem::NotAPair(item.to_owned()))?;
        let (name, value) = (name.trim(), value.trim());
        if seen.contains(&name) {
            return Err(FaultsProblem::Twice(name.to_owned()));
        }
        seen.push(name);
        let bytes =
            || count(name, value, "bytes", MOST_BYTES).map(|n| usize::try_from(n).unwrap_or(0));
        match name {
            "drop" => self.drop = chance(name, value)?,
            "flip" => self.flip = chance(name, value)?,
            "duplicate" => self.duplicate = chance(name, value)?,
            "reorder" => self.reorder = chance(name, value)?,
            "delay" => {
                let ms = count(name, value, "milliseconds", MOST_MILLISECONDS)?;
                self.delay = Duration::from_millis(ms);
            }
            "clump" => self.clump = bytes()?,
            "stale" => self.stale = bytes()?,
            "baud" => {
                let rate = value
                    .parse()
                    .ok()
                    .filter(|rate| (300..=4_000_000).contains(rate));
                self.baud =
                    Some(rate.ok_or_else(|| FaultsProblem::NotABaudRate(value.to_owned()))?);
            }
            "rate" => {
                let rate = value.parse().ok().filter(|&rate| rate > 0);
                self.rate = Some(rate.ok_or_else(|| FaultsProblem::NotARate(value.to_owned()))?);
            }
            "buffer" => self.buffer = bytes()?,
            "disconnect" => self.disconnect = Some(outage(value)?),
            _ => return Err(FaultsProblem::UnknownName(name.to_owned())),
        }
        Ok(())
    }
}

fn chance(name: &str, value: &str) -> Result<f64, FaultsProblem> {
    let (digits, scale) = match value.strip_suffix('%') {
        Some(percent) => (percent.trim(), 0.01),
        None => (value, 1.0),
    };
    digits
        .parse::<f64>()
        .ok()
        .map(|number| number * scale)
        .filter(|chance| (0.0..=1.0).contains(chance))
        .ok_or_else(|| FaultsProblem::NotAChance {
            name: name.to_owned(),
            value: value.to_owned(),
        })
}

fn count(name: &str, value: &str, unit: &'static str, most: u64) -> Result<u64, FaultsProblem> {
    value
        .parse::<u64>()
        .ok()
        .filter(|&number| number <= most)
        .ok_or_else(|| FaultsProblem::NotACount {
            name: name.to_owned(),
            value: value.to_owned(),
            unit,
            most,
        })
}

fn outage(value: &str) -> Result<Outage, FaultsProblem> {
    let bad = || FaultsProblem::NotAnOutage(value.to_owned());
    let times = value
        .split(':')
        .map(|text| count("disconnect", text.trim(), "milliseconds", MOST_MILLISECONDS))
        .map(|ms| ms.map(Duration::from_millis))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|_| bad())?;
    match times[..] {
        [from, duration] => Ok(Outage::once(from, duration)),
        [from, duration, every] if every > duration => Ok(Outage {
            from,
            duration,
            every: Some(every),
        }),
        _ => Err(bad()),
    }
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
            Some(Outage::once(
                Duration::from_secs(2),
                Duration::from_millis(1500)
            ))
        );
        let again: Faults = "disconnect=1000:200:500".parse().unwrap();
        let outage = again.disconnect.unwrap();
        let cut: Vec<u64> = (0..2000)
            .step_by(100)
            .filter(|&ms| outage.covers(Duration::from_millis(ms)))
            .collect();
        assert_eq!(cut, [1000, 1100, 1500, 1600]);
    }

    #[test]
    fn each_mistake_has_its_place_and_its_sentence() {
        for (text, column, word) in [
            ("drop", 1, "name=value"),
            ("loss=5%", 1, "there is no fault `loss`"),
            ("drop=150%", 1, "not a chance"),
            ("flip=1%, drop=-1", 10, "not a chance"),
            ("drop=nan", 1, "not a chance"),
            ("clump=2.5", 1, "whole number of bytes up to 1048576"),
            ("stale=1048577", 1, "whole number of bytes"),
            (
                "delay=99999999999999999999",
                1,
                "whole number of milliseconds",
            ),
            ("delay=1,baud=12", 9, "from 300 to 4000000"),
            ("rate=0", 1, "bytes a second above 0"),
            ("buffer=-1", 1, "whole number of bytes"),
            ("disconnect=5", 1, "START:LENGTH"),
            ("disconnect=5:6:6", 1, "EVERY longer than LENGTH"),
            ("drop=1%,,drop=2%", 10, "twice"),
        ] {
            let error = text.parse::<Faults>().unwrap_err();
            assert_eq!(error.column, column, "{text}: {error}");
            let error = error.to_string();
            assert!(error.contains(word), "{text}: {error}");
            assert!(error.contains(&format!("column {column}:")), "{error}");
        }
    }
}
