//! Keyword arguments of a call, read one by one. An unusable value is refused by the name of its keyword.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use forecast::Tank;
use operations::Context;
use operations::bounds::BoundsRequest;
use operations::fit_file::FitSource;
use operations::optimize::robust::{self, Statistic};
use operations::optimize::timing;
use operations::plan::Target;
use operations::sweep::field;
use operations::tracks::Recording;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use pythonize::depythonize;
use sweep::Field;
use swimmer_command::{FigureWidth, check_new_file};
use swimmer_files::{JointName, SwimmerFile, parse_angle, parse_rate};

use crate::arguments::SwimmerArgument;
use crate::errors::{BadInput, of_operation};

/// Longest time that may be given \[s\].
const LONGEST_S: f64 = 1e9;

/// Keyword arguments of a call. A missing one and `None` are the same.
pub(crate) struct Keywords<'py>(pub(crate) Bound<'py, PyDict>);

/// Value of a keyword.
struct Given<'a, 'py> {
    name: &'a str,
    value: Bound<'py, PyAny>,
}

impl<'py> Given<'_, 'py> {
    /// The keyword with its value, and the problem.
    fn refused(&self, problem: &str) -> PyErr {
        let shown = self.value.repr().map(|text| text.to_string());
        let shown = shown.unwrap_or_else(|_| "…".to_owned());
        BadInput::new_err(format!("{}={shown}: {problem}", self.name))
    }

    /// The value; `form` is the advice if it has another type.
    fn extract<T: for<'a> FromPyObject<'a, 'py>>(&self, form: &str) -> PyResult<T> {
        let value = self.value.extract::<T>();
        value.map_err(|_| self.refused(form))
    }

    /// The value if it satisfies a condition.
    fn checked<T: Copy + for<'a> FromPyObject<'a, 'py>>(
        &self,
        form: &str,
        holds: impl Fn(T) -> bool,
    ) -> PyResult<T> {
        let value = self.extract::<T>(form)?;
        if holds(value) {
            Ok(value)
        } else {
            Err(self.refused(form))
        }
    }

    /// The items of a sequence or an array. Returns `None` if the value has none.
    fn items(&self) -> Option<Vec<Bound<'py, PyAny>>> {
        self.value.try_iter().ok()?.collect::<PyResult<_>>().ok()
    }

    /// Two numbers. Returns `None` for any other value.
    fn pair(&self) -> Option<[f64; 2]> {
        let numbers = self.items()?;
        let numbers = numbers.iter().map(|number| number.extract().ok());
        numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
    }

    /// Value of a type that reads its numbers as a text: that text, or a sequence of numbers.
    fn of_numbers<T: FromStr<Err = String>>(
        &self,
        counts: &[usize],
        separator: &str,
        form: &str,
    ) -> PyResult<T> {
        let text = if let Ok(text) = self.value.extract::<String>() {
            text
        } else {
            let numbers = self.items().unwrap_or_default();
            let numbers = numbers.iter().map(|number| number.extract().ok());
            let numbers = numbers.collect::<Option<Vec<f64>>>();
            let numbers = numbers.filter(|numbers| counts.contains(&numbers.len()));
            let numbers = numbers.ok_or_else(|| self.refused(form))?;
            let texts = numbers.iter().map(|number| format!("{number:?}"));
            texts.collect::<Vec<_>>().join(separator)
        };
        text.parse()
            .map_err(|problem: String| self.refused(&problem))
    }

    /// Number of radians, or a text with its unit, above zero.
    fn above_zero(&self, parse: fn(&str) -> Result<f64, String>, form: &str) -> PyResult<f64> {
        let text = match self.value.extract::<f64>() {
            Ok(number) => format!("{number:?}"),
            Err(_) => self.extract::<String>(form)?,
        };
        let value = parse(&text).map_err(|problem| self.refused(&problem))?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(self.refused(form))
        }
    }
}

const ANGLE: &str = "give an angle above zero: a number of radians, or a text such as \"70deg\"";
const RATE: &str =
    "give an angle per second above zero: a number of radians, or a text such as \"200deg\"";
const SECONDS: &str = "give a number of seconds above zero, as 30 or 2.5";

fn angle(text: &str) -> Result<f64, String> {
    parse_angle(text).map_err(|error| error.to_string())
}

fn rate(text: &str) -> Result<f64, String> {
    parse_rate(text).map_err(|error| error.to_string())
}

