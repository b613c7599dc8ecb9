//! Calls of the Drive tab: a session, the twin, and the transport of bytes between the two.

use link_protocol::Direction;
use serde_json::{Value, json};
use swimmer_files::read_link_log;
use swimmer_lab::calls::{CallOutput, Lab, call};
use swimmer_model::Pose;

/// Page: module, clock, a session and its robot.
struct Page {
    lab: Lab,
    now: f64,
    session: u32,
    twin: u32,
    to_robot: Vec<u8>,
    events: Vec<Value>,
}

fn document(answer: CallOutput) -> Value {
    match answer {
        CallOutput::Json(text) => serde_json::from_str(&text).unwrap(),
        CallOutput::Bytes(_) => panic!("bytes where a document was expected"),
    }
}

fn bytes(answer: CallOutput) -> Vec<u8> {
    match answer {
        CallOutput::Bytes(bytes) => bytes,
        CallOutput::Json(text) => panic!("a document where bytes were expected: {text}"),
    }
}

impl Page {
    fn open(key: Option<&str>) -> Self {
        let mut page = Self {
            lab: Lab::default(),
            now: 0.0,
            session: 0,
            twin: 0,
            to_robot: Vec::new(),
            events: Vec::new(),
        };
        page.twin = number(&page.ask("twin open", &json!({ "swimmer": "robot", "seed": 5 })));
        let open = json!({ "seed": 3, "bytes_per_second": 11520.0, "epoch_s": 1e9, "key": key });
        page.session = number(&page.ask("session open", &open));
        page
    }

    fn ask(&mut self, name: &str, question: &Value) -> Value {
        document(
            call(
                &mut self.lab,
                name.as_bytes(),
                question.to_string().as_bytes(),
            )
            .unwrap(),
        )
    }

    fn step_of(&mut self, name: &str, number: u32, carried: &[u8]) -> Vec<u8> {
        let question = [&number.to_le_bytes()[..], &self.now.to_le_bytes(), carried].concat();
        bytes(call(&mut self.lab, name.as_bytes(), &question).unwrap())
    }

    /// Advances session and robot by ten milliseconds.
    fn step(&mut self) {
        self.now += 0.01;
        let to_robot = std::mem::take(&mut self.to_robot);
        let from_robot = self.step_of("twin step", self.twin, &to_robot);
        self.step_session(&from_robot);
    }

    fn step_session(&mut self, from_robot: &[u8]) {
        let answer = self.step_of("session step", self.session, from_robot);
        let (count, rest) = answer.split_first_chunk().unwrap();
        let (sent, output) = rest.split_at(u32::from_le_bytes(*count) as usize);
        self.to_robot.extend_from_slice(sent);
        let output: Value = serde_json::from_slice(output).unwrap();
        self.events
            .extend(output["events"].as_array().unwrap().iter().cloned());
    }

    /// Sends a request to the robot and waits for the event that ends it.
    fn event_of(&mut self, name: &str, question: Value) -> Value {
        let mut question = question;
        question["number"] = json!(self.session);
        question["now_s"] = json!(self.now);
        let ticket = self.ask(name, &question)["ticket"].clone();
        for _ in 0..3000 {
            self.step();
            let ended = |event: &Value| event["ticket"] == ticket && event["event"] != "progress";
            if let Some(at) = self.events.iter().position(ended) {
                return self.events.drain(..=at).next_back().unwrap();
            }
        }
        panic!("ticket {ticket} never ended: {:?}", self.events);
    }

    fn request(&mut self, request: &Value) -> Value {
        self.event_of("session request", json!({ "request": request }))
    }

    fn stands(&mut self) -> Value {
        let number = self.twin;
        self.ask("twin stands", &json!({ "number": number }))
    }

