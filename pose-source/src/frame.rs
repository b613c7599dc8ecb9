//! One frame of the cameras.

/// One frame of the cameras, in the tank's axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// Time on the camera clock \[s\]: mid-exposure if the source states it.
    pub stamp_s: f64,
    /// Time of reception on the host clock \[s\], from when the source was opened.
    pub received_s: f64,
    /// Delay between exposure and transmission \[s\]; `None` if the source does not state it.
    pub latency_s: Option<f64>,
    /// Measured points. A point that is blank in this frame is not listed.
    pub markers: Vec<Marker>,
    /// Rigid bodies that the source tracks in this frame.
    pub bodies: Vec<RigidBody>,
}

/// A measured point.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// Its name; `None` for an unlabeled point.
    pub name: Option<String>,
    /// Its number at the source. A marker that was lost may come back with another one.
    pub id: Option<i64>,
    /// Position in the tank \[m\].
    pub x_m: f64,
    /// Position in the tank \[m\].
    pub y_m: f64,
    /// Height \[m\].
    pub z_m: f64,
}

/// A rigid body as the source solved it.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its number at the source.
    pub id: i64,
    /// Its name; `None` until the source has described it.
    pub name: Option<String>,
    /// Position of its pivot \[m\]: x, y and height.
    pub position: [f64; 3],
    /// Orientation, a unit quaternion (x, y, z, w).
    pub quaternion: [f64; 4],
}

impl Marker {
    /// Position \[m\]: x, y and height.
    pub fn position(&self) -> [f64; 3] {
        [self.x_m, self.y_m, self.z_m]
    }
}

impl RigidBody {
    /// Angle about the vertical \[rad\], counter-clockwise from above.
    ///
    /// ```
    /// use pose_source::RigidBody;
    ///
    /// let half = 0.35_f64;
    /// let quaternion = [0.0, 0.0, half.sin(), half.cos()];
    /// let body = RigidBody { id: 1, name: None, position: [0.0; 3], quaternion };
    /// assert!((body.heading_rad() - 0.7).abs() < 1e-12);
    /// ```
    pub fn heading_rad(&self) -> f64 {
        let [x, y, z, w] = self.quaternion;
        (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z))
    }
}

impl Frame {
    /// Markers whose name is this one.
    pub fn marker(&self, name: &str) -> Option<&Marker> {
        self.markers
            .iter()
            .find(|marker| marker.name.as_deref() == Some(name))
    }
}
