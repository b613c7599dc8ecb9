//! Searches that report their progress, and end when that is requested.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use operations::optimize::{self, Request};
use operations::{Cancel, Context, Progress};

/// Number of reports of a search that is cancelled at one of them, and `true` if it has an output all the same.
fn reports(request: &str, cancel_at: usize) -> (usize, bool) {
    let request: Request = serde_json::from_str(request).unwrap();
    let count = Arc::new(AtomicUsize::new(0));
    let cancel = Cancel::default();
    let (counted, requested) = (count.clone(), cancel.clone());
    let mut context = Context {
        cancel,
        watch: Box::new(move |progress| {
            let Progress::Share(share) = progress else {
                return;
            };
            assert!((0.0..=1.0).contains(&share), "{share}");
            if 1 + counted.fetch_add(1, Ordering::Relaxed) == cancel_at {
                requested.request();
            }
        }),
        ..Context::on_disk()
    };
    let output = Cancel::catch(|| optimize::run(&request, &mut context).unwrap());
    (count.load(Ordering::Relaxed), output.is_some())
}

#[test]
fn a_cancelled_search_ends_at_its_next_report() {
    // The request, and a number of reports that the whole search exceeds.
    for (request, least) in [
        (
            r#"{ "objective": "displacement", "swimmer": "purcell" }"#,
            3,
        ),
        (
            r#"{ "objective": "displacement", "swimmer": "robot", "bounds": { "max_angle": 1.2 } }"#,
            6,
        ),
        (r#"{ "objective": "efficiency", "swimmer": "purcell" }"#, 4),
        // The way to the bound takes steps too.
        (
            r#"{ "objective": "efficiency", "swimmer": "purcell", "bounds": { "max_angle": 0.6 } }"#,
            8,
        ),
        (
            r#"{ "objective": "efficiency", "swimmer": "purcell", "method": "collocation" }"#,
            1,
        ),
        (
            r#"{ "objective": "efficiency", "swimmer": "purcell", "order": 2, "robust": { "gain": [0.98, 1.02] } }"#,
            4,
        ),
    ] {
        let (whole, has_output) = reports(request, usize::MAX);
        assert!(has_output && whole > least, "{request}: {whole} reports");
        for cancel_at in [1, whole / 2] {
            assert_eq!(reports(request, cancel_at), (cancel_at, false), "{request}");
        }
    }
}
