//! State machine of the dialogue with the module: one command at a time, which ends with OK, an error or a time-out.

use std::mem::take;
use std::time::Duration;

use super::reply::{Lines, ReplyLine};
use super::{Hc05Error, Module, ModuleSettings, Outcome, Setting, Uart};

/// Time-out of a command. Some modules need most of a second to report their name.
const PATIENCE: Duration = Duration::from_secs(2);
/// Attempts of the first `AT`, which may follow an incomplete line or reach a module that is still starting.
const KNOCKS: u32 = 4;
/// Pause between a reply and the next command: some modules miss an earlier one.
const REST: Duration = Duration::from_millis(50);

/// Next action of the caller.
#[derive(Debug)]
pub enum Action {
    /// Send this text.
    Send(String),
    /// Wait for bytes, or until this time of the port's clock.
    WaitUntil(Duration),
    /// The dialogue is over. Later polls wait forever.
    Done(Result<Outcome, Hc05Error>),
}

/// Command under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Knock(u32),
    Version,
    Ask(Setting),
    Set(Setting, Quotes),
    AskAgain(Setting),
    Reset,
}

/// Quoting of the PIN, which differs between makers. A module of the other style refuses the PIN, or keeps the quotes as part
/// of it. The style of the reported PIN is tried first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quotes {
    First(bool),
    Other(bool),
}

impl Quotes {
    fn on(self) -> bool {
        let (Self::First(on) | Self::Other(on)) = self;
        on
    }
}

/// Outcome of a command.
#[derive(Debug)]
enum CommandOutcome {
    Ok(Option<String>),
    Error(String),
    Silence,
}

/// Dialogue with a module.
#[derive(Debug)]
pub struct Dialogue {
    wanted: ModuleSettings,
    only_check: bool,
    step: Step,
    /// Time at which the present command was sent.
    sent: Option<Duration>,
    not_before: Duration,
    now: Duration,
    lines: Lines,
    value: Option<String>,
    /// Number of bytes since the first command. `echoed`: our own bytes came back.
    heard: usize,
    echoed: bool,
    quotes: bool,
    before: Module,
    after: Module,
    differed: Vec<Setting>,
    to_set: Vec<Setting>,
    to_ask_again: Vec<Setting>,
    end: End,
}

/// End of the dialogue.
#[derive(Debug)]
enum End {
    NotYet,
    Now(Result<Outcome, Hc05Error>),
    Told,
}

/// Settings in the order in which they are read, set and read back. The speed is last, so that an earlier failure leaves the
/// module at the known speed.
const SETTINGS: [Setting; 4] = [Setting::Role, Setting::Name, Setting::Pin, Setting::Uart];

impl Dialogue {
    /// Returns a dialogue at its start.
    pub fn new(wanted: ModuleSettings, only_check: bool) -> Self {
        Self {
            wanted,
            only_check,
            step: Step::Knock(1),
            sent: None,
            not_before: Duration::ZERO,
            now: Duration::ZERO,
            lines: Lines::default(),
            value: None,
            heard: 0,
            echoed: false,
            quotes: false,
            before: Module::default(),
            after: Module::default(),
            differed: Vec::new(),
            to_set: Vec::new(),
            to_ask_again: Vec::new(),
            end: End::NotYet,
        }
    }

    /// Returns the action at this time of the port's clock.
    pub fn poll(&mut self, now: Duration) -> Action {
        self.now = now;
        if let Some(sent) = self.sent
            && now >= sent + PATIENCE
        {
            self.answered(&CommandOutcome::Silence);
        }
        match std::mem::replace(&mut self.end, End::Told) {
            End::NotYet => self.end = End::NotYet,
            End::Now(outcome) => return Action::Done(outcome),
            End::Told => return Action::WaitUntil(Duration::MAX),
        }
        match self.sent {
            Some(sent) => Action::WaitUntil(sent + PATIENCE),
            None if now < self.not_before => Action::WaitUntil(self.not_before),
            None => {
                self.sent = Some(now);
                self.lines.clear();
                Action::Send(self.command() + "\r\n")
            }
        }
    }

