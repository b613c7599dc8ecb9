//! Prints the status of a robot: `cargo run -p host-link --example robot_status -- /dev/rfcomm0`, or `-- 127.0.0.1:4000` for a
//! twin (`swimmer twin --tcp 127.0.0.1:4000`).

use std::error::Error;

use host_link::port::{Port, SerialPort, TcpPort};
use host_link::{LinkError, Robot};

fn main() -> Result<(), Box<dyn Error>> {
    let place = std::env::args()
        .nth(1)
        .ok_or("name a serial port or HOST:PORT")?;
    if place.contains(':') {
        report(TcpPort::connect(place.as_str())?)?;
    } else {
        report(SerialPort::open(&place, 115_200)?)?;
    }
    Ok(())
}

fn report(port: impl Port) -> Result<(), LinkError> {
    let mut robot = Robot::connect(port, 1)?;
    let status = robot.status()?;
    println!(
        "firmware {}, board {:?}",
        robot.firmware(),
        robot.info().board
    );
    println!(
        "{:?} since {:?}, battery {:?} mV",
        status.state, status.cause, status.battery_mv
    );
    Ok(())
}
