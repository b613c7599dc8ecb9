//! Parameters of a fit: r_s, χ, and the nuisance parameters.

use swimmer_model::{Link, Swimmer};

/// One number that is fitted, in units of order one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parameter {
    /// r_s/L.
    SphereRadius,
    /// ln χ.
    Chi,
    /// ln of c_t/μ over the files' one.
    TangentialDrag,
    /// Offset of the front joint \[rad\].
    FrontOffset,
    /// Offset of the back joint \[rad\].
    BackOffset,
    /// The servos' dead band \[rad\].
    DeadBand,
    /// The front servo's dead band less the back one's \[rad\]; their mean is [`Self::DeadBand`] or the swimmer file's.
    DeadBandDifference,
    /// By how much the front joint is later than the back one \[s\].
    FrontLag,
    /// Place of the reflectors' middle along the middle link, over L.
    MarkerAlong,
    /// The same across it.
    MarkerAcross,
    /// By how much the reflectors' line is turned against the link \[rad\].
    MarkerAngle,
    /// Angle of the front joint less the angle of its link's reflector \[rad\].
    FrontLink,
    /// The same of the back joint.
    BackLink,
    /// Gain of both servos (angle per commanded angle), less 1.
    Gain,
    /// The same of the front servo alone.
    FrontGain,
    /// The same of the back servo alone.
    BackGain,
    /// Lengths as the cameras give them over true ones, less 1.
    Scale,
    /// The period over the commanded one, less 1.
    Period,
    /// Length of the middle link over that of the swimmer file, less it, over L.
    MiddleLength,
    /// The same of the front link.
    FrontLength,
    /// The same of the back link.
    BackLength,
    /// ln of the float's rotational drag over that of a sphere with its drag against translation.
    FloatTurning,
    /// Stretch of the cameras' view along its x, which is lost along y: tilted cameras, pixels that are not square.
    StretchSquare,
    /// The same along the diagonal.
    StretchDiagonal,
    /// Distortion of the lens: stretch at the runs' mean distance from their centre.
    Distortion,
    /// Effect of the tank's walls over that of first order.
    WallEffect,
}

impl Parameter {
    /// Least and largest value, as the fit takes it.
    pub(crate) fn bounds(self, swimmer: &Swimmer<f64>) -> (f64, f64) {
        let reach = swimmer.links.middle / swimmer.total_length();
        match self {
            Self::SphereRadius => (0.0, 1.0),
            Self::Chi => (0.05_f64.ln(), 50_f64.ln()),
            Self::TangentialDrag => (-(20_f64.ln()), 20_f64.ln()),
            Self::FrontOffset
            | Self::BackOffset
            | Self::MarkerAngle
            | Self::FrontLink
            | Self::BackLink
            | Self::DeadBandDifference => (-0.35, 0.35),
            Self::Gain
            | Self::FrontGain
            | Self::BackGain
            | Self::Scale
            | Self::Period
            | Self::Distortion => (-0.3, 0.3),
            Self::MiddleLength | Self::FrontLength | Self::BackLength => (-0.05, 0.05),
            Self::FloatTurning => (-(10_f64.ln()), 10_f64.ln()),
            Self::StretchSquare | Self::StretchDiagonal => (-0.1, 0.1),
            Self::WallEffect => (-5.0, 5.0),
            Self::DeadBand => (0.0, 0.35),
            Self::FrontLag => (-1.0, 1.0),
            Self::MarkerAlong | Self::MarkerAcross => (-reach, reach),
        }
    }

    /// Returns `true` if the parameter moves the joints off the gait.
    pub(crate) fn moves_joints(self) -> bool {
        matches!(
            self,
            Self::FrontOffset | Self::BackOffset | Self::Gain | Self::FrontGain | Self::BackGain
        )
    }

    /// Returns `true` for the servos' response, which has no effect if the angles were measured.
    pub(crate) fn is_of_command(self) -> bool {
        self.moves_joints()
            || matches!(
                self,
                Self::DeadBand | Self::DeadBandDifference | Self::Period | Self::FrontLag
            )
    }

    /// Returns `true` for the measurement of angles, which has no effect without measured angles.
    pub(crate) fn is_of_side_links(self) -> bool {
        matches!(self, Self::FrontLink | Self::BackLink)
    }

    /// Returns `true` for the view of the cameras, which depends on each run's direction and place.
    pub(crate) fn is_of_view(self) -> bool {
        matches!(
            self,
            Self::StretchSquare | Self::StretchDiagonal | Self::Distortion
        )
    }

    /// Half a difference's width. Paths have kinks in the dead band.
    pub(crate) fn step(self) -> f64 {
        match self {
            Self::DeadBand => 4e-3,
            Self::DeadBandDifference => 8e-3,
            _ => 1e-3,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::SphereRadius => "r_s",
            Self::Chi => "chi",
            Self::TangentialDrag => "c_t/mu",
            Self::FrontOffset => "front joint offset",
            Self::BackOffset => "back joint offset",
            Self::DeadBand => "dead band",
            Self::DeadBandDifference => "dead band difference, front less back",
            Self::FrontLag => "lag of the front joint behind the back one",
            Self::MarkerAlong => "marker offset along",
            Self::MarkerAcross => "marker offset across",
            Self::MarkerAngle => "marker angle",
            Self::FrontLink => "front link reflector",
            Self::BackLink => "back link reflector",
            Self::Gain => "gain",
            Self::FrontGain => "front gain",
            Self::BackGain => "back gain",
            Self::Scale => "camera scale",
            Self::Period => "period",
            Self::MiddleLength => "middle link length",
            Self::FrontLength => "front link length",
            Self::BackLength => "back link length",
            Self::FloatTurning => "float's rotational drag",
            Self::StretchSquare => "camera stretch along x",
            Self::StretchDiagonal => "camera stretch diagonal",
            Self::Distortion => "lens distortion",
            Self::WallEffect => "wall effect",
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::SphereRadius
            | Self::MarkerAlong
            | Self::MarkerAcross
            | Self::MiddleLength
            | Self::FrontLength
            | Self::BackLength => "m",
            Self::FrontOffset
            | Self::BackOffset
            | Self::DeadBand
            | Self::DeadBandDifference
            | Self::MarkerAngle
            | Self::FrontLink
            | Self::BackLink => "rad",
            Self::FrontLag => "s",
            _ => "",
        }
    }

    /// In units of people: m, rad, or the plain number.
    pub(crate) fn natural(self, value: f64, swimmer: &Swimmer<f64>) -> f64 {
        match self {
            Self::SphereRadius
            | Self::MarkerAlong
            | Self::MarkerAcross
            | Self::MiddleLength
            | Self::FrontLength
            | Self::BackLength => value * swimmer.total_length(),
            Self::Chi | Self::FloatTurning => value.exp(),
            Self::TangentialDrag => over_viscosity(swimmer) * value.exp(),
            Self::Gain
            | Self::FrontGain
            | Self::BackGain
            | Self::Scale
            | Self::Period
            | Self::StretchSquare
            | Self::StretchDiagonal
            | Self::Distortion => 1.0 + value,
            Self::FrontOffset
            | Self::BackOffset
            | Self::DeadBand
            | Self::DeadBandDifference
            | Self::MarkerAngle
            | Self::FrontLink
            | Self::BackLink
            | Self::FrontLag
            | Self::WallEffect => value,
        }
    }
}

/// c_t/μ of the side links.
pub(crate) fn over_viscosity(swimmer: &Swimmer<f64>) -> f64 {
    swimmer.tangential_drag_of(Link::Front)
}
