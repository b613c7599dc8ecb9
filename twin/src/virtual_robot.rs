//! Interface of every robot in a virtual tank, independent of the implementation of its brain.

use host_link::port::Device;

use crate::World;

/// Device in virtual time with servos, tank and cameras. Its clock is its world's.
pub trait VirtualRobot: Device {
    /// Servos, tank and cameras.
    fn world(&self) -> &World;

    /// Servos, tank and cameras.
    fn world_mut(&mut self) -> &mut World;
}

impl<R: VirtualRobot + ?Sized> VirtualRobot for Box<R> {
    fn world(&self) -> &World {
        (**self).world()
    }

    fn world_mut(&mut self) -> &mut World {
        (**self).world_mut()
    }
}
