// What `swimmer-model` offers, without bodies and documentation: written by `cargo xtask api`, not by hand, and never compiled.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle<T> {
    pub amplitude: T,
}
impl<T: Scalar> Gait<T> for Circle<T> {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingShare<T> {
    pub of_cycle: T,
    pub of_length: T,
    pub folds: bool,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstDerivatives<T> {
    pub connection: Matrix3x2<T>,
    pub power: Matrix2<T>,
    pub d_connection: [Matrix3x2<T>; 2],
    pub d_power: [Matrix2<T>; 2],
}
impl<T: Scalar> FirstDerivatives<T> {
    pub fn curvature(&self) -> Vector3<T> {}
}
impl<T: Scalar> FirstDerivatives<T> {
    pub fn at_heading(&self, theta: T) -> FullFirstDerivatives<T> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fourier<T, C> {
    pub mean: Vector2<T>,
    pub harmonics: C,
}
impl<T: Scalar, C: AsRef<[Harmonic<T>]>> Gait<T> for Fourier<T, C> {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullFirstDerivatives<T> {
    pub connection: Matrix3x2<T>,
    pub d_phi: [Matrix3x2<T>; 2],
    pub d_theta: Matrix3x2<T>,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullSecondDerivatives<T> {
    pub first: FullFirstDerivatives<T>,
    pub d2_phi: [Matrix3x2<T>; 3],
    pub d_phi_d_theta: [Matrix3x2<T>; 2],
    pub d2_theta: Matrix3x2<T>,
}
pub trait Gait<T: Scalar> {
    fn at(&self, u: T) -> GaitPoint<T>;
    fn pieces(&self) -> usize {}
    fn piece_end(&self, _i: usize) -> T {}
    fn corner_at_end(&self, _i: usize) -> bool {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaitPoint<T> {
    pub phi: Vector2<T>,
    pub rate: Vector2<T>,
}
impl<T: Scalar> GaitPoint<T> {
    pub fn speed(&self) -> T {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic<T> {
    pub cos: Vector2<T>,
    pub sin: Vector2<T>,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidSamples {
    TooFew { knots: usize },
    Lengths { u: usize, phi: usize },
    Start { u: f64 },
    Order { knot: usize, u: f64 },
    Angle { knot: usize },
    Open { gap: f64 },
    Corner { corner: usize },
}
impl fmt::Display for InvalidSamples {}
impl core::error::Error for InvalidSamples {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidSwimmer {
    NotPositive { name: &'static str, value: f64 },
    SphereRadius { value: f64 },
    TooThick { half_thickness: f64, shortest: f64 },
}
impl fmt::Display for InvalidSwimmer {}
impl core::error::Error for InvalidSwimmer {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkForce<T> {
    pub ends: [Vector2<T>; 2],
    pub density: [Vector2<T>; 2],
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links<T> {
    pub middle: T,
    pub front: T,
    pub back: T,
}
impl<T: Scalar> Links<T> {
    pub fn overlap(&self, phi: &Vector2<T>) -> T {}
    pub fn cross(&self, phi: &Vector2<T>) -> bool {}
}
impl<T: Scalar> Links<T> {
    pub fn outline(&self, phi: &Vector2<T>) -> [Vector2<T>; 4] {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model<T> {}
impl<T: Scalar> Model<T> {
    pub fn links_cross(&self, phi: &Vector2<T>) -> bool {}
}
impl<T: Scalar> Model<T> {
    pub fn link_forces(&self, phi: &Vector2<T>, rate: &Vector2<T>) -> [LinkForce<T>; 3] {}
}
impl<T: Scalar> Model<T> {
    pub fn full_connection(&self, phi: &Vector2<T>, theta: T) -> Matrix3x2<T> {}
}
impl<T: Scalar> Model<T> {
    pub fn new(swimmer: &Swimmer<T>) -> Result<Self, InvalidSwimmer> {}
    pub fn swimmer(&self) -> &Swimmer<T> {}
    pub fn side_drag(&self) -> T {}
    pub fn local_connection(&self, phi: &Vector2<T>) -> Matrix3x2<T> {}
    pub fn power_matrix(&self, phi: &Vector2<T>) -> Matrix2<T> {}
    pub fn connection_and_power(&self, phi: &Vector2<T>) -> (Matrix3x2<T>, Matrix2<T>) {}
    pub fn first_derivatives(&self, phi: &Vector2<T>) -> FirstDerivatives<T> {}
    pub fn second_derivatives(&self, phi: &Vector2<T>) -> SecondDerivatives<T> {}
    pub fn connection_and_power_at(
        &self,
        turns: [(T, T); 2],
    ) -> (Matrix3x2<T>, Matrix2<T>) {}
    pub fn first_derivatives_at(&self, turns: [(T, T); 2]) -> FirstDerivatives<T> {}
    pub fn second_derivatives_at(&self, turns: [(T, T); 2]) -> SecondDerivatives<T> {}
    pub fn weighed_curvature(
        &self,
        phi: &Vector2<T>,
        covector: &Vector3<T>,
    ) -> WeighedCurvature<T> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel<T> {}
impl<T: Scalar> Panel<T> {
    pub fn start(&self) -> T {}
    pub fn end(&self) -> T {}
    pub fn start_pose(&self) -> Pose<T> {}
    pub fn end_pose(&self) -> Pose<T> {}
    pub fn pose(&self, u: T) -> Pose<T> {}
    pub fn rate(&self, u: T) -> Vector3<T> {}
    pub fn energy(&self) -> T {}
    pub fn energy_until(&self, u: T) -> T {}
    pub fn power_length(&self) -> T {}
    pub fn power_length_until(&self, u: T) -> T {}
}
#[derive(Debug)]
pub struct Panels<'a, T, G: ?Sized> {}
impl<'a, T: Scalar, G: Gait<T> + ?Sized> Panels<'a, T, G> {
    pub fn new(model: &'a Model<T>, gait: &'a G, tolerance: &Tolerance) -> Self {}
}
impl<T: Scalar, G: Gait<T> + ?Sized> Iterator for Panels<'_, T, G> {
    type Item = Panel<T>;
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    pub x: T,
    pub y: T,
    pub theta: T,
}
impl<T: Scalar> Pose<T> {
    pub fn new(x: T, y: T, theta: T) -> Self {}
    pub fn identity() -> Self {}
    pub fn position(&self) -> Vector2<T> {}
    #[must_use]
    pub fn inverse(&self) -> Self {}
    pub fn transform(&self, point: &Vector2<T>) -> Vector2<T> {}
    pub fn exp(twist: &Vector3<T>) -> Self {}
}
impl<T: Scalar> Mul for Pose<T> {
    type Output = Self;
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversed<G>(pub G);
impl<T: Scalar, G: Gait<T>> Gait<T> for Reversed<G> {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled<'a, T> {}
impl<'a, T: Scalar> Sampled<'a, T> {
    pub fn new(
        u: &'a [T],
        phi: &'a [Vector2<T>],
        corners: &'a [usize],
    ) -> Result<Self, InvalidSamples> {}
    pub fn knots(&self) -> usize {}
    pub fn slopes(&self, knot: usize) -> [Vector2<T>; 2] {}
}
impl<T: Scalar> Gait<T> for Sampled<'_, T> {}
pub trait Scalar: nalgebra::Scalar + Copy + PartialOrd + NumAssign + Neg<Output = Self> {
    const EPSILON: Self;
    fn from_f64(value: f64) -> Self;
    fn to_f64(self) -> f64;
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
    #[must_use]
    fn sqrt(self) -> Self;
    #[must_use]
    fn ln(self) -> Self;
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    #[must_use]
    fn floor(self) -> Self;
    fn is_finite(self) -> bool;
    #[must_use]
    fn abs(self) -> Self {}
    #[must_use]
    fn min(self, other: Self) -> Self {}
    #[must_use]
    fn max(self, other: Self) -> Self {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondDerivatives<T> {
    pub first: FirstDerivatives<T>,
    pub d2_connection: [Matrix3x2<T>; 3],
    pub d2_power: [Matrix2<T>; 3],
}
impl<T: Scalar> SecondDerivatives<T> {
    pub fn d_curvature(&self) -> [Vector3<T>; 2] {}
}
impl<T: Scalar> SecondDerivatives<T> {
    pub fn at_heading(&self, theta: T) -> FullSecondDerivatives<T> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square<T> {
    pub amplitude: T,
}
impl<T: Scalar> Gait<T> for Square<T> {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke<T> {
    pub displacement: Vector2<T>,
    pub rotation: T,
    pub delta_y: T,
    pub delta_theta: T,
    pub energy: T,
    pub power_length: T,
    pub total_length: T,
    pub side_drag: T,
}
impl<T: Scalar> Stroke<T> {
    pub fn efficiency(&self) -> T {}
    pub fn efficiency_constant_power(&self) -> T {}
    pub fn displacement_over_length(&self) -> Vector2<T> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swimmer<T> {
    pub links: Links<T>,
    pub chi: T,
    pub tangential_drag: TangentialDrag<T>,
    pub sphere_radius: T,
}
impl<T: Scalar> Swimmer<T> {
    pub fn purcell() -> Self {}
    pub fn robot() -> Self {}
    pub fn robot_slender() -> Self {}
    pub fn total_length(&self) -> T {}
    #[must_use]
    pub fn of_unit_length(&self) -> Self {}
    pub fn side_drag(&self) -> T {}
    pub fn validate(&self) -> Result<(), InvalidSwimmer> {}
    pub fn cast<U: Scalar>(&self) -> Swimmer<U> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricFourier<C> {
    pub coefficients: C,
}
impl<T: Scalar, C: AsRef<[[T; 2]]>> Gait<T> for SymmetricFourier<C> {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialDrag<T> {
    LogAspect(T),
    HalfThickness(T),
    OverViscosity(T),
}
impl<T: Scalar> TangentialDrag<T> {
    pub fn over_viscosity(&self, length: T) -> T {}
    pub fn cast<U: Scalar>(&self) -> TangentialDrag<U> {}
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    pub relative: f64,
}
impl Tolerance {
    pub const fn new(relative: f64) -> Self {}
}
impl Default for Tolerance {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint<T> {
    pub u: T,
    pub phi: Vector2<T>,
    pub pose: Pose<T>,
    pub energy: T,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeighedCurvature<T> {
    pub connection: Matrix3x2<T>,
    pub power: Matrix2<T>,
    pub curvature: Vector3<T>,
    pub slope: Vector2<T>,
}
pub fn crossing_share<T: Scalar, G: Gait<T> + ?Sized>(
    links: &Links<T>,
    gait: &G,
) -> CrossingShare<T> {}
pub fn swim<T: Scalar, G: Gait<T> + ?Sized>(
    model: &Model<T>,
    gait: &G,
    tolerance: &Tolerance,
) -> Stroke<T> {}
pub fn trajectory<T: Scalar, G: Gait<T> + ?Sized>(
    model: &Model<T>,
    gait: &G,
    tolerance: &Tolerance,
    intervals: usize,
    mut visit: impl FnMut(TrajectoryPoint<T>),
) {}
pub fn wrapped_angle(angle: f64) -> f64 {}
pub mod gait {
    pub use crate::Circle;
    pub use crate::Fourier;
    pub use crate::Gait;
    pub use crate::GaitPoint;
    pub use crate::Harmonic;
    pub use crate::InvalidSamples;
    pub use crate::Reversed;
    pub use crate::Sampled;
    pub use crate::Square;
    pub use crate::SymmetricFourier;
}
pub mod reference {
    pub const BEST_CIRCLE: BestAmplitude = BestAmplitude {
        amplitude: 1.633_162_5,
        amplitude_tolerance: 5e-8,
        displacement_over_length: 0.082_285_393_1,
        displacement_tolerance: 1e-10,
    };
    pub const BEST_SQUARE: BestAmplitude = BestAmplitude {
        amplitude: 1.390_607_7,
        amplitude_tolerance: 5e-8,
        displacement_over_length: 0.078_260_826_4,
        displacement_tolerance: 5e-11,
    };
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BestAmplitude {
        pub amplitude: f64,
        pub amplitude_tolerance: f64,
        pub displacement_over_length: f64,
        pub displacement_tolerance: f64,
    }
    pub const SECOND_CIRCLE: BestAmplitude = BestAmplitude {
        amplitude: 3.647_415,
        amplitude_tolerance: 5e-7,
        displacement_over_length: -0.214_965_8,
        displacement_tolerance: 5e-8,
    };
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
    pub const SHAPES_TOLERANCE: f64 = 5e-7;
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct ShapeCase {
        pub phi: [f64; 2],
        pub connection: [[f64; 2]; 3],
        pub power: [f64; 3],
    }
}
pub mod stroke {
    pub use crate::CrossingShare;
    pub use crate::Panel;
    pub use crate::Panels;
    pub use crate::Stroke;
    pub use crate::Tolerance;
    pub use crate::TrajectoryPoint;
    pub use crate::crossing_share;
    pub use crate::swim;
    pub use crate::trajectory;
}
