//! List of the serial ports, so that an operator with one robot need not know its port.

use std::fmt;

use serialport::SerialPortType;

/// Serial port, with the system's description of its device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedPort {
    /// Path to open.
    pub path: String,
    /// Description of the device: a Bluetooth link, or the name of a USB device. Empty if unknown, as for on-board ports.
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

/// Serial ports of this system, sorted by name; empty if the system provides no list.
pub fn serial_ports() -> Vec<ListedPort> {
    // The listing requires this folder, which a container may lack.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    let mut ports: Vec<ListedPort> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        // On macOS each port has two names; this one waits for a carrier signal, which the robot does not provide.
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
