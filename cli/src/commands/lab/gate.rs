//! Access control: a request needs the token, an origin that is this server's page or a page on a disk, and a `Host` that names
//! this server.
//!
//! Any page in any tab may send requests to this machine. So the name in `Host` must be an address of ours (another is a name
//! rebound to us), `Origin` must be the page that we serve or `null` (a page opened from disk), and the token must be right; it
//! travels in the URL's fragment, which browsers keep to themselves, and in a WebSocket's list of protocols.

use std::fmt;
use std::net::{IpAddr, SocketAddr};

use subtle::ConstantTimeEq as _;
use tungstenite::handshake::derive_accept_key;

use crate::failure::{Failure, Outcome};

/// Path of the page's WebSocket.
const LINK: &str = "/link";
/// Protocol of the WebSocket; the token follows it in the list of protocols.
pub(super) const PROTOCOL: &str = "swimmer";
/// Headers that browsers send; more are refused.
const MOST_HEADERS: usize = 64;

/// A secret of this run, 128 bits as hexadecimal digits.
pub(super) struct Token(String);

impl Token {
    /// A fresh one.
    ///
    /// # Errors
    /// [`Failure::Tried`] where the system has no random numbers.
    pub(super) fn new() -> Outcome<Self> {
        let mut secret = [0_u8; 16];
        getrandom::fill(&mut secret).map_err(|error| {
            Failure::Tried(format!(
                "the system gave no random numbers for the page's token ({error}); nothing was served"
            ))
        })?;
        let digits = secret.iter().map(|byte| format!("{byte:02x}"));
        Ok(Self(digits.collect()))
    }

    /// Compared in the same time wherever they differ.
    fn is(&self, presented: &str) -> bool {
        self.0.as_bytes().ct_eq(presented.as_bytes()).into()
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Resource of an accepted request.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum PageRequest {
    /// The page, or only its head.
    Page { head_only: bool },
    /// The robot's bytes, over a WebSocket that this key accepts.
    Link { accept: String },
}

/// Refusal of a request, with its HTTP status.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) status: &'static str,
    pub(super) reason: &'static str,
}

const fn refusal(status: &'static str, reason: &'static str) -> Refusal {
    Refusal { status, reason }
}

/// Rules for requests.
pub(super) struct Gate {
    pub(super) token: Token,
    /// The name that `--listen` gave this server, in addition to its addresses.
    pub(super) name: Option<String>,
    /// `true` if there is a robot to drive.
    pub(super) has_robot: bool,
}

impl Gate {
    /// Judges the head of a request that arrived at `here`.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn judge(&self, head: &[u8], here: SocketAddr) -> Result<PageRequest, Refusal> {
        const GARBLED: Refusal = refusal("400 Bad Request", "this is no request of a browser");
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        if !request.parse(head).is_ok_and(|parsed| parsed.is_complete()) {
            return Err(GARBLED);
        }
        let (Some(method), Some(path)) = (request.method, request.path) else {
            return Err(GARBLED);
        };
        let headers = Headers(request.headers);
        let host = headers.one("host")?.ok_or(GARBLED)?;
        if !self.is_ours(host, here) {
            return Err(refusal(
                "421 Misdirected Request",
                "this server is not known by that name: open the address that `swimmer lab` printed",
            ));
        }
        match (method, path.split('?').next().unwrap_or_default()) {
            ("GET" | "HEAD", "/" | "/index.html") => Ok(PageRequest::Page {
                head_only: method == "HEAD",
            }),
            ("GET", LINK) => self.link(&headers, host),
            (_, "/" | "/index.html" | LINK) => Err(refusal(
                "405 Method Not Allowed",
                "only GET is answered here",
            )),
            _ => Err(refusal("404 Not Found", "there is only the page, at /")),
        }
    }

    fn link(&self, headers: &Headers<'_>, host: &str) -> Result<PageRequest, Refusal> {
        if let Some(origin) = headers.one("origin")?
            && origin != "null"
            && origin.strip_prefix("http://") != Some(host)
        {
            return Err(refusal(
                "403 Forbidden",
                "a page of another site asks for the robot: only this server's page may, or one opened from disk",
            ));
        }
        let protocols = headers.words("sec-websocket-protocol");
        if !protocols.clone().any(|word| word == PROTOCOL)
            || !protocols.fold(false, |known, word| known | self.token.is(word))
        {
            return Err(refusal(
                "403 Forbidden",
                "the token is missing or of another run: open the address that `swimmer lab` printed",
            ));
        }
        if !self.has_robot {
            return Err(refusal(
                "404 Not Found",
                "there is no robot here: start `swimmer lab --port PORT`",
            ));
        }
        let key = headers.one("sec-websocket-key")?;
        match key {
            Some(key)
                if headers.says("upgrade", "websocket")
                    && headers.says("connection", "upgrade")
                    && headers.one("sec-websocket-version")? == Some("13") =>
            {
                Ok(PageRequest::Link {
                    accept: derive_accept_key(key.as_bytes()),
                })
            }
            _ => Err(refusal(
                "426 Upgrade Required",
                "the robot's bytes go over a WebSocket",
            )),
        }
    }

    /// `true` if a `Host` names this server at the address that was reached.
    fn is_ours(&self, host: &str, here: SocketAddr) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let ip = here.ip().to_canonical();
        let bare = name
            .strip_prefix('[')
            .and_then(|name| name.strip_suffix(']'))
            .unwrap_or(name);
        port == Some(here.port())
            && (bare
                .parse::<IpAddr>()
                .is_ok_and(|named| named.to_canonical() == ip)
                || (ip.is_loopback() && bare.eq_ignore_ascii_case("localhost"))
                || self
                    .name
                    .as_deref()
                    .is_some_and(|name| bare.eq_ignore_ascii_case(name)))
    }
}

/// The headers of a request, by name.
struct Headers<'a>(&'a [httparse::Header<'a>]);

impl<'a> Headers<'a> {
    fn all(&self, name: &str) -> impl Iterator<Item = Option<&'a str>> + Clone {
        self.0
            .iter()
            .filter(move |header| header.name.eq_ignore_ascii_case(name))
            .map(|header| str::from_utf8(header.value).ok().map(str::trim))
    }

    /// The header of which there may be one. Two contradict each other, and somebody on the way may have read the other.
    fn one(&self, name: &str) -> Result<Option<&'a str>, Refusal> {
        let mut found = self.all(name);
        match (found.next(), found.next()) {
            (None, _) => Ok(None),
            (Some(Some(value)), None) => Ok(Some(value)),
            _ => Err(refusal(
                "400 Bad Request",
                "a header stands there twice or is no text",
            )),
        }
    }

    /// All words of a list between commas.
    fn words(&self, name: &str) -> impl Iterator<Item = &'a str> + Clone {
        self.all(name)
            .flatten()
            .flat_map(|value| value.split(','))
            .map(str::trim)
    }

    fn says(&self, name: &str, word: &str) -> bool {
        self.words(name).any(|said| said.eq_ignore_ascii_case(word))
    }
}

#[cfg(test)]
mod tests;
