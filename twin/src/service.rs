//! Real-time service of a virtual robot behind ports: a pseudo-terminal, TCP, or both.

use std::io;
use std::time::Duration;

use host_link::Port;

use crate::VirtualRobot;

/// Waiting time of one turn for bytes, over all ports together: the longest delay of a request.
const TURN: Duration = Duration::from_millis(2);
/// Most bytes sent per turn: about four times the capacity of a line at 115 200 baud.
const ROOM: usize = 96;

/// Largest step of the robot's clock per turn: one tick of its brain. If the machine stalls or is too slow, the robot's time
/// lags behind the ports', so its lease does not run out while the host's bytes are unread.
const LONGEST_STEP: Duration = Duration::from_millis(20);

/// Runs on the ports' clock until `go_on` returns false; it is called every few milliseconds. Bytes from any port reach the
/// robot; its output goes to all of them.
///
/// The robot's clock follows that of the first port, from its present time, but never makes up for delays. Without ports the
/// function returns at once.
///
/// # Errors
/// A permanent failure of a port or the robot. Clients may come and go.
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
    mut go_on: impl FnMut(&mut R) -> bool,
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
