//! The one robot among several ports: each is greeted briefly, all at the same time.

use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use host_link::Robot;
use host_link::port::ListedPort;

use super::access::greet;
use super::port::{AnyPort, Means};
use crate::failure::{Failure, Outcome};

/// Time for a greeting where several ports are tried: a Bluetooth link takes a second or two to come up.
const BRIEFLY: Duration = Duration::from_secs(4);
/// Time where there is one port only: its own error is worth waiting for.
const PATIENTLY: Duration = Duration::from_secs(20);

/// A greeted robot, or the reason why the greeting failed.
pub(super) type GreetingResult<T = Robot<AnyPort>> = Result<T, String>;

/// Greets every port. Nobody is moved by a greeting; a device that is no robot sees a few bytes.
pub(super) fn greet_all(
    ports: Vec<ListedPort>,
    means: &Means,
) -> Vec<(ListedPort, GreetingResult)> {
    let patience = if ports.len() == 1 { PATIENTLY } else { BRIEFLY };
    let until = Instant::now() + patience;
    let (sender, results) = mpsc::channel();
    for (index, port) in ports.iter().enumerate() {
        let (sender, path, means) = (sender.clone(), port.path.clone(), means.clone());
        // A port that never opens keeps its thread; the command does not wait for it.
        thread::spawn(move || {
            // Nobody listens any more where the time was up.
            let _ = sender.send((index, greet(&path, &means)));
        });
    }
    drop(sender);
    let mut greeted: Vec<Option<GreetingResult>> = ports.iter().map(|_| None).collect();
    while let Ok((index, result)) =
        results.recv_timeout(until.saturating_duration_since(Instant::now()))
    {
        if let Some(place) = greeted.get_mut(index) {
            *place = Some(result);
        }
    }
    let silent = || Err(format!("no answer within {} s", patience.as_secs()));
    ports
        .into_iter()
        .zip(greeted)
        .map(|(port, result)| (port, result.unwrap_or_else(silent)))
        .collect()
}

/// The one that answered.
///
/// # Errors
/// [`Failure::BadInput`] where there is no port at all or several robots answer, so that one must be named;
/// [`Failure::Tried`] where there are ports and no robot.
pub(super) fn choose<T>(results: Vec<(ListedPort, GreetingResult<T>)>) -> Outcome<(ListedPort, T)> {
    let (mut robots, mut reasons) = (Vec::new(), Vec::new());
    for (port, result) in results {
        match result {
            Ok(robot) => robots.push((port, robot)),
            Err(reason) => reasons.push(format!("\n  {port}: {reason}")),
        }
    }
    if robots.len() > 1 {
        let names: Vec<String> = robots
            .iter()
            .map(|(port, _)| format!("\n  {port}"))
            .collect();
        return Err(Failure::BadInput(format!(
            "{} robots answer; say which with --port:{}",
            robots.len(),
            names.concat()
        )));
    }
    match robots.pop() {
        Some(found) => Ok(found),
        None if reasons.is_empty() => Err(Failure::BadInput(
            "this computer has no USB or Bluetooth serial port; name the robot's port: --port with a serial port, a \
             pseudo-terminal, tcp:HOST:PORT, `twin` or `emulator`"
                .to_owned(),
        )),
        None => Err(Failure::Tried(format!(
            "no robot answers at any port; is it switched on and paired? Tried:{}",
            reasons.concat()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(path: &str) -> ListedPort {
        ListedPort {
            path: path.to_owned(),
            about: "Bluetooth".to_owned(),
        }
    }

    #[test]
    fn the_only_robot_is_taken() {
        let results = vec![
            (port("/dev/rfcomm0"), Err("no answer".to_owned())),
            (port("/dev/rfcomm1"), Ok(7)),
        ];
        let (found, robot) = choose(results).unwrap();
        assert_eq!((found.path.as_str(), robot), ("/dev/rfcomm1", 7));
    }

    #[test]
    fn of_two_robots_one_must_be_named() {
        let results = vec![(port("/dev/rfcomm0"), Ok(1)), (port("/dev/rfcomm1"), Ok(2))];
        insta::assert_snapshot!(choose(results).unwrap_err(), @"
2 robots answer; say which with --port:
  /dev/rfcomm0 (Bluetooth)
  /dev/rfcomm1 (Bluetooth)
");
    }

    #[test]
    fn where_nobody_answers_each_port_says_why() {
        let results: Vec<(_, GreetingResult<()>)> = vec![
            (port("/dev/rfcomm0"), Err("no answer within 4 s".to_owned())),
            (port("/dev/ttyUSB0"), Err("permission denied".to_owned())),
        ];
        let failure = choose(results).unwrap_err();
        assert!(matches!(failure, Failure::Tried(_)));
        insta::assert_snapshot!(failure, @"
no robot answers at any port; is it switched on and paired? Tried:
  /dev/rfcomm0 (Bluetooth): no answer within 4 s
  /dev/ttyUSB0 (Bluetooth): permission denied
");
    }

    #[test]
    fn without_any_port_one_must_be_named() {
        let failure = choose::<()>(Vec::new()).unwrap_err();
        assert!(matches!(failure, Failure::BadInput(_)), "{failure}");
    }
}