    /// Adds received bytes.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.heard += 1;
            let line = self.lines.push(byte);
            // Bytes before a command are not its reply.
            if self.sent.is_none() {
                continue;
            }
            match line {
                Some(ReplyLine::Ok) => {
                    let value = take(&mut self.value);
                    self.answered(&CommandOutcome::Ok(value));
                }
                Some(ReplyLine::Error(code)) => self.answered(&CommandOutcome::Error(code)),
                Some(ReplyLine::Value(value)) => self.value = Some(value),
                Some(ReplyLine::Other(text)) => self.echoed |= text == self.command(),
                None => {}
            }
        }
    }

    fn command(&self) -> String {
        let key = |setting| match setting {
            Setting::Role => "ROLE",
            Setting::Name => "NAME",
            Setting::Pin => "PSWD",
            Setting::Uart => "UART",
        };
        match self.step {
            Step::Knock(_) => "AT".to_owned(),
            Step::Version => "AT+VERSION?".to_owned(),
            Step::Ask(setting) | Step::AskAgain(setting) => format!("AT+{}?", key(setting)),
            Step::Set(setting, quotes) => {
                let value = self.value_wanted(setting).unwrap_or_default();
                let quote = if quotes.on() { "\"" } else { "" };
                format!("AT+{}={quote}{value}{quote}", key(setting))
            }
            Step::Reset => "AT+RESET".to_owned(),
        }
    }

    fn value_wanted(&self, setting: Setting) -> Option<String> {
        match setting {
            Setting::Role => Some("0".to_owned()),
            Setting::Name => self.wanted.name.clone(),
            Setting::Pin => self.wanted.pin.clone(),
            Setting::Uart => Some(Uart::at(self.wanted.baud).to_string()),
        }
    }

    /// Evaluates the outcome of the present command and proceeds to the next one.
    fn answered(&mut self, answer: &CommandOutcome) {
        match self.follow(answer) {
            Ok(Some(step)) => self.step = step,
            Ok(None) => {
                self.end = End::Now(Ok(Outcome {
                    before: take(&mut self.before),
                    after: take(&mut self.after),
                    differed: take(&mut self.differed),
                }));
            }
            Err(error) => self.end = End::Now(Err(error)),
        }
        self.sent = None;
        self.value = None;
        self.not_before = self.now + REST;
    }

    /// Returns the next step; `None` at the end.
    fn follow(&mut self, answer: &CommandOutcome) -> Result<Option<Step>, Hc05Error> {
        match (self.step, answer) {
            (Step::Knock(_), CommandOutcome::Ok(_)) => Ok(Some(Step::Version)),
            (Step::Knock(tries), _) if tries < KNOCKS => Ok(Some(Step::Knock(tries + 1))),
            (Step::Knock(tries), CommandOutcome::Error(code)) => Err(Hc05Error::NoAtMode {
                code: code.clone(),
                tries,
            }),
            (Step::Knock(tries), CommandOutcome::Silence) => Err(match (self.heard, self.echoed) {
                (_, true) => Hc05Error::Echo,
                (0, false) => Hc05Error::Silent { tries },
                (bytes, false) => Hc05Error::Noise { bytes },
            }),
            // A module that restarts may not send OK.
            (Step::Reset, CommandOutcome::Ok(_) | CommandOutcome::Silence) => Ok(None),
            (_, CommandOutcome::Silence) => Err(Hc05Error::Stopped {
                command: self.command(),
            }),
            (Step::Version, answer) => {
                if let CommandOutcome::Ok(value) = answer {
                    self.before.version.clone_from(value);
                }
                Ok(Some(Step::Ask(SETTINGS[0])))
            }
            (Step::Ask(setting), answer) => {
                if let CommandOutcome::Ok(Some(value)) = answer {
                    self.quotes |= setting == Setting::Pin && value.starts_with('"');
                    self.before.learn(setting, value);
                }
                let next = SETTINGS.iter().position(|&known| known == setting);
                Ok(next
                    .and_then(|at| SETTINGS.get(at + 1))
                    .map_or_else(|| self.all_asked(), |&setting| Some(Step::Ask(setting))))
            }
            (Step::Set(setting @ Setting::Pin, Quotes::First(on)), CommandOutcome::Error(_)) => {
                Ok(Some(Step::Set(setting, Quotes::Other(!on))))
            }
            (Step::Set(..), CommandOutcome::Ok(_)) => Ok(Some(self.next_to_set())),
            (Step::AskAgain(setting), CommandOutcome::Ok(Some(value))) => {
                self.after.learn(setting, value);
                self.kept(setting)?;
                Ok(Some(self.next_to_ask_again()))
            }
            // A setting that was unreadable before need not be readable afterwards.
            (Step::AskAgain(_), _) => Ok(Some(self.next_to_ask_again())),
            (Step::Set(..) | Step::Reset, CommandOutcome::Error(code)) => Err(Hc05Error::Refused {
                command: self.command(),
                code: code.clone(),
            }),
        }
    }

    /// Compares all settings with the requested ones. Returns `None` if nothing has to be changed.
    fn all_asked(&mut self) -> Option<Step> {
        self.after = self.before.clone();
        self.differed = SETTINGS
            .into_iter()
            .filter(|&setting| {
                let wanted = self.value_wanted(setting);
                let found = self.before.value(setting);
                // An unreadable role is the factory setting, which waits for connections.
                wanted.is_some()
                    && found != wanted
                    && !(setting == Setting::Role && found.is_none())
            })
            .collect();
        if self.only_check || self.differed.is_empty() {
            return None;
        }
        self.to_set = self.differed.iter().rev().copied().collect();
        self.to_ask_again.clone_from(&self.to_set);
        Some(self.next_to_set())
    }

    fn next_to_set(&mut self) -> Step {
        let quotes = |setting| Quotes::First(setting == Setting::Pin && self.quotes);
        match self.to_set.pop() {
            Some(setting) => Step::Set(setting, quotes(setting)),
            None => self.next_to_ask_again(),
        }
    }

    fn next_to_ask_again(&mut self) -> Step {
        self.to_ask_again.pop().map_or(Step::Reset, Step::AskAgain)
    }

    fn kept(&self, setting: Setting) -> Result<(), Hc05Error> {
        let (wanted, found) = (self.value_wanted(setting), self.after.value(setting));
        if wanted == found {
            return Ok(());
        }
        Err(Hc05Error::NotKept {
            setting: setting.word(),
            wanted: wanted.unwrap_or_default(),
            found: found.unwrap_or_else(|| "nothing".to_owned()),
        })
    }
}

impl Module {
    /// Stores a reported value.
    fn learn(&mut self, setting: Setting, value: &str) {
        let bare = value.trim_matches('"').to_owned();
        match setting {
            Setting::Role => self.role = bare.parse().ok(),
            Setting::Name => self.name = Some(bare),
            Setting::Pin => self.pin = Some(bare),
            Setting::Uart => self.uart = uart(&bare),
        }
    }

    /// Requested value in the form in which it is set.
    fn value(&self, setting: Setting) -> Option<String> {
        match setting {
            Setting::Role => self.role.map(|role| role.to_string()),
            Setting::Name => self.name.clone(),
            Setting::Pin => self.pin.clone(),
            Setting::Uart => self.uart.map(|uart| uart.to_string()),
        }
    }
}

fn uart(value: &str) -> Option<Uart> {
    let mut parts = value.split(',').map(str::trim);
    Some(Uart {
        baud: parts.next()?.parse().ok()?,
        stop: parts.next()?.parse().ok()?,
        parity: parts.next()?.parse().ok()?,
    })
}
