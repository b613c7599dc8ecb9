//! What people keep on disk, read and written once: swimmer, gait and campaign files, the link log.
