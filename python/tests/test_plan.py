"""Plans to a target."""

import json
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest
import swimmer as sw


def test_a_plan_is_that_of_the_command(straight: Path, tmp_path: Path) -> None:
    planned = sw.plan("robot", to=(0.06, 0.04), tank=(1.6, 1.2), gaits=straight, playable=True)
    assert 0 < planned.chains_within_walls <= planned.chains
    assert planned.off_m <= 5e-4
    assert planned.duration_s == pytest.approx(sum(step.cycles * step.period_s for step in planned.steps))
    command = shutil.which("swimmer", path=sysconfig.get_path("scripts"))
    assert command is not None
    line = [command, "plan", "--swimmer=robot", "--to=0.06,0.04", "--tank=1.6x1.2", f"--gaits={straight}", "--playable", "--json"]
    printed = subprocess.run(line, check=True, capture_output=True).stdout
    assert json.loads(printed) == planned.to_dict()
    # The same target as a text, from elsewhere, with a swimmer in memory.
    moved = sw.plan(
        sw.Swimmer.preset("robot"), to="0.16,0.04", from_=(0.1, 0.0, 0.0), tank="1.6x1.2", gaits=straight, playable=True
    )
    assert [step.gait for step in moved.steps] == [step.gait for step in planned.steps]
    assert moved.reached.x_m == pytest.approx(planned.reached.x_m + 0.1, abs=1e-9)


def test_a_playlist_is_written_with_its_gaits(straight: Path, tmp_path: Path) -> None:
    playlist = tmp_path / "there.playlist"
    planned = sw.plan("robot", to=(0.06, 0.04), gaits=straight, playable=True, output=playlist)
    assert planned.playlist == str(playlist)
    text = playlist.read_text(encoding="utf-8")
    for step in planned.steps:
        assert step.gait in text
        gait = sw.Gait.load(tmp_path / step.gait)
        # Each begins and ends at the straight shape.
        assert abs(gait.at(0.0)).max() < 1e-9
    with pytest.raises(sw.BadInput, match="exists"):
        sw.plan("robot", to=(0.06, 0.04), gaits=straight, playable=True, output=playlist)
