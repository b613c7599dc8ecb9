//! HC-05 in AT mode behind a port whose clock advances only during waits.
#![allow(dead_code)] // each test uses a part of it

use std::collections::VecDeque;
use std::io;
use std::time::Duration;

use host_link::Port;

/// PIN style of a maker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Maker {
    /// Accepts and reports a bare PIN; quotes would become part of it.
    Version2,
    /// Requires quotes, and refuses a bare PIN with 1D.
    Version3,
    /// Like `Version3`, but does not report its PIN.
    Forgetful,
}

/// Fault at the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trouble {
    None,
    Silent,
    WrongBaud,
    LoopBack,
    OnlyErrors,
    ColdStart,
    EchoAndAnswer,
    RefusesName,
    RefusesPin,
    SilentFromUart,
    KeepsNothing,
}

/// Module and its port.
#[derive(Debug)]
pub(crate) struct FakeModule {
    maker: Maker,
    trouble: Trouble,
    pub(crate) name: String,
    pub(crate) pin: String,
    pub(crate) uart: String,
    pub(crate) role: u8,
    pub(crate) was_reset: bool,
    /// Number of accepted settings.
    pub(crate) sets: usize,
    commands: usize,
    line: String,
    out: VecDeque<u8>,
    now: Duration,
}

impl FakeModule {
    pub(crate) fn new(maker: Maker) -> Self {
        Self {
            maker,
            trouble: Trouble::None,
            name: "HC-05".to_owned(),
            pin: "1234".to_owned(),
            uart: "9600,0,0".to_owned(),
            role: 1,
            was_reset: false,
            sets: 0,
            commands: 0,
            line: String::new(),
            out: VecDeque::new(),
            now: Duration::ZERO,
        }
    }

    pub(crate) fn with(self, trouble: Trouble) -> Self {
        Self { trouble, ..self }
    }

    fn hear(&mut self, command: &str) -> String {
        self.commands += 1;
        let answer = match self.trouble {
            Trouble::Silent => return String::new(),
            Trouble::WrongBaud => return "\u{1}~\u{7f}x".to_owned(),
            Trouble::LoopBack => return format!("{command}\r\n"),
            Trouble::OnlyErrors => return "ERROR:(0)\r\n".to_owned(),
            Trouble::ColdStart if self.commands == 1 => return "ERROR:(0)\r\n".to_owned(),
            Trouble::SilentFromUart if command.starts_with("AT+UART") => return String::new(),
            Trouble::RefusesName if command.starts_with("AT+NAME=") => "ERROR:(3)\r\n".to_owned(),
            Trouble::RefusesPin if command.starts_with("AT+PSWD=") => "ERROR:(1D)\r\n".to_owned(),
            _ => self.obey(command),
        };
        if self.trouble == Trouble::EchoAndAnswer {
            format!("{command}\r\n{answer}")
        } else {
            answer
        }
    }

    fn obey(&mut self, command: &str) -> String {
        let ok = |value: String| format!("{value}\r\nOK\r\n");
        let quotes = self.maker != Maker::Version2;
        if let Some((key, value)) = command.split_once('=') {
            if key == "AT+PSWD" && quotes != value.starts_with('"') && quotes {
                return "ERROR:(1D)\r\n".to_owned();
            }
            self.sets += 1;
            let kept = if key == "AT+PSWD" && quotes {
                value.trim_matches('"')
            } else {
                value
            };
            if self.trouble != Trouble::KeepsNothing {
                match key {
                    "AT+NAME" => kept.clone_into(&mut self.name),
                    "AT+PSWD" => kept.clone_into(&mut self.pin),
                    "AT+UART" => kept.clone_into(&mut self.uart),
                    "AT+ROLE" => self.role = kept.parse().unwrap(),
                    other => panic!("{other}"),
                }
            } else if key == "AT+ROLE" {
                self.role = 0;
            }
            return "OK\r\n".to_owned();
        }
        match command {
            "AT" => "OK\r\n".to_owned(),
            "AT+VERSION?" if quotes => ok("VERSION:3.0-20170601".to_owned()),
            "AT+VERSION?" => ok("+VERSION:2.0-20100601".to_owned()),
            "AT+ROLE?" => ok(format!("+ROLE:{}", self.role)),
            "AT+NAME?" => ok(format!("+NAME:{}", self.name)),
            "AT+PSWD?" if self.maker == Maker::Forgetful => "ERROR:(0)\r\n".to_owned(),
            "AT+PSWD?" if quotes => ok(format!("+PIN:\"{}\"", self.pin)),
            "AT+PSWD?" => ok(format!("+PSWD:{}", self.pin)),
            "AT+UART?" => ok(format!("+UART:{}", self.uart)),
            "AT+RESET" => {
                self.was_reset = true;
                "OK\r\n".to_owned()
            }
            other => panic!("{other}"),
        }
    }
}

impl Port for FakeModule {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = buf.len().min(self.out.len()).min(5); // replies arrive in pieces
        for (place, byte) in buf.iter_mut().zip(self.out.drain(..count)) {
            *place = byte;
        }
        self.now += if count == 0 {
            timeout
        } else {
            Duration::from_millis(1)
        };
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        for &byte in bytes {
            match byte {
                b'\r' => {}
                b'\n' => {
                    let command = std::mem::take(&mut self.line);
                    let answer = self.hear(&command);
                    self.out.extend(answer.bytes());
                }
                byte => self.line.push(char::from(byte)),
            }
        }
        Ok(())
    }

    fn now(&self) -> Duration {
        self.now
    }
}
