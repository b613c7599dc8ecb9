//! The gait that carries the robot farthest within what its joints may turn, with its certificate:
//! `cargo run --release -p gait-optimizer --example farthest_gait [RADIANS]`

use gait_optimizer::{DisplacementProblem, displacement};
use swimmer_model::Swimmer;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let max_angle: f64 = std::env::args()
        .nth(1)
        .as_deref()
        .unwrap_or("2.0")
        .parse()?;
    let gait = displacement(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(max_angle))?;
    println!("X/L = {:.10} a cycle", gait.displacement_over_length);
    for arc in &gait.arcs {
        println!(
            "  {:8} from {:?} to {:?}",
            arc.kind.word(),
            arc.from,
            arc.to
        );
    }
    for check in gait.certificate.checks() {
        let verdict = if check.pass { "holds" } else { "FAILS" };
        println!(
            "  {:30} {:10.3e} of {:8.1e}  {verdict}",
            check.condition.key(),
            check.value,
            check.tolerance
        );
    }
    Ok(())
}
