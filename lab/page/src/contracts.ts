// JSON documents of the command. A test generates this file from the output types: change those, then run
// `SWIMMER_CONTRACTS=overwrite cargo test -p operations --test outputs contracts`.

/** Gaits by how much one run of each would narrow the recommended intervals. Serialised with the keys of `swimmer calibrate --json`. */
export interface Advice {
  /** One cycle [s], as most runs had it. */
  period_s: number;
  /** The most informative first. */
  candidates: Candidate[];
}

/** One arc of a gait. */
export interface Arc {
  /** Kind of arc. */
  kind: ArcKind;
  /** Joint angles where it starts [rad]. */
  from: [number, number];
  /** Joint angles where it ends [rad]. */
  to: [number, number];
}

/** Kind of an arc of an optimal gait. */
export type ArcKind = "singular" | "upper" | "lower" | "diagonal" | "clearance" | "regular" | "extreme";

/** Assessment of a fit: the verdict and its reasons. */
export interface AssessmentDocument {
  /** `trust`, `caution` or `do not use`. */
  verdict: string;
  /** Reasons; empty if nothing speaks against the fit. */
  reasons: string[];
  /** χ² by the cycles' own scatter over the degrees of freedom; null if cycles show no scatter. */
  reduced_chi2: number | null;
  /** The answer that is recommended. */
  headline: HeadlinePart;
  /** Goodness of fit. */
  goodness: GoodnessPart;
  /** Sensitivity of r_s and χ to the assumptions. */
  budget: BudgetLine[];
  /** Alternative explanations of the runs, the most likely first. */
  explanations: Explanation[];
  /** Runs that were not fitted. */
  excluded: ExcludedPart[];
  /** Left out where the runs are too few for it. */
  intervals_with_systematics?: Intervals | null;
  /** Left out where the runs are too few for it. */
  systematics?: SystematicsPart | null;
}

/** The JSON document of `swimmer atlas`. */
export type AtlasOutput = OptimaOutput | FastestOptimaOutput | FollowedOutput;

/** Standard deviations from run to run. */
export interface BetweenRuns {
  /** Displacement [m]. */
  x_m: number;
  /** Sway [m]. */
  delta_y_m: number;
  /** Oscillation of the heading [rad]. */
  delta_theta_rad: number;
}

/** Bootstrap by runs and cycles. */
export interface Bootstrap {
  /** Seed of the draws. */
  seed: number;
  /** Number of draws. */
  draws: number;
  /** Whole runs are drawn, not only cycles. */
  runs_drawn: boolean;
  /** Number of draws whose fit ended at the border of the search. */
  at_border: number;
  /** Bias-corrected and accelerated intervals. */
  intervals: Intervals;
}

/** One line of the budget. */
export interface BudgetLine {
  /** Name of the assumption. */
  name: string;
  /** By how much: a share, m or rad. */
  by: number;
  /** m, rad, or nothing for a share. */
  unit: string;
  /** Change of the r_s of greatest likelihood [m]. */
  sphere_radius_m: number;
  /** Change of χ. */
  chi: number;
  /** Standard deviation of the prior, in the same unit; `None` if it is taken as exact. */
  width: number | null;
  /** `true` if the campaign states the prior. */
  stated: boolean;
}

/** The cycles of all runs, and the parameters that explain them. The JSON document of `swimmer calibrate` for a campaign. */
export interface CalibrateOutput {
  /** Fitted runs. */
  runs: RunOutput[];
  /** Radius of the sphere [m]. */
  sphere_radius_m: number;
  /** Drag ratio. */
  chi: number;
  /** Root mean square error with the paper's weights. */
  rmse: number;
  /** Intervals of both parameters. */
  intervals: Intervals;
  /** Correlation of both parameters. */
  correlation: number;
  /** Form of the tangential drag coefficient. */
  c_t_form: string;
  /** Warnings about the runs and the fit. */
  warnings: string[];
  /** Possible further runs, the most useful first. */
  advice?: Advice | null;
  /** Sensitivity of r_s and χ to the assumptions. */
  budget?: BudgetLine[];
  /** Runs that were not fitted. */
  excluded?: ExcludedPart[];
  /** Alternative explanations of the runs, the most likely first. */
  explanations?: Explanation[];
  /** Fit with nuisance parameters. */
  further?: NuisanceFit | null;
  /** Goodness of fit. */
  goodness?: GoodnessPart;
  /** The answer that is recommended. */
  headline?: HeadlinePart;
  /** Left out where the runs are too few for it. */
  intervals_with_systematics?: Intervals | null;
  /** Response of the servos to their commands, if the joint angles were measured: the mean of the runs. */
  joints?: JointsOutput | null;
  /** Estimate by likelihood: each value weighted by its own variance. */
  likelihood?: Likelihood | null;
  /** Reasons; empty if nothing speaks against the fit. */
  reasons?: string[];
  /** χ² by the cycles' own scatter over the degrees of freedom; null if cycles show no scatter. */
  reduced_chi2?: number | null;
  /** Left out where the runs are too few for it. */
  systematics?: SystematicsPart | null;
  /** `trust`, `caution` or `do not use`. */
  verdict?: string;
}

/** One gait that could be measured next. Serialised with the keys of `swimmer calibrate --json`. */
export interface Candidate {
  /** The gait. */
  gait: string;
  /** Width of the recommended interval of r_s with one run of it more, over the width now. */
  sphere_radius_width: number;
  /** The same of χ. */
  chi_width: number;
  /** Geometric mean of both: what the candidates are ranked by. */
  both: number;
}

/** JSON form of a certificate. */
export interface Certificate {
  /** Every condition holds. */
  pass: boolean;
  /** Verdict. */
  verdict: Verdict;
  /** Conditions in order. */
  checks: Check[];
}

/** A certificate. The JSON document of `swimmer certify`. */
export interface CertifyOutput {
  /** Every condition holds. */
  pass: boolean;
  /** Verdict. */
  verdict: Verdict;
  /** Conditions in order. */
  checks: Check[];
  /** Angle [rad] that the faster servo turns in the period for which the gait goes farthest, if it is not the fastest of any period. */
  passes_for_period_rad?: number | null;
}

/** Result of one condition. */
export interface Check {
  /** Condition. */
  name: string;
  /** Computed value; null if it cannot be computed. */
  value: number | null;
  /** Limit of the value: an upper limit, or a lower limit if the name of the condition ends in `_least`. */
  tolerance: number;
  /** `true` if the condition holds. */
  pass: boolean;
}

