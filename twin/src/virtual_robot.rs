//! What every robot in a virtual tank is, whatever carries its brain: who serves, records or plays one need not know which.

use host_link::port::Device;

use crate::World;

/// A device in virtual time with servos, tank and cameras around it. Its clock is its world's.
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
