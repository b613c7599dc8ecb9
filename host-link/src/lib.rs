//! The host end of the wire: ports, session, upload, telemetry.
