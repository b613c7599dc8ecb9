"""Reads a unicast NatNet stream with the package `natnet` and writes what it decoded as JSON.

Usage: read_stream.py HOST PORT SECONDS FILE.json
"""

import json
import sys
import time

from natnet import NatNetClient


def frame_of(frame):
    return {
        "number": frame.prefix.frame_number,
        "t": frame.suffix.timestamp,
        "exposure": frame.suffix.stamp_camera_mid_exposure,
        "transmit": frame.suffix.stamp_transmit,
        "sets": {s.model_name: s.marker_pos_list for s in frame.marker_sets},
        "labeled": [
            {
                "model": marker.model_id,
                "member": marker.marker_id,
                "position": marker.pos,
                "occluded": marker.occluded,
                "unlabeled": marker.unlabeled,
            }
            for marker in frame.labeled_markers
        ],
        "bodies": [
            {"id": body.id_num, "position": body.pos, "rotation": body.rot, "valid": body.tracking_valid}
            for body in frame.rigid_bodies
        ],
    }


def main():
    host, port, seconds, path = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
    client = NatNetClient(host, "127.0.0.1", command_port=port, use_multicast=False)
    frames, descriptions = [], []
    client.on_data_frame_received_event.handlers.append(lambda frame: frames.append(frame_of(frame)))
    client.on_data_description_received_event.handlers.append(descriptions.append)
    with client:
        client.request_modeldef()
        client.run_async()
        time.sleep(seconds)
        client.stop_async()
        server = client.server_info
    model = descriptions[-1]
    with open(path, "w", encoding="utf-8") as file:
        json.dump(
            {
                "application": server.application_name,
                "version": str(server.nat_net_protocol_version),
                "sets": {s.name: s.marker_names for s in model.marker_sets},
                "bodies": {
                    body.name: {"id": body.id_num, "markers": [marker.name for marker in body.markers]}
                    for body in model.rigid_bodies
                },
                "frames": frames,
            },
            file,
        )


if __name__ == "__main__":
    main()
