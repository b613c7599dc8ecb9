//! The circle in the plane of joint angles with the largest displacement. `cargo run -p swimmer-model --example best_circle`

use swimmer_model::{Circle, InvalidSwimmer, Model, Swimmer, Tolerance, swim};

fn main() -> Result<(), InvalidSwimmer> {
    for (name, swimmer) in [("purcell", Swimmer::purcell()), ("robot", Swimmer::robot())] {
        let model = Model::new(&swimmer)?;
        let over_length = |degrees: i32| {
            let circle = Circle {
                amplitude: f64::from(degrees).to_radians(),
            };
            let swum = swim(&model, &circle, &Tolerance::default());
            (degrees, swum.displacement_over_length().x)
        };
        let best = (1..=120)
            .map(over_length)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((degrees, x)) = best {
            println!("{name}: {degrees}°, X/L = {x:.6} a cycle");
        }
    }
    Ok(())
}
