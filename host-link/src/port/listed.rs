//! Which serial ports the system has, so that an operator with one robot need not know the name of its port.

use std::fmt;

use serialport::SerialPortType;

/// A serial port that the system lists, and what it says is behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedPort {
    /// What to open.
    pub path: String,
    /// What is behind it: a Bluetooth link, a USB device by name; empty where the system does not say, as for the ports
    /// on a computer's own board.
    pub about: String,
}

impl fmt::Display for ListedPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.path)?;
        if self.about.is_empty() {
            return Ok(());
        }
        write!(f, " ({})", self.about)
    }
}

/// The serial ports of this system in the order of their names; none where it cannot tell.
pub fn serial_ports() -> Vec<ListedPort> {
    // The listing takes this folder for granted, and a container may have none.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    let mut ports: Vec<ListedPort> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        // On macOS each port has two names; this one waits for a carrier that no robot gives.
        .filter(|port| !port.port_name.starts_with("/dev/tty."))
        .map(|port| ListedPort {
            path: port.port_name,
            about: about(port.port_type),
        })
        .collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    ports
}

fn about(kind: SerialPortType) -> String {
    match kind {
        SerialPortType::UsbPort(usb) => usb
            .product
            .or(usb.manufacturer)
            .unwrap_or_else(|| format!("USB {:04x}:{:04x}", usb.vid, usb.pid)),
        SerialPortType::BluetoothPort => "Bluetooth".to_owned(),
        SerialPortType::PciPort | SerialPortType::Unknown => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::UsbPortInfo;

    #[test]
    fn a_port_is_told_by_what_is_behind_it() {
        let usb = |product: Option<&str>| {
            about(SerialPortType::UsbPort(UsbPortInfo {
                vid: 0x2341,
                pid: 0x5e,
                serial_number: None,
                manufacturer: None,
                product: product.map(str::to_owned),
            }))
        };
        assert_eq!(usb(Some("Nano RP2040")), "Nano RP2040");
        assert_eq!(usb(None), "USB 2341:005e");
        let listed = ListedPort {
            path: "/dev/rfcomm0".into(),
            about: about(SerialPortType::BluetoothPort),
        };
        assert_eq!(listed.to_string(), "/dev/rfcomm0 (Bluetooth)");
    }

    #[test]
    fn listing_never_fails() {
        let ports = serial_ports();
        assert!(ports.windows(2).all(|pair| pair[0].path <= pair[1].path));
    }
}
