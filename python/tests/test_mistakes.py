"""Common mistakes: the error names the argument as Python knows it, and never a flag of the command."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import swimmer as sw

MISTAKES: dict[str, tuple[Callable[[], object], str]] = {
    "angle in degrees": (lambda: sw.optimize.displacement("purcell", max_angle=120.0), r"max_angle.*120\.0deg"),
    "negative angle": (lambda: sw.optimize.displacement("purcell", max_angle=-1.0), "max_angle"),
    "angle that is no number": (lambda: sw.optimize.turning("purcell", max_angle="wide"), "max_angle"),
    "sign": (lambda: sw.optimize.displacement("purcell", sign="plus"), "sign"),  # type: ignore[arg-type]
    "missing rate": (lambda: sw.optimize.speed("purcell"), "max_rate"),
    "rate in degrees": (lambda: sw.optimize.speed("robot", max_rate=200.0), r"max_rate.*200\.0deg"),
    "negative clearance": (lambda: sw.certify("robot", "circle:1", clearance=-0.1), "clearance = -0.1"),
    "angle of a certificate": (lambda: sw.certify("robot", "circle:1", max_angle=90.0), r"max_angle.*90\.0deg"),
    "objective": (lambda: sw.certify("robot", "circle:1", objective="far"), "objective = \"far\": choose"),  # type: ignore[arg-type]
    "missing objective": (lambda: sw.certify("robot", sw.Gait.circle(1.0)), "no objective"),
    "row": (lambda: sw.height_map("robot", row="z"), "row = \"z\": choose x, y or theta"),  # type: ignore[arg-type]
    "angle of a map": (lambda: sw.height_map("robot", max_angle=160.0), r"max_angle.*160\.0deg"),
    "cycles": (lambda: sw.simulate("robot", "circle:1", cycles=0), "cycles = 0"),
    "period": (lambda: sw.simulate("robot", "circle:1", period=-30.0), r"period = -30\.0"),
    "knots without played": (lambda: sw.simulate("robot", "circle:1", knots=64), "knots and pulse_step.*played=True"),
    "spring without joint": (lambda: sw.simulate("robot", "circle:1", stiffness=0.002), "passive front"),
    "sine without joint": (lambda: sw.simulate("robot", "sine:1"), "passive"),
    "swimmer": (lambda: sw.simulate("purcel", "circle:1"), "purcel"),
    "gait": (lambda: sw.simulate("purcell", "circel:1"), "did you mean circle:1"),
    "gait file": (lambda: sw.simulate("purcell", "missing.gait"), "missing.gait"),
    "target": (lambda: sw.plan("robot", to="there", max_rate=3.0), "to"),
    "target in degrees": (lambda: sw.plan("robot", to=(0.2, 0.1, 90.0), max_rate=3.0), r"90\.0deg"),
    "starts": (lambda: sw.atlas("purcell", objective="displacement", starts=0), "starts"),
    "column of angles": (lambda: sw.Gait(np.zeros((5, 3))), "joint angles have shape"),
    "link in millimetres": (lambda: sw.Swimmer(middle=71.0, side=137.0), "did you mean"),
    "one side link": (lambda: sw.Swimmer(middle=0.07, front=0.1), "side, or front and back"),
    "level": (lambda: sw.calibrate("campaign.toml", level=95.0), "level"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_as_in_python(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    call, expected = MISTAKES[name]
    with pytest.raises((sw.BadInput, TypeError)) as refused:
        call()
    message = str(refused.value)
    assert re.search(expected, message, re.DOTALL), message
    outside_of_commands = re.sub(r"`swimmer [^`]*`", "", message)
    assert not re.search(r"(^|\s)--[a-z]", outside_of_commands), message
    assert "<" not in outside_of_commands, message
