"""The link log as other programs read it: with the `mcap` package, which shares nothing with the code that writes it."""

import json
import math
import subprocess
import sysconfig
from pathlib import Path

import jsonschema
import pytest
from mcap.reader import make_reader


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("link") / "link.mcap"
    command = Path(sysconfig.get_path("scripts")) / "swimmer"
    play = ["robot", "play", "--gait=circle:70deg", "--cycles=1", "--port=twin", f"--log={path}"]
    subprocess.run([command, *play], check=True, capture_output=True)
    return path


def test_every_message_follows_the_schema_in_the_file(log: Path) -> None:
    topics = set()
    with log.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert schema is not None and schema.encoding == "jsonschema"
            jsonschema.validate(json.loads(message.data), json.loads(schema.data))
            topics.add((channel.topic, schema.name))
    assert topics == {
        ("/link/to_robot", "swimmer.LinkFrame"),
        ("/link/from_robot", "swimmer.LinkFrame"),
        ("/robot/telemetry", "swimmer.Telemetry"),
        ("/robot/scene", "foxglove.SceneUpdate"),
    }


def test_the_scene_has_the_lengths_of_the_robot(log: Path) -> None:
    scenes = 0
    with log.open("rb") as file:
        for _, _, message in make_reader(file).iter_messages(topics=["/robot/scene"]):
            (swimmer,) = json.loads(message.data)["entities"]
            (line,) = swimmer["lines"]
            points = [(point["x"], point["y"]) for point in line["points"]]
            lengths = [math.dist(*pair) for pair in zip(points, points[1:], strict=False)]
            assert lengths == pytest.approx([0.137, 0.071, 0.137], abs=3e-5)
            assert swimmer["spheres"][0]["size"]["x"] == pytest.approx(2 * 0.0692)
            scenes += 1
    # Five times a second for a cycle of 30 s and its start.
    assert 120 < scenes < 200
