//! Tests of the gait optimiser by independent methods.

mod certify;
mod changed;
mod direct;
mod displacement;
mod efficiency;
mod efficiency_any_swimmer;
mod height_map;
mod media;
mod neighbours;
mod paper_shooting;
mod plane;
mod relaxing;
mod speed;
mod speed_comparison;
mod speed_direct;
mod steer;
mod swimmers;
mod turning;
mod two_hundred_swimmers;
