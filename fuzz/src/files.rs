//! What must hold of tracks however the file looked: whole numbers of frames, finite numbers.

use calibrate::TrackFile;

/// Panics where tracks hold a number that is none.
pub fn sane(file: &TrackFile) {
    assert!(
        file.times.iter().all(|time| time.is_finite()),
        "a time that is no number"
    );
    assert_eq!(file.times.len(), file.frame_numbers.len());
    for point in &file.points {
        let positions = (0..file.frames()).filter_map(|row| point.position(row));
        for position in positions {
            assert!(
                position.iter().all(|value| value.is_finite()),
                "a position that is no number: {position:?}"
            );
        }
        assert!(point.present() <= file.frames());
        assert!(point.longest_gap() <= file.frames());
    }
}