    fn play(&mut self) {
        assert_eq!(
            self.event_of("session connect", json!({}))["event"],
            "connected"
        );
        let uploaded = self.event_of("session upload", json!({ "gait": "circle:0.5" }));
        assert_eq!(uploaded["event"], "uploaded", "{uploaded}");
        let status = self.request(&json!("Status"))["reply"]["Status"].clone();
        let armed = self.request(&json!("Arm"));
        assert_eq!(armed["event"], "answered", "{armed}");
        let checked = json!({
            "table_crc32": status["table"]["crc32"],
            "settings_crc32": status["settings_crc32"],
        });
        let play = json!({ "Play": {
            "cycles": 0, "period_us": 4_000_000, "detached": false, "checked": checked,
        } });
        assert_eq!(self.request(&play)["event"], "answered");
        for _ in 0..600 {
            self.step();
        }
        assert_eq!(self.stands()["state"], "Playing");
    }
}

fn number(opened: &Value) -> u32 {
    u32::try_from(opened["number"].as_u64().unwrap()).unwrap()
}

#[test]
fn the_page_uploads_arms_plays_and_stops_at_once() {
    let mut page = Page::open(None);
    page.play();
    let stands = page.stands();
    assert!(stands["pulses_ns"][0].is_number(), "{stands}");
    assert!(
        page.events
            .iter()
            .any(|event| event["event"] == "telemetry")
    );
    let before = page.now;
    let (number, now_s) = (page.session, page.now);
    page.ask(
        "session request",
        &json!({ "number": number, "now_s": now_s, "request": "EStop" }),
    );
    // It leaves at once, whatever the next beat would be.
    page.step_session(&[]);
    while !page.stands()["pulses_ns"].is_null() {
        page.step();
        // A tick of the brain, and a step of this loop until that is seen.
        let pulses = page.now - before;
        assert!(pulses < 0.0301, "pulses for {pulses} s");
    }
    assert_eq!(page.stands()["state"], "EStopped");
    let link = page.ask("session link", &json!({ "number": number }));
    assert!(link["round_trip_s"].as_f64().unwrap() < 0.1, "{link}");
}

#[test]
fn a_page_that_falls_silent_loses_its_lease() {
    let mut page = Page::open(None);
    page.play();
    // The page hangs: the twin lives on, and nobody steps the session.
    for _ in 0..300 {
        page.now += 0.01;
        page.step_of("twin step", page.twin, &[]);
    }
    assert_eq!(page.stands()["state"], "Stopped");
}

