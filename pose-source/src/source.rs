//! Names of sources, as the command line has them.

use std::fmt;
use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::str::FromStr;

/// Origin of the frames.
///
/// ```
/// use pose_source::SourceName;
///
/// for text in ["natnet", "natnet:192.168.1.10", "natnet:motive.local:1510,192.168.1.20", "tcp:localhost:7700", "-", "twin", "run.csv"] {
///     assert_eq!(text.parse::<SourceName>().unwrap().to_string(), text);
/// }
/// assert!("tcp:localhost".parse::<SourceName>().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SourceName {
    /// `natnet[:HOST[,LOCAL]]`.
    NatNet(NatNetAddress),
    /// `tcp:HOST:PORT`.
    Tcp(String),
    /// `-`.
    StandardInput,
    /// `FILE`.
    File(PathBuf),
    /// `twin`.
    Twin,
}

/// A NatNet server, and the local interface.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct NatNetAddress {
    /// Host with or without the command port; `None`: the sender of the first multicast frame.
    pub host: Option<String>,
    /// Address of the local interface; `None`: the system's choice.
    pub local: Option<Ipv4Addr>,
}

impl FromStr for SourceName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(address) = text.strip_prefix("tcp:") {
            let port = address
                .rsplit_once(':')
                .map(|(host, port)| (host, port.parse::<u16>()));
            return match port {
                Some((host, Ok(_))) if !host.is_empty() => Ok(Self::Tcp(address.to_owned())),
                _ => Err(format!("`{text}` is not tcp:HOST:PORT")),
            };
        }
        match text {
            "-" => return Ok(Self::StandardInput),
            "twin" => return Ok(Self::Twin),
            "natnet" => return Ok(Self::NatNet(NatNetAddress::default())),
            "" => return Err("name a source: natnet, tcp:HOST:PORT, -, twin or a file".to_owned()),
            _ => {}
        }
        let Some(address) = text.strip_prefix("natnet:") else {
            return Ok(Self::File(PathBuf::from(text)));
        };
        let (host, local) = match address.split_once(',') {
            Some((host, local)) => (host, Some(local)),
            None => (address, None),
        };
        let wrong = || {
            format!(
                "`{text}` is not natnet[:HOST[,LOCAL]]; LOCAL is the IPv4 address of an interface of this computer"
            )
        };
        let local = local
            .map(|local| local.parse().map_err(|_| wrong()))
            .transpose()?;
        if host.is_empty() {
            return Err(wrong());
        }
        Ok(Self::NatNet(NatNetAddress {
            host: Some(host.to_owned()),
            local,
        }))
    }
}

impl fmt::Display for SourceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NatNet(address) => {
                f.write_str("natnet")?;
                if let Some(host) = &address.host {
                    write!(f, ":{host}")?;
                }
                if let Some(local) = address.local {
                    write!(f, ",{local}")?;
                }
                Ok(())
            }
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::StandardInput => f.write_str("-"),
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Twin => f.write_str("twin"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_names_are_refused() {
        for text in [
            "",
            "natnet:",
            "natnet:,1.2.3.4",
            "natnet:host,eth0",
            "tcp:",
            "tcp:h:99999",
        ] {
            assert!(text.parse::<SourceName>().is_err(), "{text}");
        }
    }
}
