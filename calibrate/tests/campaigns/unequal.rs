//! Swimmers with unequal side links: a twin swims, cameras follow the reflectors of the middle link, and the fit recovers the drag.

use calibrate::{FitOptions, calibrate_campaign};
use swimmer_model::{Links, Swimmer};

use crate::twin_campaigns::Laboratory;

#[test]
fn the_drag_of_unequal_side_links_is_recovered() {
    for (front, back, chi) in [(0.137, 0.1, 3.2), (0.11, 0.14, 2.6)] {
        let robot = Swimmer::robot();
        let links = Links {
            front,
            back,
            ..robot.links
        };
        let laboratory = Laboratory {
            swimmer: Swimmer {
                links,
                chi,
                sphere_radius: 0.06,
                ..robot
            },
            ..Laboratory::quiet(11)
        };
        let (mut campaign, data) = laboratory.campaign();
        let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
            .unwrap()
            .fit;
        let errors = [fit.chi / chi, fit.sphere_radius / 0.06].map(|share| share - 1.0);
        println!(
            "{front} m and {back} m: χ {:+.4}, r_s {:+.4}",
            errors[0], errors[1]
        );
        assert!(errors.iter().all(|error| error.abs() < 0.005), "{errors:?}");
        // With equal side links of the same mean length the residuals are more than ten times larger.
        campaign.swimmer.swimmer.links = Links {
            front: 0.5 * (front + back),
            back: 0.5 * (front + back),
            ..links
        };
        let equal = calibrate_campaign(&campaign, &data, FitOptions::default())
            .unwrap()
            .fit;
        println!(
            "  fitted with equal links: χ {:.3}, rmse {:.2e} in place of {:.2e}",
            equal.chi, equal.rmse, fit.rmse
        );
        assert!(equal.rmse > 10.0 * fit.rmse);
    }
}