/** A gait of a swimmer whose side links differ. */
export interface ClosedDisplacementOutput {
  /** Displacement along the heading at the first sample, over the total length. */
  displacement_over_length: number;
  /** Displacement along the heading at the first sample [m]. */
  displacement_m: number;
  /** Displacement across that heading, over the total length. */
  lateral_over_length: number;
  /** Net displacement in any direction, over the total length. */
  distance_over_length: number;
  /** The gait has the paper's symmetries. */
  symmetric: boolean;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** A gait of a swimmer whose side links differ. */
export interface ClosedEfficiencyOutput {
  /** Efficiency ξ of the gait as timed. */
  efficiency: number;
  /** Displacement along the heading at the first sample, over the total length. */
  displacement_over_length: number;
  /** Displacement along the heading at the first sample [m]. */
  displacement_m: number;
  /** Displacement across that heading, over the total length. */
  lateral_over_length: number;
  /** Net displacement in any direction, over the total length. */
  distance_over_length: number;
  /** The gait has the paper's symmetries. */
  symmetric: boolean;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** A mean over the runs of what the model leaves, tested against their own scatter. */
export interface CommonDeviation {
  /** `Y/X` or `net turn`. */
  quantity: string;
  /** Measured less predicted: a share, or rad. */
  mean: number;
  /** Its standard error, by the runs' scatter. */
  error: number;
  /** Probability of such a mean if runs had neither (Student's t). */
  chance: number;
}

/** A component of the displacement. */
export type Component = "x" | "y" | "theta";

/** Something that happened on the way. */
export type ContinuationEvent = { branch: number; value: number; within: number } & ({ kind: "structure"; arcs_before: ArcKind[]; arcs_after: ArcKind[] } | ({ kind: "fold" } & Fold) | { kind: "jump"; apart_rad: number; exponent?: number | null } | { kind: "merger"; other_branch: number } | { kind: "overtaken"; other_branch: number } | { kind: "symmetry"; optimal_among_symmetric_alone: boolean } | { kind: "lost"; reason: string } | { kind: "ended"; reason: string; exponent?: number | null } | { kind: "reached" });

/** Followed gaits, and the events on their way. */
export interface ContinuationOutput {
  /** Name of the parameter. */
  parameter: string;
  /** First value. */
  from: number;
  /** Last value. */
  to: number;
  /** Gaits, branch by branch. */
  points: PointOutput[];
  /** Events, branch by branch; those between branches come last. */
  events: ContinuationEvent[];
}

/** The border of a joint region. */
export interface Contour {
  /** Its level. */
  level: number;
  /** The log-likelihood on it, less the largest: minus Fisher's F of two parameters. */
  threshold: number;
  /** Corners (r_s [m], χ), once round. */
  corners: [number, number][];
}

/** The gait. The JSON document of `swimmer optimize displacement`. */
export type DisplacementOutput = SymmetricDisplacementOutput | ClosedDisplacementOutput | RobustOutput;

/** The gait. The JSON document of `swimmer optimize efficiency`. */
export type EfficiencyOutput = SymmetricEfficiencyOutput | ClosedEfficiencyOutput | RobustOutput;

/** All that is known beyond the fit, with runs by the names of their files; its keys are those of `evidence.json`. */
export interface EvidenceDocument {
  /** Estimate of greatest likelihood. */
  likelihood: LikelihoodPart;
  /** Residuals, run by run. */
  run_errors: RunErrors[];
  /** Profile likelihoods. */
  profiles: Profiles;
  /** Likelihood over both parameters. */
  ridge: Ridge;
  /** Bootstrap of the fit with the paper's weights; null for fewer than five runs. */
  bootstrap: Bootstrap | null;
  /** Fits without one run. */
  without_run: WithoutRun[];
  /** Values that the likelihood leaves out. */
  outliers: EvidenceOutlier[];
  /** Error of the polynomials through the model's values, as a share of the largest X, ΔY, Δθ. */
  surface_error: number;
}

/** Value that stands out. */
export interface EvidenceOutlier {
  /** File of the run. */
  file: string;
  /** X, ΔY or Δθ. */
  quantity: string;
  /** Measured less what all others predict [m or rad]. */
  deviation: number;
  /** The same in standard errors of that difference. */
  standard_errors: number;
  /** Chance that any value of a faultless campaign stands out so far. */
  chance: number;
}

/** A run that was not fitted. */
export interface ExcludedPart {
  /** Its file. */
  file: string;
  /** Why: as the campaign says, or because of its sign. */
  reason: string;
}

/** One parameter of an explanation. */
export interface Explained {
  /** Its name. */
  name: string;
  /** m, rad, or nothing. */
  unit: string;
  /** Value by the files. */
  before: number;
  /** Value that would explain the runs. */
  value: number;
}

/** Something that may be off. */
export interface Explanation {
  /** Name. */
  name: string;
  /** Its parameters. */
  parameters: Explained[];
  /** By how much the log-likelihood of X, ΔY, Δθ, Y and net turn grows over that of r_s and χ alone. */
  gain: number;
  /** r_s and χ if it is so. */
  estimate: Pair;
}

/** Optima for speed. */
export interface FastestOptimaOutput {
  /** Optima, the fastest first. */
  optima: FastestOutput[];
  /** Number of starts. */
  starts: number;
  /** Number of certified cycles with more corners than the search admits. */
  longer: number;
  /** Number of chains of arcs that failed their certificate. */
  uncertified: number;
  /** Speed of the fastest of these, over the total length [1/s]. */
  best_uncertified?: number | null;
  /** Picture of the gaits, if the front end drew one. */
  picture?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
}

/** One of the optima. */
export interface FastestOutput {
  /** Displacement over the period, over the total length [1/s]. */
  speed_over_length_per_s: number;
  /** Displacement over the period [m/s]. */
  speed_m_per_s: number;
  /** Displacement per cycle over the total length. */
  displacement_over_length: number;
  /** Period [s]. */
  period_s: number;
  /** Direction of the displacement relative to the mean heading [rad]. */
  heading_rad: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Fractions of the period at which a servo reverses or stops. */
  corners: number[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Number of starts that led to this gait. */
  found: number;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
}

/** A parameter with its interval. */
export interface FittedParameter {
  /** The parameter. */
  name: string;
  /** m, rad, or nothing. */
  unit: string;
  /** Value by the files, or by the fit without the further parameters. */
  before: number;
  /** The estimate. */
  value: number;
  /** Its interval: Student's t, within the bounds. */
  interval: [number, number];
  /** Bounds of the search. */
  bounds: [number, number];
}

/** Load of one cycle in the fluid, as the gait is parametrised. */
export interface FluidLoad {
  /** Duration of the cycle [s]. */
  period_s: number;
  /** Mean power [W]. */
  power_w: number;
  /** Largest power [W]. */
  peak_power_w: number;
  /** Largest torque of each joint against the fluid alone [N m]. */
  torque_n_m: [number, number];
  /** Reynolds number of the fastest side link, from its tip's speed relative to its joint, its length and the kinematic viscosity. */
  reynolds: number;
  /** Torque of the servos [N m], if the file names it. */
  servo_torque_n_m?: number | null;
}

/** JSON form of a fold. */
export interface Fold {
  /** The other extremal was found. */
  proven: boolean;
  /** Power of the distance to the fold that the gait changed with before; ½ at a fold. */
  exponent?: number | null;
  /** The other extremal, shortly before. */
  other_side?: FoldOtherSide | null;
}

/** The extremal that a branch meets in a fold: its Jacobian has the other orientation. */
export interface FoldOtherSide {
  /** Parameter value of the fold. */
  value: number;
  /** Its efficiency. */
  efficiency: number;
  /** φ₁ at its start [rad]. */
  start_angle_rad: number;
  /** Along how many directions its efficiency grows to second order; 0 for an optimum. */
  ascent_directions: number | null;
}

/** Gaits that are followed without an atlas. */
export interface FollowedOutput {
  /** The gaits. */
  continuation: ContinuationOutput;
  /** Duration [s], if the front end has a clock. */
  seconds?: number | null;
}

/** Change of the frame at the last increase of the order. */
export interface FrameConvergence {
  /** Number of polynomials in each direction, of degrees 0 to `order` − 1. */
  order: number;
  /** Previous order. */
  order_before: number;
  /** Largest change of b_x, b_y (over L) and b_θ (rad) between the two orders for |φᵢ| ≤ 0.8 D. */
  inner_change: number;
  /** The same on the whole square, corners included. */
  change: number;
}

/** File of the farthest gaits in shorter and longer periods. */
export interface FrontOutput {
  /** Path. */
  file: string;
  /** Number of periods. */
  periods: number;
  /** Number of periods with a farthest gait. */
  told: number;
}

/** Area rule of one gait: x and y over L, θ in radians. */
export interface GaitArea {
  /** Name of the gait. */
  gait: string;
  /** ∬ H over the enclosed area, transformed to the middle link at the gait's start. */
  area: [number, number, number];
  /** Net displacement of one cycle. */
  swum: [number, number, number];
  /** `area` − `swum`. */
  deviation: [number, number, number];
}

/** A form of gaits. */
export interface GaitFormOutput {
  /** Example. */
  form: string;
  /** Description. */
  what: string;
}

/** A gait's timing under the limit. */
export interface GaitTiming {
  /** Duration of the cycle [s]. */
  period_s: number;
  /** The shortest period that the rate limit leaves possible [s]. */
  period_min_s: number;
  /** The rate limit [rad/s]; infinite for none. */
  max_rate_rad_s: number | null;
  /** Fastest joint at constant power, without the limit [rad/s]. */
  rate_at_constant_power_rad_s: number;
  /** Share of the period in which a servo runs at its limit, or within a hundredth of it. */
  at_limit: number;
  /** Share of Lighthill's ξ that the limit costs: 0 where constant power keeps within it. */
  efficiency_loss: number;
  /** Displacement over the period [m/s]. */
  speed_m_per_s: number;
}

/** Forms of gaits. The JSON document of `swimmer gaits`. */
export interface GaitsOutput {
  /** The forms. */
  gaits: GaitFormOutput[];
}

/** Goodness of fit. */
export interface GoodnessPart {
  /** Values less parameters. */
  freedom: number;
  /** Null if there are too few runs, or if they show no scatter. */
  reduced_chi2_with_systematics: number | null;
  /** Signs of the residuals at the likeliest r_s and χ. */
  signs: SignTest[];
  /** Run by run. */
  runs: RunPart[];
  /** Y and net turn that all runs have beyond the model. */
  common: CommonDeviation[];
  /** Deviations that nothing explains; null if scatter does. */
  misfit: Misfit | null;
  /** Runs that repeat a gait; left out if none does. */
  repeats?: RepeatsPart[];
}

/** The answer that is recommended. */
export interface HeadlinePart {
  /** `paper` or `systematics`. */
  by: string;
  /** r_s [m]. */
  sphere_radius_m: number;
  /** χ. */
  chi: number;
}

/** One component of the height function. The JSON document of `swimmer height-map`. */
export interface HeightMapOutput {
  /** Component. */
  row: Component;
  /** D: the map covers |φᵢ| ≤ D, and its frame is the best over this square [rad]. */
  max_angle_rad: number;
  /** Height at the straight shape, x and y over L; for the rotation [rad/rad²]. */
  at_origin_over_length: number;
  /** φ₂ of the first zero with φ₁ = φ₂ > 0 [rad]. */
  zero_on_diagonal: number | null;
  /** φ₂ of the first zero with −φ₁ = φ₂ > 0 [rad]. */
  zero_on_antidiagonal: number | null;
  /** φ₂ of all zeros with φ₁ = φ₂ > 0 [rad]. */
  zeros_on_diagonal: number[];
  /** φ₂ of all zeros with −φ₁ = φ₂ > 0 [rad]. */
  zeros_on_antidiagonal: number[];
  /** Change of the frame at the last increase of the order. */
  convergence: FrameConvergence;
  /** Zero-level curves. */
  zero_curves: LevelCurve[];
  /** Area rule of each gait. */
  gaits: GaitArea[];
  /** Figure or table, if the front end wrote one. */
  written?: string | null;
}

/** Intervals of both parameters. */
export interface Intervals {
  /** r_s [m], from and to; never below 0. */
  sphere_radius_m: [number, number];
  /** χ, from and to. */
  chi: [number, number];
  /** Their level. */
  level: number;
}

/** One of the six gaits. */
export interface JoinedOutput {
  /** Name. */
  name: string;
  /** Displacement along the heading at the common shape [m]. */
  x_m: number;
  /** Displacement across that heading [m]. */
  y_m: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** Period [s]. */
  period_s: number;
  /** Displacement over the period, over the total length [1/s]; null for gaits that turn. */
  speed_over_length_per_s: number | null;
  /** Rotation over the period [rad/s]; null for gaits that do not turn. */
  rotation_rad_per_s: number | null;
  /** Share of the fastest gait's speed that the common shape costs. */
  joining_costs: number;
  /** Certificate. */
  certificate: Certificate;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
}

/** Servos of one run, or the mean of all runs. */
export interface JointsOutput {
  /** Front servo. */
  front: MeasuredServo;
  /** Back servo. */
  back: MeasuredServo;
}

/** A whole cycle that does not count. */
export interface LeftOutOutput {
  /** Start [s]. */
  start_s: number;
  /** Reason. */
  reason: string;
}

/** One connected zero-level curve, possibly through points where it crosses another. */
export interface LevelCurve {
  /** `true` if the curve is closed; both ends of an open curve are on the edge of the square. */
  closed: boolean;
  /** Largest |H| at a vertex. */
  residual: number;
  /** Vertices Φ [rad] in order; the last repeats the first if the curve is closed. */
  vertices: [number, number][];
}

/** The estimate of greatest likelihood. */
export interface Likelihood {
  /** r_s [m]. */
  sphere_radius_m: number;
  /** χ. */
  chi: number;
  /** Ends of the profile likelihoods at Student's threshold. */
  intervals: Intervals;
}

/** Estimate of greatest likelihood. */
export interface LikelihoodPart {
  /** r_s [m] and χ. */
  estimate: Pair;
  /** Ends of the profile likelihoods. */
  intervals: Intervals;
  /** Standard deviations from run to run, beyond what cycles explain. */
  between_runs: BetweenRuns;
  /** Correlation of r_s and ln χ. */
  correlation: number;
}

/** A value with its standard error. */
export interface Measured {
  /** The value. */
  value: number;
  /** Its standard error; NaN if it is unknown. */
  error: number | null;
}

/** Response of a servo: φ follows gain · command(t − lag) + offset, with a play of the dead band either way. */
export interface MeasuredServo {
  /** Angle per commanded angle. */
  gain: Measured;
  /** Half of its play [rad]. */
  dead_band_rad: Measured;
  /** The joint's angle at command 0 [rad]. */
  offset_rad: Measured;
  /** Lag [s]; `None` if the cycles were timed by the heading, which cannot distinguish a lag from a later start. */
  lag_s: Measured | null;
}

/** Swimmer that holds the worst case. */
export interface MemberOutput {
  /** Radius of the sphere [m]. */
  sphere_radius_m: number;
  /** Drag ratio. */
  chi: number;
  /** Gain of the servos: actual over commanded angle. */
  gain: number;
  /** Its share of the first-order condition. */
  multiplier: number;
}

/** Deviations from run to run that neither scatter nor systematic errors explain. */
export interface Misfit {
  /** `ΔY` or `Δθ`. */
  quantity: string;
  /** Their standard deviation over the largest value. */
  share: number;
  /** The same over the scatter within runs. */
  ratio: number;
}

/** The net motion of one cycle, what it sways and turns in between, and its efficiency. ``` use forecast::NetMotion; use swimmer_model::{Circle, Model, Swimmer, Tolerance, swim}; let model = Model::new(&Swimmer::<f64>::robot())?; let net = NetMotion::from(&swim(&model, &Circle { amplitude: 1.2 }, &Tolerance::default())); assert!((net.displacement_m - net.displacement_over_length * 0.345).abs() < 1e-12); # Ok::<(), swimmer_model::InvalidSwimmer>(()) ``` */
export interface NetMotion {
  /** X/L. */
  displacement_over_length: number;
  /** X [m]. */
  displacement_m: number;
  /** Y/L. */
  lateral_over_length: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** ΔY/L. */
  delta_y_over_length: number;
  /** Δθ [rad]. */
  delta_theta_rad: number;
  /** Efficiency in the gait's own time parametrisation. */
  efficiency: number | null;
  /** At constant power. */
  efficiency_constant_power: number | null;
}

/** Estimate of a parameter with a prior. */
export interface Nuisance {
  /** Its name. */
  name: string;
  /** m, rad, or nothing. */
  unit: string;
  /** Prior: value and standard deviation. */
  known: [number, number];
  /** `true` if the campaign states the prior. */
  stated: boolean;
  /** Estimate and its standard deviation. */
  found: [number, number];
  /** Contradiction of the prior by the runs alone, in standard deviations of the difference. */
  pull: number;
}

/** r_s, χ and further parameters, by likelihood. Serialised with the keys of `swimmer calibrate --json`. */
export interface NuisanceFit {
  /** r_s [m], χ, then the others. */
  parameters: FittedParameter[];
  /** Level of the intervals. */
  level: number;
  /** Correlations between all of them. */
  correlations: number[][];
  /** Condition number of the Jacobian with columns of length 1. */
  condition: number;
  /** By how much the log-likelihood grows over that of r_s and χ alone. */
  log_likelihood_gain: number;
  /** Warnings. */
  warnings: string[];
}

/** Optima for displacement or efficiency. */
export interface OptimaOutput {
  /** Optima, the best first. */
  optima: OptimumOutput[];
  /** Number of random starts. */
  starts: number;
  /** Number of further starts, from gaits that the quarter solvers find without a guess. */
  known_starts: number;
  /** Number of starts that did not converge. */
  unsettled: number;
  /** Number of starts that left the region of the search. */
  left: number;
  /** Number of starts whose gait could not be certified. */
  uncertified: number;
  /** |d|/L or ξ of the best of these, by its curve of low order. */
  best_uncertified?: number | null;
  /** The best gaits, followed as a parameter changes. */
  continuation?: ContinuationOutput | null;
  /** Picture of the gaits, if the front end drew one. */
  picture?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
}

/** Best gait of an objective. */
export type OptimizeOutput = DisplacementOutput | EfficiencyOutput | TurningOutput | SidewaysOutput | SpeedOutput;

/** One of the optima. */
export interface OptimumOutput {
  /** Lighthill efficiency ξ at constant power. */
  efficiency: number | null;
  /** Displacement along the heading at the first sample, over the total length. */
  displacement_over_length: number;
  /** Displacement along that heading [m]. */
  displacement_m: number;
  /** Displacement across that heading, over the total length. */
  lateral_over_length: number;
  /** Net displacement in any direction, over the total length. */
  distance_over_length: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** φ₁ at the first sample [rad]. */
  start_angle_rad: number;
  /** φ₂ at the end of the first quarter [rad]. */
  end_angle_rad: number;
  /** Arcs: of the quarter if the gait is symmetric, of the cycle otherwise. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** The curve does not cross itself. */
  simple: boolean;
  /** The gait has the paper's symmetries. */
  symmetric: boolean;
  /** Number of starts that led to this gait. */
  found: number;
  /** Efficiency by that method, if it is a solver of its own. */
  direct_efficiency?: number | null;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Method of the initial guess. */
  method?: string;
  /** Shortest period [s]. */
  period_s?: number;
  /** (max − min)/mean of the power. */
  power_variation?: number | null;
  /** Largest residual: of the shooting conditions, or of the gradient of ln ξ for a robust gait. */
  residual?: number | null;
  /** Duration of the whole search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Displacement over that period, over the total length [1/s]. */
  speed_over_length_per_s?: number;
}

/** A value that was left out. */
export interface OutlierPart {
  /** The run's file. */
  file: string;
  /** X, ΔY or Δθ. */
  quantity: string;
}

/** r_s and χ by one way of fitting. */
export interface Pair {
  /** r_s [m]. */
  sphere_radius_m: number;
  /** χ. */
  chi: number;
}

/** Kind of a row. */
export type PaperClaim = "number" | "statement";

/** All comparisons. The JSON document of `swimmer paper`. */
export interface PaperOutput {
  /** Comparisons. */
  rows: PaperRow[];
  /** Rows with a printed number. */
  numbers: PaperTally;
  /** Rows with a statement. */
  statements: PaperTally;
  /** Page, if the front end wrote one. */
  page?: string | null;
}

/** Comparison of one number. */
export interface PaperRow {
  /** Identifier of the row. */
  id: string;
  /** Name of the quantity, with its unit. */
  quantity: string;
  /** The paper's number. */
  paper: PrintedValue;
  /** The number computed. */
  ours: number;
  /** Deviation relative to the paper's number or to the nearest end of its range; absolute if that is zero. */
  deviation: number;
  /** `None` if the paper's number cannot be reproduced. */
  pass: boolean | null;
  /** Printed number or statement. */
  claim: PaperClaim;
  /** Explanation of what the paper leaves open; may be empty. */
  note?: string;
}

/** Counts of rows by outcome. */
export interface PaperTally {
  /** Rows that agree with the paper. */
  reproduced: number;
  /** Rows that differ from it. */
  differ: number;
  /** Rows that cannot be compared, each with its reason. */
  open: number;
}

/** Best waveform. The JSON document of `swimmer optimize passive`. */
export interface PassiveOutput {
  /** Quantity that is maximised. */
  objective: string;
  /** The passive joint, `front` or `back`. */
  passive: string;
  /** Displacement over the total length. */
  displacement_over_length: number;
  /** Displacement [m]. */
  displacement_m: number;
  /** Displacement per second [m/s]. */
  speed_m_per_s: number;
  /** Lighthill's efficiency as parametrised: that of the motor, since the spring does no work over a cycle. */
  efficiency: number;
  /** Period [s]. */
  period_s: number;
  /** Relaxation time of the passive joint [s]. */
  relaxation_s: number;
  /** Passive angle at the start of the cycle [rad]. */
  passive_start_rad: number;
  /** Largest angle of the driven joint [rad]. */
  largest_angle_rad: number;
  /** Largest rate of the driven joint [rad/s]. */
  largest_rate_rad_per_s: number;
  /** Harmonics of the waveform: order, coefficients of cosine and sine [rad]. */
  waveform: WaveformHarmonic[];
  /** Share by which its objective exceeds that of the best sinusoid. */
  gain_over_sine: number;
  /** The best sinusoid under the same bounds. */
  sine: WaveformCycle;
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** First-order (KKT) conditions and second variation. */
  conditions: WaveformConditions;
  /** The gait file, if the front end wrote one. */
  gait?: string | null;
  /** Stiffness of the spring [N m/rad], if the swimmer file names a fluid. */
  stiffness_n_m?: number | null;
  /** Motor work per cycle [J], if the swimmer file names a fluid. */
  work_j?: number | null;
}

/** The quickest plan found. The JSON document of `swimmer plan`. */
export interface PlanOutput {
  /** Steps in order. */
  steps: PlanStepOutput[];
  /** Duration [s], without the motion from and to the straight shape. */
  duration_s: number;
  /** End pose, with the joints straight again. */
  reached: ReachedPose;
  /** Distance of the end pose to the target, in the model [m]. */
  off_m: number;
  /** Angle between the heading of the end pose and that of the target [rad]. */
  off_rad: number;
  /** Number of chains of legs that meet the target. */
  chains: number;
  /** Number of these chains that stay clear of the walls. */
  chains_within_walls: number;
  /** Deviation from the end pose if χ is 5 % higher; missing outside a viscous fluid. */
  off_if_chi_is_5_percent_higher?: PoseDeviation | null;
  /** Deviation from the end pose if χ is 5 % lower; missing outside a viscous fluid. */
  off_if_chi_is_5_percent_lower?: PoseDeviation | null;
  /** Playlist, if the front end wrote one. */
  playlist?: string | null;
}

/** Cycles of one gait. */
export interface PlanStepOutput {
  /** Gait: forward, backward, left, right, turn-left or turn-right, or the name of its file next to the playlist. */
  gait: string;
  /** Number of cycles. */
  cycles: number;
  /** Duration of a cycle [s]. */
  period_s: number;
  /** Size of the gait: share of the way from the common shape. */
  scale: number;
}

/** Forecast of a played cycle. */
export interface PlayedCycle {
  /** Duration of the cycle [s]. */
  period_s: number;
  /** Knots of the robot's table. */
  knots: number;
  /** Step of the timer that makes the pulses [ns]. */
  pulse_step_ns: number;
  /** Displacement along the swimmer [m]. */
  displacement_m: number;
  /** Displacement across the swimmer [m]. */
  lateral_m: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** Sway ΔY [m]. */
  delta_y_m: number;
  /** Yaw Δθ [rad]. */
  delta_theta_rad: number;
  /** Sum of all losses of displacement, along the designed displacement [m]. */
  loss_m: number;
  /** The same as a share of the designed displacement. */
  loss_share: number | null;
  /** Loss by each imperfection, in order. They sum to `loss_m`. */
  losses: PlayedLoss[];
  /** Radius of the circle on which the played gait swims [m]. `None` if it swims straight. */
  turn_radius_m: number | null;
  /** Largest joint angle. */
  reach: Reach;
  /** Smallest distance of the side links' centre lines [m]. */
  gap_m: number;
  /** Joint angles at that distance [rad]. */
  gap_at_rad: [number, number];
  /** Smallest distance in the designed gait [m]. */
  gap_designed_m: number;
  /** Distance that the robot keeps [m]. */
  gap_margin_m: number;
  /** Shortest cycle that the robot accepts [s]. */
  min_period_s: number;
  /** Reason why the robot refuses the gait. */
  refused: string | null;
  /** Warnings for the user. */
  warnings: string[];
}

/** Displacement lost to one imperfection. */
export interface PlayedLoss {
  /** Name of the imperfection. */
  by: string;
  /** Loss along the designed displacement [m]. */
  loss_m: number;
  /** The same as a share of the designed displacement. */
  loss_share: number | null;
  /** Rotation that it adds [rad]. */
  rotation_rad: number;
}

/** A gait as fast as the robot of the file plays it. */
export interface PlayedSpeed {
  /** Period of the gait, or the shortest that the robot allows for its table, to the next millisecond [s]. */
  period_s: number;
  /** Displacement over that period [m/s]. */
  speed_m_per_s: number;
  /** Share of the designed speed that table, ticks, pulses and servos cost. */
  lost_share: number;
}

/** Gait at one value of the parameter. */
export interface PointOutput {
  /** Number of the gait that is followed, from 0. */
  branch: number;
  /** Value of the parameter. */
  value: number;
  /** Lighthill efficiency ξ. */
  efficiency: number | null;
  /** Displacement along the heading at the first sample, over the total length. */
  displacement_over_length: number;
  /** Displacement across that heading, over the total length. */
  lateral_over_length: number;
  /** φ₁ at the first sample [rad]. */
  start_angle_rad: number;
  /** φ₂ at the end of the first quarter [rad]. */
  end_angle_rad: number;
  /** Kinds of the arcs in order. */
  arcs: string[];
  /** Residual of the solver. */
  residual: number;
  /** The certificate passes. */
  certified: boolean;
}

/** A point, and in which rows it is. */
export interface PointPresence {
  /** Its name, as in the file. */
  name: string;
  /** Type. */
  kind: string;
  /** Its ID in the file; empty where the file has none. */
  id: string;
  /** In how many rows it is there. */
  present: number;
  /** Number of gaps. */
  gaps: number;
  /** The longest of them. */
  longest_gap: number;
  /** `true` if the file gives its orientation, so that it can be the `body` of a campaign. */
  oriented: boolean;
}

/** Deviation from a pose. */
export interface PoseDeviation {
  /** Distance [m]. */
  distance_m: number;
  /** Angle between the headings [rad]. */
  angle_rad: number;
}

/** A preset as a file to start from. The JSON document of `swimmer swimmers NAME`. */
export interface PresetFileOutput {
  /** Name. */
  name: string;
  /** Text of the file, with comments. */
  toml: string;
}

/** A preset. */
export interface PresetOutput {
  /** Name. */
  name: string;
  /** Description. */
  what: string;
  /** Lengths of the front, the middle and the back link [m]. */
  links_m: [number, number, number];
  /** Drag ratio; null outside a viscous fluid. */
  chi: number | null;
  /** Radius of the sphere [m]. */
  sphere_radius_m: number;
}

/** Value printed in the paper. */
export type PrintedValue = number | string;

/** A profile likelihood. */
export interface Profile {
  /** The parameter (m, or χ) and log-likelihood less its largest value, the other parameter set free. */
  points: [number, number][];
  /** Threshold at the ends of the interval: −t²/2 of Student's t. */
  threshold: number;
  /** The interval. */
  interval: [number | null, number | null];
  /** `true` if the profile did not fall to the threshold within its range: then that end is no bound. */
  open: [boolean, boolean];
  /** Degrees of freedom of Student's t. */
  freedom: number;
}

/** Profile likelihoods. */
export interface Profiles {
  /** Radius of the sphere [m]. */
  sphere_radius_m: Profile;
  /** Drag ratio. */
  chi: Profile;
}

/** Largest joint angle of a cycle. */
export interface Reach {
  /** Phase, from 0 to 1. */
  u: number;
  /** Joint: 1 or 2. */
  joint: number;
  /** Angle [rad]. */
  angle_rad: number;
  /** Largest angle of the servos [rad]. */
  max_angle_rad: number;
}

/** End pose of a plan. */
export interface ReachedPose {
  /** Along the tank [m]. */
  x_m: number;
  /** Across the tank [m]. */
  y_m: number;
  /** Heading [rad]. */
  heading_rad: number;
}

/** Runs that repeat a gait. */
export interface RepeatsPart {
  /** Their files. */
  files: string[];
  /** The gait as the first of them names it. */
  gait: string;
  /** Mean X and its deviation from repeat to repeat [m]. */
  x_m: [number, number];
  /** The same of ΔY [m]. */
  delta_y_m: [number, number];
  /** The same of Δθ [rad]. */
  delta_theta_rad: [number, number];
  /** Probability of this scatter between repeats, if it were that of the cycles: of the quantity that scatters most. */
  chance: number;
}

/** The log-likelihood over both parameters, for drawing. */
export interface Ridge {
  /** r_s [m] of the grid's columns. */
  sphere_radius_m: number[];
  /** χ of its rows. */
  chi: number[];
  /** Log-likelihood less its largest value: a row for each χ. */
  log_ratio: ((number | null)[])[];
  /** Regions of both parameters together. */
  contours: Contour[];
}

/** A robust gait with the paper's symmetries. The JSON document of `swimmer optimize … --robust`. */
export interface RobustOutput {
  /** Efficiency of the estimated swimmer. */
  efficiency: number | null;
  /** Displacement per cycle over the total length, with its sign. */
  displacement_over_length: number;
  /** Displacement per cycle [m]. */
  displacement_m: number;
  /** φ₁ = φ₂ at the start [rad]. */
  start_angle_rad: number;
  /** φ₂ = −φ₁ at the end of the quarter [rad]. */
  end_angle_rad: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Cost and benefit of robustness. */
  robust: RobustnessOutput;
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** The gait runs clockwise, and the quarter is that of the counter-clockwise gait; displacement gaits only. */
  clockwise?: boolean | null;
  /** Efficiency by that method, if it is a solver of its own. */
  direct_efficiency?: number | null;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Method of the initial guess. */
  method?: string;
  /** (max − min)/mean of the power. */
  power_variation?: number | null;
  /** Largest residual: of the shooting conditions, or of the gradient of ln ξ for a robust gait. */
  residual?: number | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** Values of a gait over the uncertainty: X/L per cycle, signed, ξ as timed, or |d|/(L T) [1/s]. */
export interface RobustValues {
  /** For the estimates themselves. */
  nominal: number;
  /** Worst case: the least value in the required direction. */
  worst: number;
  /** In the mean. */
  mean: number;
}

/** Cost and benefit of robustness. */
export interface RobustnessOutput {
  /** Statistic that was maximised. */
  over: Statistic;
  /** Symbol of the quantity. */
  quantity: string;
  /** Values of the robust gait. */
  robust: RobustValues;
  /** Values of the optimum of the estimated swimmer. */
  nominal_optimum: RobustValues;
  /** Swimmers that hold the worst case. */
  held_by: MemberOutput[];
  /** Number of swimmers among which the search for the worst case starts. */
  worst_among: number;
  /** Number of swimmers in the mean. */
  mean_of: number;
  /** The gait lies on another branch of optima than that of the estimated swimmer. */
  off_branch: boolean;
  /** Largest share of the cycle in which links cross, over all gains. */
  largest_links_cross: number;
  /** The same of the optimum of the estimated swimmer, with exact servos. */
  nominal_optimum_links_cross: number;
}

/** Residual of one quantity of one run at the estimate of greatest likelihood; m or rad. */
export interface RunError {
  /** Measured mean. */
  measured: number | null;
  /** By the model. */
  predicted: number | null;
  /** Standard error of the mean from the run's cycles. */
  within: number | null;
  /** The same with what differs from run to run. */
  standard_error: number | null;
  /** (Predicted − measured) / standard error. */
  standardised: number | null;
}

/** Residuals of one run. */
export interface RunErrors {
  /** File of the run. */
  file: string;
  /** Displacement [m]. */
  x_m: RunError;
  /** Sway [m]. */
  delta_y_m: RunError;
  /** Oscillation of the heading [rad]. */
  delta_theta_rad: RunError;
}

/** Joint angles of one run. */
export interface RunJoints {
  /** Share of the samples of valid cycles in which each angle was seen. */
  seen: [number, number];
  /** Scatter of samples about the mean course, of each angle [rad]. */
  scatter_rad: [number, number];
  /** Response of the servos to the command; null if the gait does not determine it. */
  servos: JointsOutput | null;
}

/** The cycles of one run and their means. The deviation of a single cycle is NaN, in JSON null. */
export interface RunOutput {
  /** File of the track, relative to the campaign. */
  file: string;
  /** Gait. */
  gait: string;
  /** Number of valid cycles; null for reported results without it. */
  cycles: number | null;
  /** Mean displacement along the heading per cycle [m]. */
  x_m: number;
  /** Standard deviation of the displacement [m]. */
  x_sd_m: number | null;
  /** Mean displacement across the heading per cycle [m]. */
  y_m: number | null;
  /** Mean lateral sway within a cycle [m]. */
  delta_y_m: number;
  /** Standard deviation of the sway [m]. */
  delta_y_sd_m: number | null;
  /** Mean oscillation of the heading within a cycle [rad]. */
  delta_theta_rad: number;
  /** Standard deviation of the oscillation [rad]. */
  delta_theta_sd_rad: number | null;
  /** Mean net rotation per cycle [rad]. */
  turn_rad: number | null;
  /** Mean period [s]. */
  period_s: number;
  /** Standard error of the displacement [m]. */
  x_se_m: number | null;
  /** Correlation of successive displacements. */
  x_lag1: number | null;
  /** Standard deviation of the displacement across the heading [m]. */
  y_sd_m: number | null;
  /** Its standard error [m]. */
  y_se_m: number | null;
  /** Its correlation from cycle to cycle. */
  y_lag1: number | null;
  /** Standard error of the sway [m]. */
  delta_y_se_m: number | null;
  /** Correlation of successive sways. */
  delta_y_lag1: number | null;
  /** Standard error of the oscillation of the heading [rad]. */
  delta_theta_se_rad: number | null;
  /** Its correlation from cycle to cycle. */
  delta_theta_lag1: number | null;
  /** Standard deviation of the net rotation [rad]. */
  turn_sd_rad: number | null;
  /** Its standard error [rad]. */
  turn_se_rad: number | null;
  /** Its correlation from cycle to cycle. */
  turn_lag1: number | null;
  /** Rule that distinguished front and back: label, place or travel; null without a track. */
  front_rule: string | null;
  /** Source of the starts of cycles: heading, flash, log or log-and-heading; `told` without a track. */
  phase: string;
  /** Whole cycles that do not count. */
  left_out: LeftOutOutput[];
  /** Times at which the names of both reflectors were exchanged, and corrected. */
  swaps: Stretch[];
  /** Times of points that are not reflectors. */
  ghosts: Stretch[];
  /** Remarks on its track and its cycles. */
  diagnoses: string[];
  /** Frames by their use. */
  samples: Samples;
  /** Its joint angles, if reflectors on the side links measured them. */
  joints?: RunJoints | null;
}

/** Fit of one run by itself. */
export interface RunPart {
  /** Its file. */
  file: string;
  /** Y over X, and its standard error from the run's cycles; 0 for a symmetric gait. */
  y_over_x: [number | null, number | null];
  /** Probability of a Y as far from the model's or farther; the model has the servos of the swimmer file (Student's t). */
  y_chance: number | null;
  /** Net turn of a cycle [rad], and its standard error from the run's cycles; 0 for a symmetric gait. */
  turn_rad: [number | null, number | null];
  /** Probability of a turn as far from the model's or farther. */
  turn_chance: number | null;
  /** Velocity along and across the heading that would explain X and Y beyond the model [m/s]. */
  drift_m_per_s: [number | null, number | null];
  /** Ratio of lengths to those predicted from the other runs, and its standard error: a wall reduces it. */
  scale: [number, number] | null;
}

/** The cycles of a single run. The JSON document of `swimmer calibrate` for a tracking file. */
export interface RunsOutput {
  /** The run. */
  runs: RunOutput[];
  /** Warnings about its track, and doubts about its gait. */
  warnings: string[];
}

/** Counts of a track's frames by their use. */
export interface Samples {
  /** All frames. */
  frames: number;
  /** Frames in which the points were seen. */
  seen: number;
  /** Seen, but next to a gap too long to be filled: plotted, not used. */
  tails: number;
  /** Seen next to a filled gap, and replaced by its cubic. */
  smoothed: number;
  /** In short gaps. */
  filled: number;
}

/** The gait. The JSON document of `swimmer optimize sideways`. */
export interface SidewaysOutput {
  /** Displacement across the heading at the first sample, over the total length, positive. */
  lateral_over_length: number;
  /** Displacement along that heading, over the total length. */
  displacement_over_length: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** Direction of the displacement relative to the mean heading [rad]; null if it cannot be evaluated. */
  heading_rad: number | null;
  /** Number of simple loops found. */
  loops: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** Signs of the residuals of one quantity, from the smallest gait to the largest. */
export interface SignTest {
  /** X, ΔY or Δθ. */
  quantity: string;
  /** Signs of simulated minus measured, one per run. */
  signs: number[];
  /** Number of stretches of equal sign. */
  stretches: number;
  /** Probability of as few stretches or fewer with random signs. */
  chance: number;
}

/** One cycle. The JSON document of `swimmer simulate`. */
export interface SimulateOutput {
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** X/L. */
  displacement_over_length: number;
  /** X [m]. */
  displacement_m: number;
  /** Y/L. */
  lateral_over_length: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** ΔY/L. */
  delta_y_over_length: number;
  /** Δθ [rad]. */
  delta_theta_rad: number;
  /** Efficiency in the gait's own time parametrisation. */
  efficiency: number | null;
  /** At constant power. */
  efficiency_constant_power: number | null;
  /** Torque, power and Reynolds number, if the swimmer file names a fluid. */
  fluid?: FluidLoad | null;
  /** Gait file of the limit cycle, if the front end wrote one. */
  gait?: string | null;
  /** Angle of the passive joint at the start of its limit cycle [rad]. */
  passive_start_rad?: number | null;
  /** Picture, if the front end drew one. */
  picture?: string | null;
  /** The cycle as the robot plays it. */
  played?: PlayedCycle | null;
  /** Table of the trajectory, if the front end wrote one. */
  trajectory?: string | null;
}

/** The gait. The JSON document of `swimmer optimize speed`. */
export interface SpeedOutput {
  /** Displacement over the period, over the total length [1/s]. */
  speed_over_length_per_s: number;
  /** Displacement over the period [m/s]. */
  speed_m_per_s: number;
  /** Displacement per cycle over the total length. */
  displacement_over_length: number;
  /** Displacement per cycle [m]. */
  displacement_m: number;
  /** Period [s]. */
  period_s: number;
  /** Direction of the displacement relative to the mean heading [rad]. */
  heading_rad: number;
  /** Net rotation [rad]. */
  rotation_rad: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Fractions of the period at which a servo reverses or stops. */
  corners: number[];
  /** Largest number of corners of a cycle. */
  max_corners: number;
  /** Number of closed curves from which the search starts. */
  starts: number;
  /** Number of starts that led to this gait. */
  found: number;
  /** Speed of a certified cycle with more corners, if it is better by more than 1e-6. */
  longer_speed_over_length_per_s: number | null;
  /** Speed of a faster chain of arcs that failed its certificate. */
  uncertified_speed_over_length_per_s: number | null;
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Speed of the fastest gait of any heading, if a heading is prescribed. */
  any_heading_speed_over_length_per_s?: number | null;
  /** File of the farthest gaits, if the front end wrote one. */
  front?: FrontOutput | null;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Speed as the robot plays the gait. */
  played?: PlayedSpeed | null;
  /** Rest at the end of the period [s], if the period is given. */
  rest_s?: number | null;
  /** Cost and benefit of robustness. */
  robust?: RobustnessOutput | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** Statistic that a robust design maximises. */
export type Statistic = "worst" | "mean";

/** The six gaits. The JSON document of `swimmer optimize steer`. */
export interface SteerOutput {
  /** Shape at which the gaits join [rad]. */
  shape_rad: [number, number];
  /** Number of shapes that were tried. */
  shapes: number;
  /** The gaits. */
  gaits: JoinedOutput[];
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
}

/** Rows one after another in which something held. */
export interface Stretch {
  /** The first of them [s]. */
  from_s: number;
  /** The last of them [s]. */
  until_s: number;
  /** Number. */
  rows: number;
}

/** An axis of a plan. */
export interface SweepAxisOutput {
  /** Name. */
  name: string;
  /** Unit. */
  unit: string;
  /** Number of points of a grid; 0 in other plans. */
  count: number;
}

/** Doubtful design. */
export interface SweepDoubt {
  /** Reason. */
  kind: SweepDoubtKind;
  /** Key of the task. */
  key: number;
  /** Key of the neighbour with which it was compared. */
  neighbour: number;
  /** Relative difference by which the neighbour is better; `None` for a lost gait. */
  share: number | null;
}

/** Reason to doubt a design. */
export type SweepDoubtKind = "beaten" | "lost" | "jump";

/** Map. The JSON file of `swimmer sweep map --export`. */
export interface SweepMap {
  /** `swimmer-sweep-map 1`. */
  format: string;
  /** Hash of the plan. */
  plan: string;
  /** Objective of the gaits. */
  objective: string;
  /** Horizontal and vertical axis. */
  axes: [SweepMapAxis, SweepMapAxis];
  /** Quantities that at least one design of the slice has. */
  quantities: SweepMapQuantity[];
  /** Arcs of each gait, or `None`. */
  structure: ((string | null)[])[];
  /** `optimal`, `uncertified` or `none`. */
  status: string[][];
  /** Polylines (values of both axes) between designs whose gaits have different arcs, or of which one has no gait. */
  folds: [number, number][][];
  /** Pareto front of the whole plan, slowest first; empty without servo rates. */
  pareto: SweepPareto[];
  /** Axes of the whole plan, without that of the objective. */
  plan_axes: SweepPlanAxis[];
}

/** An axis of a map. */
export interface SweepMapAxis {
  /** Name of the field. */
  name: string;
  /** Name in words. */
  words: string;
  /** Its unit. */
  unit: string;
  /** Values in the order of the plan. */
  values: number[];
}

/** A map of a finished grid. The JSON document of `swimmer sweep map`. */
export interface SweepMapOutput {
  /** Hash of the plan. */
  plan: string;
  /** Number of designs of the plan. */
  tasks: number;
  /** Number of solved designs: all. */
  done: number;
  /** Number of designs of the plan without a gait. */
  failed: number;
  /** Number of designs of the slice. */
  designs: number;
  /** Number of these without a gait. */
  without_gait: number;
  /** Number of these whose certificate does not pass. */
  uncertified: number;
  /** Number of kinds of gait in the slice, by their arcs. */
  kinds: number;
  /** Number of lines at which the kind of gait changes. */
  folds: number;
  /** Number of designs on the Pareto front of the plan. */
  pareto: number;
  /** Designs of the plan that differ from their neighbours. */
  doubts: SweepDoubt[];
  /** Picture, if the front end drew one. */
  picture: string | null;
  /** File of the map's numbers, if the front end wrote one. */
  export: string | null;
}

/** Mapped quantity: one row per value of the second axis, one number per value of the first. */
export interface SweepMapQuantity {
  /** Its name. */
  name: string;
  /** Name in words. */
  words: string;
  /** Its unit. */
  unit: string;
  /** `None` if the design has no gait. */
  values: ((number | null)[])[];
}

/** A table of all designs. The JSON document of `swimmer sweep merge`. */
export interface SweepMergeOutput {
  /** Hash of the plan. */
  plan: string;
  /** Number of designs of the plan. */
  tasks: number;
  /** Number of rows. */
  done: number;
  /** Designs without a gait. */
  failed: number;
  /** Number of gaits whose certificate passes. */
  certified: number;
  /** The table. */
  table: string;
  /** Its size in bytes. */
  bytes: number;
  /** Its hash; null for tables above 256 MiB. */
  sha256: string | null;
}

/** Design on the Pareto front of speed and efficiency. */
export interface SweepPareto {
  /** Key of the task. */
  key: number;
  /** |d|/(L T) [1/s]. */
  speed: number;
  /** ξ. */
  efficiency: number;
  /** Values of the plan's axes, in the order of `Map::plan_axes`. */
  design: number[];
}

/** Axis of the plan. */
export interface SweepPlanAxis {
  /** Name in the spec. */
  name: string;
  /** Name in words. */
  words: string;
  /** Unit; empty for a number. */
  unit: string;
}

/** A plan. The JSON document of `swimmer sweep plan`. */
export interface SweepPlanOutput {
  /** Hash of the plan. */
  plan: string;
  /** Folder of the plan and of its results. */
  folder: string;
  /** Objectives, separated by commas. */
  objective: string;
  /** Number of designs. */
  tasks: number;
  /** Number of solved designs. */
  done: number;
  /** Number of designs without a gait. */
  failed: number;
  /** Number of blocks. */
  blocks: number;
  /** Number of designs of a block. */
  block_size: number;
  /** Axes. */
  axes: SweepAxisOutput[];
}

/** A finished run of a shard. The JSON document of `swimmer sweep run`. */
export interface SweepRunOutput {
  /** Hash of the plan. */
  plan: string;
  /** Shard, as `2/7`. */
  shard: string;
  /** Number of designs of the plan. */
  tasks: number;
  /** Number of tasks in finished blocks. */
  done: number;
  /** Number of those without a gait. */
  failed: number;
  /** Number of blocks of the shard. */
  blocks: number;
  /** Number of blocks finished by earlier runs. */
  blocks_skipped: number;
  /** Duration [s]; 0 if the front end has no clock. */
  seconds: number;
}

/** Progress of a sweep. The JSON document of `swimmer sweep status`. */
export interface SweepStatusOutput {
  /** Hash of the plan. */
  plan: string;
  /** Number of designs of the plan. */
  tasks: number;
  /** Number of designs in finished blocks. */
  done: number;
  /** Number of those without a gait. */
  failed: number;
  /** Number of those whose certificate does not pass. */
  uncertified: number;
  /** Number of those found from a neighbour's gait. */
  warm: number;
  /** Number of blocks of the plan. */
  blocks: number;
  /** Number of finished blocks. */
  blocks_done: number;
  /** Number of incomplete blocks and of blocks of another plan; a run replaces them. */
  blocks_broken: number;
  /** Size of all parts in bytes. */
  bytes: number;
  /** Mean core seconds of a search; `None` before the first was timed. */
  cold_s: number | null;
  /** Mean core seconds of a step from a neighbour's gait. */
  warm_s: number | null;
  /** Mean core seconds of a design, searches and steps together. */
  design_s: number | null;
  /** Remaining core seconds at that mean. */
  left_s: number | null;
}

/** A job array for a scheduler. The JSON document of `swimmer sweep submit`; the front end writes the script. */
export interface SweepSubmitOutput {
  /** Number of designs of the plan. */
  tasks: number;
  /** Number of solved designs. */
  done: number;
  /** Number of designs without a gait. */
  failed: number;
  /** Number of shards, each a task of the job array. */
  shards: number;
  /** Number of cores of each task. */
  cores: number;
  /** Time limit of each task [min]. */
  minutes: number;
  /** Script of the job array. */
  script: string;
  /** Number of the job array; null if it was not submitted. */
  job: string | null;
}

/** All presets. The JSON document of `swimmer swimmers`. */
export interface SwimmersOutput {
  /** The presets. */
  swimmers: PresetOutput[];
}

/** A gait with the paper's symmetries. */
export interface SymmetricDisplacementOutput {
  /** Displacement per cycle over the total length, with its sign. */
  displacement_over_length: number;
  /** Displacement per cycle [m]. */
  displacement_m: number;
  /** φ₁ = φ₂ at the start [rad]. */
  start_angle_rad: number;
  /** φ₂ = −φ₁ at the end of the quarter [rad]. */
  end_angle_rad: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** The gait runs clockwise, and the quarter is that of the counter-clockwise gait; displacement gaits only. */
  clockwise?: boolean | null;
  /** Number of extremals that the search found in the class, if it counts them. */
  extremals?: number | null;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** A gait with the paper's symmetries. */
export interface SymmetricEfficiencyOutput {
  /** Efficiency ξ of the gait as timed. */
  efficiency: number;
  /** Displacement per cycle over the total length, with its sign. */
  displacement_over_length: number;
  /** Displacement per cycle [m]. */
  displacement_m: number;
  /** φ₁ = φ₂ at the start [rad]. */
  start_angle_rad: number;
  /** φ₂ = −φ₁ at the end of the quarter [rad]. */
  end_angle_rad: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** The gait runs clockwise, and the quarter is that of the counter-clockwise gait; displacement gaits only. */
  clockwise?: boolean | null;
  /** Efficiency by that method, if it is a solver of its own. */
  direct_efficiency?: number | null;
  /** Efficiency at constant power, if a limit on the rate changes the timing. */
  efficiency_constant_power?: number | null;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Method of the initial guess. */
  method?: string;
  /** (max − min)/mean of the power. */
  power_variation?: number | null;
  /** Largest residual: of the shooting conditions, or of the gradient of ln ξ for a robust gait. */
  residual?: number | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** The estimate with systematic errors. */
export interface SystematicsPart {
  /** r_s [m]. */
  sphere_radius_m: number;
  /** χ. */
  chi: number;
  /** Parameters with a prior, and their estimates. */
  parameters: Nuisance[];
  /** A better explanation of the runs. */
  unforeseen: Unforeseen[];
  /** Values that were left out. */
  outliers: OutlierPart[];
}

/** Summary of a tracking file, under the keys of the JSON output. */
export interface TracksOutput {
  /** Its format. */
  format: string;
  /** Rows a second, as in `TrackFile::rate_hz`; null in JSON if there is a single frame without a rate. */
  rate_hz: number | null;
  /** The unit of length in the file. */
  unit: string;
  /** Rows with data. */
  frames: number;
  /** Its points, in the order of the file. */
  points: PointPresence[];
  /** Irregularities that the reader noticed. */
  warnings: string[];
}

/** The gait. The JSON document of `swimmer optimize turning`. */
export interface TurningOutput {
  /** Rotation per cycle [rad]. */
  rotation_rad: number;
  /** Number of connected regions of positive θ curvature. */
  regions: number;
  /** Displacement along the heading at the first sample, over the total length. */
  displacement_over_length: number;
  /** Displacement across that heading, over the total length. */
  lateral_over_length: number;
  /** Arcs in order. */
  arcs: Arc[];
  /** Share of the cycle in which links cross. */
  links_cross: number;
  /** Certificate. */
  certificate: Certificate;
  /** Gait file, if the front end wrote one. */
  gait?: string | null;
  /** Duration of the search [s], if the front end has a clock. */
  seconds?: number | null;
  /** Timing under a limit on the servos' rate, if one was given. */
  timing?: GaitTiming | null;
}

/** Error without a prior that the runs require. */
export interface Unforeseen {
  /** Its name. */
  name: string;
  /** m, rad, or nothing. */
  unit: string;
  /** Estimate. */
  value: number;
  /** Growth of the log-likelihood. */
  gain: number;
  /** ln of the odds of the runs with and without it, each optimum with its neighbourhood. */
  log_odds: number;
  /** Remedy. */
  remedy: string;
}

/** Verdict of a certificate. */
export type Verdict = "pass" | "fail" | "undecided";

/** Optimality conditions of the logarithm of the objective, in the coefficients [rad]. */
export interface WaveformConditions {
  /** Largest component of the gradient of the Lagrangian. */
  stationarity: number;
  /** Largest product of a multiplier and the slack of its bound. */
  complementarity: number;
  /** The second variation is negative along the active bounds. */
  second_variation_negative: boolean;
}

/** One cycle. */
export interface WaveformCycle {
  /** Displacement over the total length. */
  displacement_over_length: number;
  /** Displacement [m]. */
  displacement_m: number;
  /** Displacement per second [m/s]. */
  speed_m_per_s: number;
  /** Lighthill's efficiency as parametrised: that of the motor, since the spring does no work over a cycle. */
  efficiency: number;
  /** Period [s]. */
  period_s: number;
  /** Relaxation time of the passive joint [s]. */
  relaxation_s: number;
  /** Passive angle at the start of the cycle [rad]. */
  passive_start_rad: number;
  /** Largest angle of the driven joint [rad]. */
  largest_angle_rad: number;
  /** Largest rate of the driven joint [rad/s]. */
  largest_rate_rad_per_s: number;
  /** Harmonics of the waveform: order, coefficients of cosine and sine [rad]. */
  waveform: WaveformHarmonic[];
  /** Stiffness of the spring [N m/rad], if the swimmer file names a fluid. */
  stiffness_n_m?: number | null;
  /** Motor work per cycle [J], if the swimmer file names a fluid. */
  work_j?: number | null;
}

/** Harmonic of a waveform. */
export interface WaveformHarmonic {
  /** Order. */
  order: number;
  /** Coefficient of the cosine [rad]. */
  cos_rad: number;
  /** Coefficient of the sine [rad]. */
  sin_rad: number;
}

/** Both fits without one run. */
export interface WithoutRun {
  /** File of the run. */
  file: string;
  /** Fit with the paper's weights. */
  paper: Pair;
  /** Estimate of greatest likelihood; null if it has none. */
  likelihood: Pair | null;
}
