//! Accepted and refused requests.

use super::*;

const HERE: &str = "127.0.0.1:7070";
/// RFC 6455, section 1.3.
const KEY: &str = "dGhlIHNhbXBsZSBub25jZQ==";

fn gate() -> Gate {
    Gate {
        token: Token("c0ffee".to_owned()),
        name: None,
        has_robot: true,
    }
}

fn asked(
    gate: &Gate,
    first: &str,
    headers: &[(&str, &str)],
    here: &str,
) -> Result<PageRequest, Refusal> {
    let mut lines = vec![format!("{first} HTTP/1.1")];
    lines.extend(
        headers
            .iter()
            .map(|(name, value)| format!("{name}: {value}")),
    );
    gate.judge(
        (lines.join("\r\n") + "\r\n\r\n").as_bytes(),
        here.parse().unwrap(),
    )
}

fn status(judged: Result<PageRequest, Refusal>) -> &'static str {
    judged.map_or_else(|refused| refused.status, |_| "let in")
}

fn link(changes: &[(&str, &str)]) -> &'static str {
    let mut headers = vec![
        ("Host", HERE),
        ("Origin", "http://127.0.0.1:7070"),
        ("Upgrade", "websocket"),
        ("Connection", "keep-alive, Upgrade"),
        ("Sec-WebSocket-Version", "13"),
        ("Sec-WebSocket-Key", KEY),
        ("Sec-WebSocket-Protocol", "swimmer, c0ffee"),
    ];
    for (name, value) in changes {
        headers.retain(|(known, _)| known != name);
        if !value.is_empty() {
            headers.push((name, value));
        }
    }
    status(asked(&gate(), "GET /link", &headers, HERE))
}

#[test]
fn our_page_and_one_from_disk_reach_the_robot_with_the_token_alone() {
    assert_eq!(link(&[]), "let in");
    assert_eq!(link(&[("Origin", "null")]), "let in");
    assert_eq!(link(&[("Origin", "")]), "let in"); // no browser
    for origin in ["null", "", "http://127.0.0.1:7070"] {
        for protocols in [
            "swimmer",
            "",
            "c0ffee",
            "swimmer, c0ffef",
            "swimmer, c0ffee0",
        ] {
            let told = link(&[("Origin", origin), ("Sec-WebSocket-Protocol", protocols)]);
            assert_eq!(told, "403 Forbidden", "{origin} {protocols}");
        }
    }
    let accepted = asked(
        &gate(),
        "GET /link",
        &[
            ("Host", HERE),
            ("Upgrade", "WebSocket"),
            ("Connection", "upgrade"),
            ("Sec-WebSocket-Version", "13"),
            ("Sec-WebSocket-Key", KEY),
            ("Sec-WebSocket-Protocol", "swimmer, c0ffee"),
        ],
        HERE,
    );
    // The answer that RFC 6455 gives to its own example.
    let accept = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=".to_owned();
    assert_eq!(accepted, Ok(PageRequest::Link { accept }));
}

#[test]
fn other_sites_and_other_names_are_turned_away_even_with_the_token() {
    for origin in [
        "http://evil.example",
        "https://127.0.0.1:7070",
        "http://127.0.0.1:7071",
        "http://localhost:7070",
        "file://",
    ] {
        assert_eq!(link(&[("Origin", origin)]), "403 Forbidden", "{origin}");
    }
    for host in [
        "evil.example:7070",
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:7071",
        "127.0.0.2:7070",
        "[::1]:7070",
        ":7070",
        "127.0.0.1:7070:7070",
    ] {
        assert_eq!(link(&[("Host", host)]), "421 Misdirected Request", "{host}");
    }
    assert_eq!(
        link(&[
            ("Host", "localhost:7070"),
            ("Origin", "http://localhost:7070")
        ]),
        "let in"
    );
    assert_eq!(link(&[("Host", "")]), "400 Bad Request");
    for (name, value) in [
        ("Upgrade", "h2c"),
        ("Connection", "close"),
        ("Sec-WebSocket-Version", "8"),
        ("Sec-WebSocket-Key", ""),
    ] {
        assert_eq!(link(&[(name, value)]), "426 Upgrade Required", "{name}");
    }
}

#[test]
fn a_header_that_stands_there_twice_is_refused() {
    for doubled in ["Host", "Origin"] {
        let headers = [
            ("Host", HERE),
            ("Origin", "null"),
            (doubled, "evil.example"),
        ];
        assert_eq!(
            status(asked(&gate(), "GET /link", &headers, HERE)),
            "400 Bad Request"
        );
    }
}

#[test]
fn the_page_is_given_under_our_names_only() {
    let page = |host: &str, here: &str| status(asked(&gate(), "GET /?x", &[("Host", host)], here));
    assert_eq!(page(HERE, HERE), "let in");
    assert_eq!(page("[::1]:7070", "[::1]:7070"), "let in");
    assert_eq!(page("192.0.2.7:7070", "192.0.2.7:7070"), "let in");
    // Not reached over the loopback: `localhost` is somebody else's.
    assert_eq!(
        page("localhost:7070", "192.0.2.7:7070"),
        "421 Misdirected Request"
    );
    assert_eq!(
        page("rebound.example:7070", HERE),
        "421 Misdirected Request"
    );
    let named = Gate {
        name: Some("lab-pc".into()),
        ..gate()
    };
    assert_eq!(
        status(asked(
            &named,
            "GET /",
            &[("Host", "lab-pc:7070")],
            "192.0.2.7:7070"
        )),
        "let in"
    );
    assert_eq!(
        status(asked(&gate(), "POST /", &[("Host", HERE)], HERE)),
        "405 Method Not Allowed"
    );
    assert_eq!(
        status(asked(&gate(), "GET /etc/passwd", &[("Host", HERE)], HERE)),
        "404 Not Found"
    );
    assert_eq!(
        status(gate().judge(b"hello\r\n\r\n", HERE.parse().unwrap())),
        "400 Bad Request"
    );
}

#[test]
fn tokens_differ() {
    let (one, other) = (Token::new().unwrap(), Token::new().unwrap());
    assert_eq!(one.0.len(), 32);
    assert!(!one.is(&other.0) && one.is(&one.0));
}
