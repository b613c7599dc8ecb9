//! All conditions of certificates: meaning, key in outputs and tolerance, defined once each.

use swimmer_files::GaitFile;

use super::{Check, Dependence};

/// Conditions with their meaning, key and tolerance: an upper bound (`<=`) or a lower bound (`>=`) of the value.
macro_rules! conditions {
    ($($(#[$says:meta])+ $name:ident: $key:literal $side:tt $tolerance:expr;)+) => {
        /// A condition of an optimum, or of what its numbers rest on.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Condition {
            $($(#[$says])+ $name,)+
        }

        impl Condition {
            /// Its name in answers; conditions of different objectives may share one.
            pub fn key(self) -> &'static str {
                match self {
                    $(Self::$name => $key,)+
                }
            }

            /// Limit of its value if the samples add no uncertainty.
            pub(crate) fn tolerance(self) -> f64 {
                match self {
                    $(Self::$name => $tolerance,)+
                }
            }

            /// `true` if the value must be at least the tolerance instead of at most.
            pub fn is_from_below(self) -> bool {
                match self {
                    $(Self::$name => conditions!(@ $side),)+
                }
            }
        }
    };
    (@ <=) => { false };
    (@ >=) => { true };
}

conditions! {
    // The curve.
    /// The first and the last sample are the same \[rad\].
    Closed: "open_rad" <= GaitFile::CLOSURE;
    /// It turns round once.
    TurnsOnce: "turning_number_off_one" <= 1e-9;
    /// It does not cross itself; if the gait may touch its own images, a quarter is tested.
    Simple: "self_crossings" <= 0.0;
    /// It has the paper's two symmetries, which the bounds of a quarter require.
    PapersSymmetries: "without_the_papers_symmetries" <= 0.0;
    /// It keeps its bounds \[rad\].
    KeepsBounds: "bound_overstepped_rad" <= 1e-9;
    /// No side link folds through the middle one.
    NothingFolded: "side_link_on_middle_link" <= 0.0;
    /// Arcs along straight bounds lie on them \[rad\].
    OnBound: "arc_off_its_bound_rad" <= 1e-9;
    /// Arcs along the links' clearance lie on it \[rad\]; solvers keep a hair off the corner where tip meets tip, at which that bound
    /// has no tangent.
    OnClearance: "arc_off_clearance_rad" <= 1e-7;
    /// Polynomials of two degrees through the samples have the same slopes, relatively.
    SlopesKnown: "sampling_slope_error" <= 1e-5;
    /// The same of the poses, over L and in radians.
    PosesKnown: "sampling_pose_error" <= 1e-5;

    // Gain.
    /// The objective is clearly positive.
    Gains: "gain_least" >= 1e-6;
    /// The displacement, integrated in another way, over L.
    DisplacementSwumAgain: "displacement_swum_again" <= super::SWUM_AGAIN;
    /// The displacement, step by step from sample to sample, over L.
    DisplacementSteppedAgain: "displacement_stepped_again" <= super::SWUM_AGAIN;
    /// The rotation, step by step from sample to sample \[rad\].
    RotationSteppedAgain: "rotation_stepped_again" <= super::SWUM_AGAIN;
    /// The efficiency of the samples is that of the arcs, relatively.
    EfficiencySwumAgain: "efficiency_swum_again" <= 1e-7;
    /// A gait with the paper's symmetries goes nowhere across its heading, over L.
    NoLateral: "net_lateral" <= 1e-8;
    /// It does not turn the swimmer \[rad\].
    NoRotation: "net_rotation_rad" <= 1e-8;
    /// It turns no swimmer of an ensemble \[rad\].
    NobodyTurns: "largest_rotation_rad" <= 1e-8;

    // Displacement, turning, sideways: the height is what a push of the curve gains.
    /// Free arcs lie on the zero of the height \[rad\].
    OnZeroHeight: "off_singular_condition_rad" <= 1e-8;
    /// A bound is left where the height vanishes \[rad\].
    LeavesAtZero: "off_exit_condition_rad" <= 1e-8;
    /// The height grows to the left of free arcs (generalised Legendre–Clebsch).
    GrowsInwards: "legendre_clebsch_least" >= 1e-6;
    /// Costates integrated along free arcs keep `H_u = 0`.
    Stationary: "h_u" <= 1e-8;
    /// H keeps its value with them.
    HamiltonianZero: "hamiltonian" <= 1e-8;
    /// The height pushes against bounds.
    HeightOnBound: "bound_multiplier_least" >= -1e-9;
    /// No other first sample has more displacement across its heading, over L.
    NoBetterStart: "other_start_better" <= 1e-8;
    /// Number of perturbations of the curve that gain to second order; for a gait with the paper's symmetries, of those that keep
    /// them.
    NoAscent: "ascent_directions" <= 0.0;
    /// The same with pushes of any symmetry.
    NoAscentWithoutSymmetry: "ascent_directions_without_symmetry" <= 0.0;

    // A quarter that a search traced (paper, section IV).
    /// λ₄ at the end.
    FinalLambda4: "final_lambda4" <= 1e-9;
    /// Its displacement is that of the samples, over L.
    ArcsSwumAgain: "arcs_swum_again" <= super::SWUM_AGAIN;

    // Efficiency.
    /// The power is constant: (max − min) over the square of ∮√P.
    ConstantPower: "power_variation" <= 1e-7;
    /// No corners but those of the forbidden shapes \[rad\].
    NoCorner: "corner_rad" <= 1e-7;
    /// The symmetry lines are crossed square \[rad\].
    EndsSquare: "ends_not_square_rad" <= 1e-7;
    /// Legendre's condition: the power matrix is definite.
    Legendre: "legendre_least" >= 1e-12;
    /// The costate equations along free arcs, over the largest costate.
    CostateBalance: "h_u" <= 1e-8;
    /// H along free arcs, over itself.
    HamiltonianConstant: "hamiltonian_variation" <= 1e-7;
    /// Least multiplier of a bound, over the largest costate.
    EffortOnBound: "bound_multiplier_least" >= -1e-7;
    /// Residual of the shooting equations: angles in rad, momenta over |p|.
    ShootingResidual: "shooting_residual" <= 1e-10;
    /// p is parallel to the displacement: the sine between them.
    MomentumAlongDisplacement: "displacement_off_momentum" <= 1e-7;
    /// |p| |d| = ∮√P, relatively.
    MomentumScale: "momentum_off_scale" <= 1e-7;
    /// A closed curve polished without its symmetry has the efficiency of its quarter, relatively.
    SameAsQuarter: "closed_curve_off_quarter" <= 1e-8;

    // Robust gaits.
    /// The weighted height on free arcs.
    RobustHeight: "robust_height" <= 1e-8;
    /// It grows to their left.
    RobustGrowsInwards: "robust_legendre_clebsch_least" >= 1e-6;
    /// It pushes against bounds.
    RobustOnBound: "robust_bound_multiplier_least" >= -1e-9;
    /// The weighted gradient of a series.
    RobustGradient: "robust_gradient" <= 1e-8;
    /// The largest curvature of the weighted objective of a series.
    RobustCurvature: "robust_curvature" <= 0.0;
    /// Objective at the estimates, by the model's own integration, relative difference.
    NominalSwumAgain: "nominal_swum_again" <= 1e-8;
    /// The same of the worst case, looked for again.
    WorstSwumAgain: "worst_swum_again" <= 1e-8;
    /// The same of the mean.
    MeanSwumAgain: "mean_swum_again" <= 1e-8;
    /// No swimmer that holds the worst case pulls the other way.
    WorstCaseMultiplier: "worst_case_multiplier_least" >= 0.0;
    /// Members that define the worst case have the value of the worst case, relatively.
    WorstCaseHeld: "worst_case_held_apart" <= 1e-8;

    // Speed. Numbers are over the speed, or a share of a switch-to-switch integral.
    /// It moves.
    Moves: "moves_nowhere" <= 0.0;
    /// It passes the shape at which gaits join \[rad\].
    PassesJoint: "off_the_joint_shape_rad" <= 1e-9;
    /// A servo runs at its full rate, relatively.
    FullRate: "off_full_rate" <= 1e-6;
    /// Angle between displacement and the required direction \[rad\].
    Heading: "off_heading_rad" <= 1e-8;
    /// The integrals of the height between switches.
    SwitchIntegrals: "switch_to_switch_integrals" <= 1e-6;
    /// No two servos switch at once.
    SingleSwitches: "double_switches" <= 0.0;
    /// Switching functions keep their signs.
    SwitchingSigns: "switching_function_least" >= -1e-6;
    /// The height on singular arcs.
    HeightOnSingular: "height_on_singular_arcs" <= 1e-5;
    /// A bound pushes back.
    SpeedOnBound: "bound_multiplier_least" >= -1e-6;
    /// And so does a bound that a corner touches.
    SpeedAtContact: "contact_multiplier_least" >= -1e-6;
    /// A longer period leads no less far.
    FurtherTime: "speed_of_further_time_least" >= -1e-6;
    /// No shift of the corners gains to second order.
    NoBetterCorners: "second_variation_least" >= 0.0;
    /// It has enough arcs for the test.
    EnoughArcs: "arcs_least" >= 3.0;
}

impl Condition {
    /// Checks a value against the tolerance. NaN fails.
    pub(crate) fn check(self, value: f64) -> Check {
        self.open(value, 0.0)
    }

    /// The same, where this much more is open.
    pub(crate) fn open(self, value: f64, open: f64) -> Check {
        let open = if self.is_from_below() { -open } else { open };
        self.within(value, self.tolerance() + open)
    }

    /// Checks a value against a tolerance of the caller.
    pub(crate) fn within(self, value: f64, tolerance: f64) -> Check {
        let pass = if self.is_from_below() {
            value >= tolerance
        } else {
            value <= tolerance
        };
        Check {
            condition: self,
            value,
            tolerance,
            pass,
            uncertainty: 0.0,
            depends_on: Dependence::Curve,
        }
    }
}

/// Serialises as the key of the condition.
impl serde::Serialize for Condition {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}