#[test]
fn the_log_is_a_link_log() {
    let mut page = Page::open(None);
    page.play();
    let question = json!({ "number": page.session }).to_string();
    let log = bytes(call(&mut page.lab, b"session log", question.as_bytes()).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.mcap");
    std::fs::write(&path, log).unwrap();
    let frames = read_link_log(&path).unwrap().frames;
    for direction in [Direction::ToRobot, Direction::ToHost] {
        let count = frames
            .iter()
            .filter(|frame| frame.direction == direction)
            .count();
        assert!(count > 20, "{count} frames {direction:?}");
    }
    assert!(
        frames
            .iter()
            .all(|frame| frame.host_time_ns >= 1_000_000_000_000_000_000)
    );
}

#[test]
fn a_play_is_recorded_with_joints_and_pose() {
    let mut page = Page::open(None);
    page.play();
    let began = 1e9 + page.now - 8.0;
    let began_to_stop = page.stands();
    let own = page
        .events
        .iter()
        .rfind(|event| event["event"] == "telemetry");
    let own = &own.unwrap()["telemetry"]["pose"];
    let playing = json!([own["x"], own["y"], own["theta"]]);
    let stopped = page.request(&json!("Stop"));
    assert_eq!(stopped["event"], "answered", "{stopped}");
    for _ in 0..300 {
        page.step();
    }
    let stands = page.stands();
    let recordings = |page: &mut Page, from_s: Value| {
        let question = json!({ "number": page.session, "from_s": from_s }).to_string();
        let log = bytes(call(&mut page.lab, b"session log", question.as_bytes()).unwrap());
        document(call(&mut page.lab, b"recordings", &log).unwrap())
    };
    let whole = recordings(&mut page, Value::Null);
    let [play] = whole.as_array().unwrap().as_slice() else {
        panic!("one play: {whole}");
    };
    assert_eq!(play["ended"], true);
    assert_eq!(play["cycles"], 1);
    assert!((play["began_s"].as_f64().unwrap() - began).abs() < 4.0);
    let samples = play["samples"].as_array().unwrap();
    assert!(samples.len() > 100, "{}", samples.len());
    // The robot's own model begins with the samples, and the joints on the circle.
    assert!(samples[0]["pose"][0].as_f64().unwrap().abs() < 1e-3);
    assert!(samples[0]["phi_rad"][0].as_f64().unwrap() > 0.3);
    // From the stop on, the robot's own model moves as the swimmer in the tank.
    let pose = |value: &Value| {
        let [x, y, theta] = [0, 1, 2].map(|axis| value[axis].as_f64().unwrap());
        Pose::new(x, y, theta)
    };
    let own = pose(&playing).inverse() * pose(&samples.last().unwrap()["pose"]);
    let true_motion = pose(&began_to_stop["pose"]).inverse() * pose(&stands["pose"]);
    let off = (own.position() - true_motion.position()).norm();
    assert!(
        off < 1e-3 && true_motion.position().norm() > 1e-3,
        "{own:?} {true_motion:?}"
    );
    // A log that begins after the play holds none.
    let after = json!(page.now - 0.1);
    assert_eq!(recordings(&mut page, after), json!([]));
}

#[test]
fn another_page_overhears_the_telemetry() {
    let mut page = Page::open(None);
    page.play();
    let ear = number(&page.ask("overhear open", &json!({})));
    let mut heard = 0;
    for _ in 0..100 {
        page.now += 0.01;
        let sent = page.step_of("twin step", page.twin, &[]);
        let question = [&ear.to_le_bytes()[..], &page.now.to_le_bytes(), &sent].concat();
        let output = document(call(&mut page.lab, b"overhear step", &question).unwrap());
        heard += output["events"].as_array().unwrap().len();
    }
    assert!(heard >= 5, "{heard} of a second");
}

#[test]
fn what_cannot_be_is_said() {
    let mut page = Page::open(Some("000102030405060708090a0b0c0d0e0f"));
    assert_eq!(
        page.event_of("session connect", json!({}))["event"],
        "connected"
    );
    let reason = |lab: &mut Lab, name: &str, question: Value| {
        call(lab, name.as_bytes(), question.to_string().as_bytes()).unwrap_err()
    };
    let lab = &mut page.lab;
    let key = json!({ "seed": 3, "bytes_per_second": 1.0, "epoch_s": 0.0, "key": "12" });
    assert!(reason(lab, "session open", key).contains("line 1: 2 digits"));
    assert!(reason(lab, "session link", json!({ "number": 99 })).contains("open it again"));
    assert!(
        reason(
            lab,
            "session connect",
            json!({ "number": page.session, "now_s": -1.0 })
        )
        .contains("-1")
    );
    assert!(
        call(lab, b"session step", &[1, 2])
            .unwrap_err()
            .contains("less than")
    );
    let far = json!({ "swimmer": "robot", "gait": "circle:4", "period_s": 10.0, "robot": null });
    assert!(reason(lab, "preflight", far).contains("beyond the servos"));
}

#[test]
fn preflight_predicts_the_play_of_the_robot() {
    let mut page = Page::open(None);
    let connected = page.event_of("session connect", json!({}));
    let answered = page.request(&json!("Configuration"));
    let configuration = &answered["reply"]["Configuration"];
    assert!(configuration.is_object(), "{answered}");
    let mut question = json!({ "swimmer": "robot", "gait": "circle:1.2", "period_s": 0.9, "robot": { "hello": connected["hello"], "configuration": configuration } });
    let output = page.ask("preflight", &question);
    assert_eq!(output["configured_as"], true, "{output}");
    assert!(
        output["refused"].as_str().unwrap().contains("period"),
        "{output}"
    );
    question["period_s"] = json!(20.0);
    let output = page.ask("preflight", &question);
    assert!(output["refused"].is_null(), "{output}");
    assert!(output["loss_share"].as_f64().unwrap().abs() < 0.1);
    let end = output["path"].as_array().unwrap().last().unwrap();
    for axis in 0..2 {
        let net = output["displacement_m"][axis].as_f64().unwrap();
        assert!((end[axis].as_f64().unwrap() - net).abs() < 2e-6, "{end}");
    }
    assert!((end[2].as_f64().unwrap() - output["rotation_rad"].as_f64().unwrap()).abs() < 2e-6);
}
