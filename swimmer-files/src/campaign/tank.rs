//! Walls of the tank: `tank = { size = [1.4, 1.0], centre = [0.0, 0.0] }` or `{ radius = 0.6, centre = … }` under `[known]`, in the
//! tracks' coordinates.

use serde::Deserialize;

/// Vertical walls around the runs, in the tracks' coordinates \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TankWalls {
    /// `size`: lengths along x and y.
    Box {
        /// Along x and along y.
        size: [f64; 2],
        /// Place of the centre.
        centre: [f64; 2],
    },
    /// `radius`.
    Round {
        /// Inner radius.
        radius: f64,
        /// Place of the centre.
        centre: [f64; 2],
    },
}

/// Plane wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallPlane {
    /// Unit vector from the wall into the fluid.
    pub normal: [f64; 2],
    /// Distance of the origin from the wall, positive in the fluid, with the sign changed.
    pub offset: f64,
}

impl WallPlane {
    /// Distance of a place from the wall \[m\], negative beyond it.
    pub fn distance(&self, at: [f64; 2]) -> f64 {
        self.normal[0] * at[0] + self.normal[1] * at[1] - self.offset
    }
}

impl TankWalls {
    /// Four planes that face a body at this place: the walls of a box, or tangents of a round wall along and across the body's
    /// direction from the centre.
    ///
    /// ```
    /// use swimmer_files::TankWalls;
    ///
    /// let tank = TankWalls::Round { radius: 0.5, centre: [0.1, 0.0] };
    /// let at = [0.4, 0.0];
    /// let mut distances = tank.planes(at).map(|plane| plane.distance(at));
    /// distances.sort_by(f64::total_cmp);
    /// assert!((distances[0] - 0.2).abs() < 1e-12 && (distances[3] - 0.8).abs() < 1e-12);
    /// ```
    pub fn planes(&self, at: [f64; 2]) -> [WallPlane; 4] {
        let (along, centre, reach) = match *self {
            Self::Box { size, centre } => ([1.0, 0.0], centre, size.map(|size| 0.5 * size)),
            Self::Round { radius, centre } => {
                let away = [at[0] - centre[0], at[1] - centre[1]];
                let distance = away[0].hypot(away[1]);
                let along = if distance > 0.0 {
                    away.map(|value| value / distance)
                } else {
                    [1.0, 0.0]
                };
                (along, centre, [radius; 2])
            }
        };
        let across = [-along[1], along[0]];
        let plane = |normal: [f64; 2], reach: f64| WallPlane {
            normal,
            offset: normal[0] * centre[0] + normal[1] * centre[1] - reach,
        };
        [
            plane(along, reach[0]),
            plane(along.map(|value| -value), reach[0]),
            plane(across, reach[1]),
            plane(across.map(|value| -value), reach[1]),
        ]
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawTank {
    size: Option<[f64; 2]>,
    radius: Option<f64>,
    #[serde(default)]
    centre: [f64; 2],
}

/// The walls of a table.
///
/// # Errors
/// A message for people, if the table has no size or an impossible one.
pub(super) fn tank(raw: &RawTank) -> Result<TankWalls, String> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let centre = raw.centre;
    if !centre.iter().all(|value| value.is_finite()) {
        return Err(format!(
            "tank: centre = {centre:?} must be two finite lengths in metres"
        ));
    }
    let walls = match (raw.size, raw.radius) {
        (Some(size), None) if size.into_iter().all(positive) => TankWalls::Box { size, centre },
        (None, Some(radius)) if positive(radius) => TankWalls::Round { radius, centre },
        _ => {
            return Err(
                "tank: write its inner measures in metres, { size = [1.4, 1.0] } or { radius = 0.6 }, with centre = [x, y] in the \
                 tracks' coordinates"
                    .to_owned(),
            );
        }
    };
    let lengths = [
        raw.size.unwrap_or_default().as_slice(),
        raw.radius.as_slice(),
    ]
    .concat();
    for value in lengths {
        let slip = crate::Quantity::Length.checked(value).err();
        if let Some(slip) = slip {
            return Err(format!("tank: {slip}"));
        }
    }
    Ok(walls)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tank_has_one_size() {
        let raw = |size, radius| RawTank {
            size,
            radius,
            centre: [0.0; 2],
        };
        assert!(tank(&raw(Some([1.4, 1.0]), None)).is_ok());
        assert!(tank(&raw(None, Some(0.6))).is_ok());
        for bad in [
            raw(None, None),
            raw(Some([1.4, 1.0]), Some(0.6)),
            raw(Some([1.4, -1.0]), None),
            raw(None, Some(f64::NAN)),
            raw(Some([1400.0, 1000.0]), None),
        ] {
            assert!(tank(&bad).is_err());
        }
    }
}
