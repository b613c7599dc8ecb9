//! Test support: ports in memory, and links with faults that a seed reproduces.
//!
//! Not needed for a real link. Programs that put a virtual robot behind a faulty link (`swimmer twin --faults`) enable the
//! feature `testing`.
//!
//! ```
//! use std::time::Duration;
//! use host_link::Port as _;
//! use host_link::testing::{FaultPlan, FaultyPort, MockPort};
//!
//! let (near, mut far) = MockPort::pair();
//! let mut port = FaultyPort::new(near, FaultPlan::at_host("delay=30".parse()?), 1);
//! far.write(&[5, 0]).unwrap();
//! assert_eq!(port.read(&mut [0; 16], Duration::from_secs(1)).unwrap(), 2);
//! assert_eq!(port.now(), Duration::from_millis(30));
//! # Ok::<(), host_link::testing::FaultsError>(())
//! ```

mod baud;
mod faults;
mod faulty;
mod injector;
mod mock;

pub use baud::{Character, heard};
pub use faults::{Faults, FaultsError, FaultsProblem, Outage};
pub use faulty::{FaultPlan, FaultyPort};
pub use injector::{FaultCounts, FaultInjector};
pub use mock::MockPort;
