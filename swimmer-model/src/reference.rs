//! Reference problems with values and tolerances, shared by the tests and benches of all crates.
//!
//! Values were computed in two independent ways; tolerances are half a unit of the last digit kept.

/// A(Φ) and W(Φ) of Purcell's swimmer (l = 1, 1, 1, χ = 2, c_t/μ = 1) at one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeCase {
    /// (φ₁, φ₂) \[rad\].
    pub phi: [f64; 2],
    /// A, rows x, y, θ.
    pub connection: [[f64; 2]; 3],
    /// (W₁₁, W₁₂, W₂₂).
    pub power: [f64; 3],
}

/// Half a unit in the last digit of [`SHAPES`].
pub const SHAPES_TOLERANCE: f64 = 5e-7;

/// Four shapes of Purcell's swimmer.
pub const SHAPES: [ShapeCase; 4] = [
    ShapeCase {
        phi: [0.5, -0.3],
        connection: [
            [0.092_985, 0.077_454],
            [-0.149_731, -0.151_491],
            [-0.259_598, 0.268_328],
        ],
        power: [0.203_711, 0.126_545, 0.191_995],
    },
    ShapeCase {
        phi: [1.2, 0.7],
        connection: [
            [0.128_795, -0.012_972],
            [-0.107_664, -0.123_586],
            [-0.199_351, 0.285_965],
        ],
        power: [0.338_593, 0.209_762, 0.263_784],
    },
    ShapeCase {
        phi: [-0.9, 2.1],
        connection: [
            [-0.145_393, -0.214_942],
            [-0.032_719, 0.063_733],
            [-0.387_777, 0.184_558],
        ],
        power: [0.153_397, 0.051_648, 0.372_500],
    },
    ShapeCase {
        phi: [2.5, -2.2],
        connection: [
            [0.135_801, 0.158_156],
            [0.130_256, 0.092_926],
            [-0.334_049, 0.402_311],
        ],
        power: [0.392_151, -0.062_046, 0.334_284],
    },
];

/// A gait of Purcell's swimmer whose displacement is stationary in its amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestAmplitude {
    /// Amplitude \[rad\].
    pub amplitude: f64,
    /// Error bound of the amplitude.
    pub amplitude_tolerance: f64,
    /// X/L there.
    pub displacement_over_length: f64,
    /// Error bound of X/L.
    pub displacement_tolerance: f64,
}

/// Circle with the greatest forward displacement.
pub const BEST_CIRCLE: BestAmplitude = BestAmplitude {
    amplitude: 1.633_162_5,
    amplitude_tolerance: 5e-8,
    displacement_over_length: 0.082_285_393_1,
    displacement_tolerance: 1e-10,
};

/// Circle with the greatest backward displacement.
pub const SECOND_CIRCLE: BestAmplitude = BestAmplitude {
    amplitude: 3.647_415,
    amplitude_tolerance: 5e-7,
    displacement_over_length: -0.214_965_8,
    displacement_tolerance: 5e-8,
};

/// Square with the greatest forward displacement.
pub const BEST_SQUARE: BestAmplitude = BestAmplitude {
    amplitude: 1.390_607_7,
    amplitude_tolerance: 5e-8,
    displacement_over_length: 0.078_260_826_4,
    displacement_tolerance: 5e-11,
};
