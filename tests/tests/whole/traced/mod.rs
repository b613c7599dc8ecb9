//! A twin at a port that keeps every frame, as a link log would.

use std::sync::{Arc, Mutex};

use host_link::port::{TracedFrame, TracedPort};
use swimmer_files::LinkFrame;
use twin::{Twin, TwinConfig, TwinPort, WireSpeed};

/// The frames so far.
pub(crate) type Frames = Arc<Mutex<Vec<LinkFrame>>>;

/// The port, and the frames that pass it.
pub(crate) fn traced(
    config: TwinConfig,
) -> (
    TracedPort<TwinPort, impl FnMut(TracedFrame<'_>) + Send>,
    Frames,
) {
    let frames = Frames::default();
    let sink = Arc::clone(&frames);
    let port = TwinPort::new(Twin::new(config).unwrap(), WireSpeed::robot());
    let traced = TracedPort::new(port, move |frame: TracedFrame<'_>| {
        sink.lock().unwrap().push(LinkFrame {
            direction: frame.direction,
            host_time_ns: u64::try_from(frame.at.as_nanos()).unwrap(),
            robot_time_us: None,
            bytes: frame.bytes.to_vec(),
        });
    });
    (traced, frames)
}
