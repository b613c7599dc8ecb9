//! Line parser for the module's replies.

/// Longest line that is kept: noise of a wrong speed has no line ends.
const MAX_LINE: usize = 128;

/// Meaning of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ReplyLine {
    /// The command succeeded.
    Ok,
    /// The command failed. Contains the module's code (hexadecimal digits), or is empty without one.
    Error(String),
    /// `+KEY:value`, or `KEY:value` from some makers.
    Value(String),
    /// Any other text.
    Other(String),
}

impl ReplyLine {
    fn read(text: &str) -> Self {
        let upper = text.to_ascii_uppercase();
        if upper == "OK" {
            return Self::Ok;
        }
        if let Some(code) = upper
            .strip_prefix("ERROR")
            .or_else(|| upper.strip_prefix("FAIL"))
        {
            return Self::Error(code.trim_matches([':', '(', ')', ' ']).to_owned());
        }
        let keyed = text.strip_prefix('+').unwrap_or(text);
        match keyed.split_once(':') {
            Some((key, value))
                if !key.is_empty() && key.chars().all(|c| c.is_ascii_uppercase()) =>
            {
                Self::Value(value.trim().to_owned())
            }
            _ => Self::Other(text.to_owned()),
        }
    }
}

/// Splits bytes into lines, and counts bytes that no module sends.
#[derive(Debug, Default)]
pub(super) struct Lines {
    line: Vec<u8>,
}

impl Lines {
    /// Adds a byte. Returns the line that it completes, if any.
    pub(super) fn push(&mut self, byte: u8) -> Option<ReplyLine> {
        if byte != b'\n' && byte != b'\r' {
            if self.line.len() < MAX_LINE {
                self.line.push(byte);
            }
            return None;
        }
        let text = String::from_utf8_lossy(&self.line).trim().to_owned();
        self.line.clear();
        (!text.is_empty()).then(|| ReplyLine::read(&text))
    }

    /// Discards an incomplete line.
    pub(super) fn clear(&mut self) {
        self.line.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_all_makers_are_read() {
        let read = |text: &str| {
            let mut lines = Lines::default();
            text.bytes()
                .filter_map(|byte| lines.push(byte))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            read("+UART:9600,0,0\r\nOK\r\n"),
            [ReplyLine::Value("9600,0,0".to_owned()), ReplyLine::Ok]
        );
        assert_eq!(
            read("VERSION:3.0-20170601\n"),
            [ReplyLine::Value("3.0-20170601".to_owned())]
        );
        assert_eq!(
            read("+PIN:\"1234\"\r"),
            [ReplyLine::Value("\"1234\"".to_owned())]
        );
        assert_eq!(read("ERROR:(1D)\r\n"), [ReplyLine::Error("1D".to_owned())]);
        assert_eq!(read("ERROR\r\n"), [ReplyLine::Error(String::new())]);
        assert_eq!(read("FAIL\r\n"), [ReplyLine::Error(String::new())]);
        assert_eq!(
            read("AT+NAME=a:b\r\n"),
            [ReplyLine::Other("AT+NAME=a:b".to_owned())]
        );
        assert_eq!(read("\r\n\r\n"), []);
    }
}
