//! A virtual robot in real time, behind ports that programs open: a pseudo-terminal, TCP, or both.

use std::io;
use std::time::Duration;

use host_link::Port;

use crate::VirtualRobot;

/// How long one turn waits for bytes, over all ports together: what a request waits at most before the brain sees it.
const TURN: Duration = Duration::from_millis(2);
/// Bytes a turn may send: about four times what a line at 115 200 baud carries meanwhile.
const ROOM: usize = 96;

/// Most that the robot's clock moves in one turn: a tick of its brain. Where the machine stalls, or is slower than what it
/// carries, the robot's time lags behind the ports', like any simulation's: it does not find its lease run out with the
/// host's bytes still unread.
const LONGEST_STEP: Duration = Duration::from_millis(20);

/// Lives with the ports' clock until `go_on` says no: it is asked every few milliseconds. What comes from any port reaches
/// the robot; what the robot sends goes to all of them.
///
/// The robot's clock follows that of the first port, from wherever the robot is now, but never catches up on what it missed.
/// Without ports it returns at once.
///
/// # Errors
/// A port or a robot that failed for good; clients that come and go are no failure.
///
/// ```
/// use swimmer_files::SwimmerFile;
/// use twin::{Twin, TwinConfig, serve};
///
/// let mut twin = Twin::new(TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1)).unwrap();
/// // Where there is no port there is nobody to serve.
/// serve(&mut twin, &mut [], |_| true)?;
/// assert_eq!(twin.now(), std::time::Duration::ZERO);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn serve<R: VirtualRobot + ?Sized>(
    robot: &mut R,
    ports: &mut [&mut dyn Port],
    mut go_on: impl FnMut(&R) -> bool,
) -> io::Result<()> {
    let Some(first) = ports.first() else {
        return Ok(());
    };
    let mut last = first.now();
    let wait = TURN / u32::try_from(ports.len()).unwrap_or(u32::MAX);
    let mut buf = [0; 512];
    let mut out = Vec::new();
    while go_on(robot) {
        for index in 0..ports.len() {
            let Some(port) = ports.get_mut(index) else {
                break;
            };
            let count = port.read(&mut buf, wait)?;
            let now = ports.first().map_or(last, |port| Port::now(*port));
            robot.advance(robot.world().now() + now.saturating_sub(last).min(LONGEST_STEP));
            last = now;
            if let Some(bytes) = buf.get(..count).filter(|bytes| !bytes.is_empty()) {
                robot.receive(bytes);
            }
        }
        if let Some(failure) = robot.failure() {
            return Err(io::Error::other(failure.to_string()));
        }
        out.clear();
        robot.transmit(ROOM, &mut out);
        if !out.is_empty() {
            for port in &mut *ports {
                port.write(&out)?;
            }
        }
    }
    Ok(())
}