impl<'py> Keywords<'py> {
    fn given<'a>(&self, name: &'a str) -> PyResult<Option<Given<'a, 'py>>> {
        let value = self.0.get_item(name)?.filter(|value| !value.is_none());
        Ok(value.map(|value| Given { name, value }))
    }

    /// Result of `read` if the keyword is given.
    fn read<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Given<'_, 'py>) -> PyResult<T>,
    ) -> PyResult<Option<T>> {
        self.given(name)?.as_ref().map(read).transpose()
    }

    /// Returns `true` if the keyword is given.
    pub(crate) fn has(&self, name: &str) -> PyResult<bool> {
        Ok(self.given(name)?.is_some())
    }

    /// Refuses the value of a keyword that is given.
    pub(crate) fn refuse(&self, name: &str, problem: &str) -> PyResult<()> {
        match self.given(name)? {
            Some(given) => Err(given.refused(problem)),
            None => Ok(()),
        }
    }

    pub(crate) fn flag(&self, name: &str) -> PyResult<bool> {
        let flag = self.read(name, |given| given.extract("give True or False"))?;
        Ok(flag.unwrap_or(false))
    }

    /// Angle above zero \[rad\].
    pub(crate) fn angle(&self, name: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| given.above_zero(angle, ANGLE))
    }

    /// Angle of either sign \[rad\].
    pub(crate) fn signed_angle(&self, name: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| {
            let form = "give an angle: a number of radians, or a text such as \"-70deg\"";
            let text = match given.value.extract::<f64>() {
                Ok(number) => format!("{number:?}"),
                Err(_) => given.extract::<String>(form)?,
            };
            angle(&text).map_err(|problem| given.refused(&problem))
        })
    }

    /// Angle per second above zero \[rad/s\].
    pub(crate) fn rate(&self, name: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| given.above_zero(rate, RATE))
    }

    /// Rates of the servos: one for both, or one for each; empty if none is given.
    pub(crate) fn rates(&self, name: &str) -> PyResult<Vec<f64>> {
        let form = "give an angle per second above zero, or one for each of the two servos";
        let rates = self.read(name, |given| {
            let is_one =
                given.value.extract::<f64>().is_ok() || given.value.is_instance_of::<PyString>();
            let Some(values) = given.items().filter(|_| !is_one) else {
                return Ok(vec![given.above_zero(rate, RATE)?]);
            };
            if !(1..=2).contains(&values.len()) {
                return Err(given.refused(form));
            }
            let one = |value: Bound<'py, PyAny>| Given { name, value }.above_zero(rate, RATE);
            values.into_iter().map(one).collect()
        })?;
        Ok(rates.unwrap_or_default())
    }

    /// Pair of angles of either sign \[rad\].
    pub(crate) fn shape(&self, name: &str) -> PyResult<Option<[f64; 2]>> {
        let form = "give two angles, as (1.4, 0.56) or \"80deg,32deg\"";
        self.read(name, |given| {
            if let Some(shape) = given.pair() {
                return Ok(shape);
            }
            let text = given.extract::<String>(form)?;
            let (one, two) = text.split_once(',').ok_or_else(|| given.refused(form))?;
            let read = |text: &str| angle(text.trim()).map_err(|problem| given.refused(&problem));
            Ok([read(one)?, read(two)?])
        })
    }

    /// Time above zero \[s\].
    pub(crate) fn seconds(&self, name: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| {
            given.checked(SECONDS, |time: f64| time > 0.0 && time <= LONGEST_S)
        })
    }

    /// The same, with a word that stands for another meaning.
    pub(crate) fn seconds_or(&self, name: &str, word: &str) -> PyResult<Option<f64>> {
        let form = format!("{SECONDS}, or {word}");
        self.read(name, |given| {
            given.checked(&form, |time: f64| time > 0.0 && time <= LONGEST_S)
        })
    }

    /// Joint, `front` or `back`.
    pub(crate) fn joint(&self, name: &str) -> PyResult<Option<JointName>> {
        self.parsed(name)
    }

    /// Stiffness of a spring \[N m/rad\].
    pub(crate) fn stiffness(&self) -> PyResult<Option<f64>> {
        let form = "give a stiffness above zero in N m/rad, as 0.002";
        let stiffness = self.positive("stiffness", form)?;
        if stiffness.is_some() && self.has("relaxation")? {
            return Err(BadInput::new_err(
                "a spring has one of stiffness and relaxation: leave out the other",
            ));
        }
        Ok(stiffness)
    }

    /// Length, zero or above \[m\].
    pub(crate) fn length(&self, name: &str) -> PyResult<Option<f64>> {
        let form = "give a length in metres, zero or above, as 0.005";
        self.read(name, |given| {
            given.checked(form, |length: f64| length.is_finite() && length >= 0.0)
        })
    }

    /// Number above zero.
    pub(crate) fn positive(&self, name: &str, form: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| {
            given.checked(form, |value: f64| value.is_finite() && value > 0.0)
        })
    }

    /// Share between 0 and 1.
    pub(crate) fn share(&self, name: &str) -> PyResult<Option<f64>> {
        self.read(name, |given| {
            let form = "give a share between 0 and 1, as 0.95";
            given.checked(form, |value: f64| value > 0.0 && value < 1.0)
        })
    }

    /// Whole number in a range.
    pub(crate) fn count(&self, name: &str, least: u64, most: u64) -> PyResult<Option<u64>> {
        self.read(name, |given| {
            let form = if most == u64::MAX {
                format!("give a whole number from {least}")
            } else {
                format!("give a whole number from {least} to {most}")
            };
            given.checked(&form, |value: u64| (least..=most).contains(&value))
        })
    }

    /// One of these words.
    pub(crate) fn word<T: Copy>(&self, name: &str, all: &[(&str, T)]) -> PyResult<Option<T>> {
        self.read(name, |given| {
            let word = given.value.extract::<String>().unwrap_or_default();
            let found = all.iter().find(|(one, _)| *one == word);
            let (_, value) = found.ok_or_else(|| {
                let words: Vec<_> = all.iter().map(|(one, _)| format!("{one:?}")).collect();
                let (last, others) = words.split_last().map_or(("", &[][..]), |(l, o)| (l, o));
                let others = others.join(", ");
                given.refused(&format!("choose {others} or {last}"))
            })?;
            Ok(*value)
        })
    }

    /// Several words, each read by itself.
    pub(crate) fn words<T>(
        &self,
        name: &str,
        form: &str,
        of_word: impl Fn(&str) -> Option<T>,
    ) -> PyResult<Vec<T>> {
        let all = self.read(name, |given| {
            let words = match given.value.extract::<String>() {
                Ok(word) => vec![word],
                Err(_) => given.extract::<Vec<String>>(form)?,
            };
            let read = |word: &String| of_word(word).ok_or_else(|| given.refused(form));
            words.iter().map(read).collect::<PyResult<Vec<T>>>()
        })?;
        Ok(all.unwrap_or_default())
    }

    /// Text.
    pub(crate) fn text(&self, name: &str) -> PyResult<Option<String>> {
        self.read(name, |given| given.extract("give a text"))
    }

    /// Text of a type that reads itself.
    pub(crate) fn parsed<T: FromStr<Err: ToString>>(&self, name: &str) -> PyResult<Option<T>> {
        self.read(name, |given| {
            let text = given.extract::<String>("give a text")?;
            text.parse()
                .map_err(|error: T::Err| given.refused(&error.to_string()))
        })
    }

    /// Text that a function reads.
    pub(crate) fn parsed_by<T>(
        &self,
        name: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> PyResult<Option<T>> {
        self.read(name, |given| {
            let text = given.extract::<String>("give a text")?;
            parse(&text).map_err(|problem| given.refused(&problem))
        })
    }

    /// Place \[m\], with or without a heading \[rad\].
    pub(crate) fn place(&self, name: &str) -> PyResult<Option<Target>> {
        let form =
            "give (x, y) in metres or (x, y, heading), as (0.2, 0.1, 1.57) or \"0.2,0.1,90deg\"";
        self.read(name, |given| given.of_numbers(&[2, 3], ",", form))
    }

    /// Length and width of a tank \[m\].
    pub(crate) fn tank(&self, name: &str) -> PyResult<Option<Tank>> {
        let form = "give length and width in metres, as (1.6, 1.2) or \"1.6x1.2\"";
        self.read(name, |given| given.of_numbers(&[2], "x", form))
    }

    /// Values on axes of a sweep.
    pub(crate) fn axis_values(&self, name: &str) -> PyResult<Vec<(Field, f64)>> {
        let form = "give a value for each axis, as {\"drag.chi\": 2}";
        let values = self.read(name, |given| {
            let items = given.value.call_method0("items");
            let items = items.and_then(|items| items.try_iter()?.collect::<PyResult<Vec<_>>>());
            let items = items.map_err(|_| given.refused(form))?;
            let one = |item: Bound<'py, PyAny>| {
                let (axis, value): (String, Bound<'py, PyAny>) =
                    item.extract().map_err(|_| given.refused(form))?;
                let axis = field(&axis).map_err(|problem| given.refused(&problem))?;
                let number = match value.extract::<f64>() {
                    Ok(number) => Some(number),
                    Err(_) => value
                        .extract::<String>()
                        .ok()
                        .and_then(|text| axis.parse(&text)),
                };
                let number = number.filter(|number| number.is_finite());
                let invalid = || given.refused(&format!("that is no value of {axis}"));
                Ok((axis, number.ok_or_else(invalid)?))
            };
            items.into_iter().map(one).collect::<PyResult<Vec<_>>>()
        })?;
        Ok(values.unwrap_or_default())
    }

    /// Path.
    pub(crate) fn path(&self, name: &str) -> PyResult<Option<PathBuf>> {
        self.read(name, |given| given.extract("give a path"))
    }

    /// Width in print of the figure that another keyword names.
    pub(crate) fn width(&self, figure: &str) -> PyResult<Option<FigureWidth>> {
        if !self.has(figure)? {
            let alone = format!("this is the width of a figure: also give {figure}");
            self.refuse("width", &alone)?;
        }
        self.read("width", |given| {
            let form = "give 85 for one column of a journal, or 170 for both";
            match given.extract::<u32>(form)? {
                85 => Ok(FigureWidth::Column),
                170 => Ok(FigureWidth::Page),
                _ => Err(given.refused(form)),
            }
        })
    }

    /// Path at which a new file may be written.
    pub(crate) fn new_file(&self, name: &str) -> PyResult<Option<PathBuf>> {
        let path = self.path(name)?;
        if let Some(path) = &path {
            check_new_file(path).map_err(of_operation)?;
        }
        Ok(path)
    }

    /// Bounds on shapes.
    pub(crate) fn bounds(&self) -> PyResult<BoundsRequest> {
        Ok(BoundsRequest {
            max_angle: self.angle("max_angle")?,
            min_angle: self.angle("min_angle")?,
            sector: self.flag("sector")?,
            no_overlap: self.flag("no_overlap")?,
            clearance: self.length("clearance")?.unwrap_or(0.0),
            playable: self.flag("playable")?,
        })
    }

    /// Swimmer: an object, the name of a preset, or a path.
    pub(crate) fn swimmer(&self, name: &str) -> PyResult<Option<SwimmerFile>> {
        self.read(name, |given| {
            let swimmer = SwimmerArgument::of(&given.value)?;
            swimmer.load(&mut Context::on_disk()).map_err(of_operation)
        })
    }

    /// Uncertainty to design for.
    pub(crate) fn robust(&self) -> PyResult<Option<robust::Request>> {
        let fit = self.read("robust", |given| {
            if given.value.is_instance_of::<PyDict>() {
                return Ok(FitSource::Document(depythonize(&given.value)?));
            }
            let form = "give a calibration, or the path of its fit.json";
            Ok(FitSource::File(given.extract(form)?))
        })?;
        let gain = self.read("gain", |given| {
            let form = "give the least and the largest gain, above zero, as (0.98, 1.02)";
            let pair = given.pair();
            pair.filter(|[low, high]| 0.0 < *low && low <= high && high.is_finite())
                .ok_or_else(|| given.refused(form))
        })?;
        let over = self.word(
            "over",
            &[("worst", Statistic::Worst), ("mean", Statistic::Mean)],
        )?;
        if fit.is_none() && gain.is_none() {
            self.refuse(
                "over",
                "that is the statistic of a robust design: also give robust or gain",
            )?;
            return Ok(None);
        }
        Ok(Some(robust::Request {
            fit,
            gain,
            over: over.unwrap_or_default(),
        }))
    }

    /// Timing under a limit on the servos' rate.
    pub(crate) fn timing(&self) -> PyResult<Option<timing::Request>> {
        match (self.rate("max_rate")?, self.seconds("period")?) {
            (Some(max_rate), Some(period)) => Ok(Some(timing::Request { max_rate, period })),
            (None, None) => Ok(None),
            (Some(_), None) => Err(BadInput::new_err(
                "max_rate limits the timing of a cycle: also give its period",
            )),
            (None, Some(_)) => Err(BadInput::new_err(
                "period is that of a cycle with servos of limited rate: also give max_rate",
            )),
        }
    }

    /// Properties of a recording.
    pub(crate) fn recording(&self) -> PyResult<Recording> {
        Ok(Recording {
            scale: self.positive(
                "scale",
                "give the metres per unit of the recording, above zero",
            )?,
            rate: self.positive("rate", "give the frames per second, above zero")?,
            axes: self.parsed("axes")?,
            likelihood: self.positive("likelihood", "give a share above zero, as 0.9")?,
        })
    }
}

/// `path` as text.
pub(crate) fn text_of(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
