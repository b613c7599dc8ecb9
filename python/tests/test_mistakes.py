"""Bad values: the error names the keyword as Python knows it, and never an option of the command."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import swimmer as sw

NO_DRAG = sw.Swimmer.preset("purcell")
FIT = sw.Result({"chi": 2.0})

MISTAKES: dict[str, tuple[Callable[[], object], str]] = {
    # optimize
    "angle in degrees": (lambda: sw.optimize.displacement("purcell", max_angle=120.0), r"max_angle=120\.0: .*120\.0deg"),
    "negative angle": (lambda: sw.optimize.displacement("purcell", max_angle=-1.0), r"max_angle=-1\.0: give an angle above zero"),
    "angle that is no number": (lambda: sw.optimize.turning("purcell", max_angle="wide"), "max_angle='wide': "),
    "angle that is a list": (lambda: sw.optimize.turning("purcell", max_angle=[1.0]), r"max_angle=\[1\.0\]: give an angle"),  # type: ignore[arg-type]
    "least angle": (lambda: sw.optimize.displacement("purcell", min_angle=0.0), r"min_angle=0\.0: give an angle above zero"),
    "sector": (lambda: sw.optimize.displacement("purcell", sector="yes"), "sector='yes': give True or False"),  # type: ignore[arg-type]
    "clearance": (lambda: sw.optimize.sideways("purcell", clearance="5mm"), "clearance='5mm': give a length in metres"),  # type: ignore[arg-type]
    "sign": (lambda: sw.optimize.displacement("purcell", sign="plus"), 'sign=\'plus\': choose "\\+" or "-"'),  # type: ignore[arg-type]
    "sign of unlike side links": (lambda: sw.optimize.displacement(NO_DRAG.replace(front=1.5), sign="+"), "^sign is that of"),
    "period without rate": (lambda: sw.optimize.displacement("purcell", period=30.0), "also give max_rate"),
    "rate without period": (lambda: sw.optimize.efficiency("purcell", max_rate=3.0), "also give its period"),
    "statistic alone": (lambda: sw.optimize.displacement("purcell", over="mean"), "over='mean': .* robust or gain"),
    "gain": (lambda: sw.optimize.displacement("purcell", gain=(1.02, 0.98)), r"gain=\(1\.02, 0\.98\): give the least"),
    "fit that is none": (lambda: sw.optimize.displacement("purcell", robust=FIT), "a fit is the result of calibrating"),
    "fit that is missing": (lambda: sw.optimize.displacement("purcell", robust="fit.json"), "cannot read the fit fit.json"),
    "gait": (lambda: sw.optimize.efficiency("purcell", gait="middle"), 'gait=\'middle\': choose "small" or "large"'),  # type: ignore[arg-type]
    "method": (lambda: sw.optimize.efficiency("purcell", method="luck"), "method='luck': choose"),  # type: ignore[arg-type]
    "order alone": (lambda: sw.optimize.efficiency("purcell", order=8), "order .* give robust or gain"),
    "large gait of unlike side links": (lambda: sw.optimize.efficiency(NO_DRAG.replace(front=1.5), gait="large"), 'gait="large" and method'),
    "missing rate": (lambda: sw.optimize.speed("purcell"), "give max_rate or playable=True"),
    "rate in degrees": (lambda: sw.optimize.speed("robot", max_rate=200.0), r"max_rate=200\.0: .*200\.0deg"),
    "three rates": (lambda: sw.optimize.speed("robot", max_rate=(1.0, 2.0, 3.0)), "max_rate=.*one for each of the two servos"),
    "heading": (lambda: sw.optimize.speed("robot", max_rate=3.0, heading="up"), "heading='up': choose"),  # type: ignore[arg-type]
    "front with period": (lambda: sw.optimize.speed("robot", max_rate=3.0, front="front.svg", period=9.0), "leave out period"),
    "front of another kind": (lambda: sw.optimize.speed("robot", max_rate=3.0, front="front.gif"), "cannot tell from `front.gif` what to write"),
    "rate to steer by": (lambda: sw.optimize.steer("robot"), "give max_rate or playable=True"),
    "shape": (lambda: sw.optimize.steer("robot", playable=True, shape="80deg"), "shape='80deg': give two angles"),
    "folder that is full": (lambda: sw.optimize.steer("robot", playable=True, output="."), "not empty; name another one with output,"),
    "joint": (lambda: sw.optimize.passive("purcell", passive="middle"), "passive='middle': a joint is front or back"),  # type: ignore[arg-type]
    "missing joint": (lambda: sw.optimize.passive("purcell"), 'name the passive joint by passive="front" or passive="back"'),
    "missing spring": (lambda: sw.optimize.passive("purcell", passive="front"), 'relaxation="free" for the best one'),
    "two springs": (lambda: sw.optimize.passive("purcell", passive="front", stiffness=1.0, relaxation=1.0), "stiffness and relaxation"),
    "relaxation": (lambda: sw.optimize.passive("purcell", passive="front", relaxation="slow"), 'relaxation=\'slow\': .* or "free"'),  # type: ignore[arg-type]
    "harmonics": (lambda: sw.optimize.passive("purcell", harmonics=9), "harmonics=9: give a whole number from 1 to 8"),
    # certify
    "negative clearance": (lambda: sw.certify("robot", "circle:1", clearance=-0.1), r"clearance=-0\.1: "),
    "angle of a certificate": (lambda: sw.certify("robot", "circle:1", max_angle=90.0), r"max_angle=90\.0: .*90\.0deg"),
    "objective": (lambda: sw.certify("robot", "circle:1", objective="far"), "objective='far': choose"),  # type: ignore[arg-type]
    "missing objective": (lambda: sw.certify("robot", sw.Gait.circle(1.0)), "no objective"),
    # height_map
    "row": (lambda: sw.height_map("robot", row="z"), 'row=\'z\': choose "x", "y" or "theta"'),  # type: ignore[arg-type]
    "angle of a map": (lambda: sw.height_map("robot", max_angle=160.0), r"max_angle=160\.0: .*160\.0deg"),
    "gait of a map": (lambda: sw.height_map("robot", gait=[3]), "gait=3: give a Gait"),  # type: ignore[list-item]
    # simulate
    "cycles": (lambda: sw.simulate("robot", "circle:1", cycles=0), "cycles=0: give a whole number from 1 to 10000"),
    "cycles in words": (lambda: sw.simulate("robot", "circle:1", cycles="two"), "cycles='two': give a whole number"),  # type: ignore[arg-type]
    "period": (lambda: sw.simulate("robot", "circle:1", period=-30.0), r"period=-30\.0: give a number of seconds"),
    "knots without played": (lambda: sw.simulate("robot", "circle:1", knots=64), "knots=64: .*played=True"),
    "spring without joint": (lambda: sw.simulate("robot", "circle:1", stiffness=0.002), 'passive="front" or passive="back"'),
    "sine without joint": (lambda: sw.simulate("robot", "sine:1"), 'passive="front"'),
    "limit cycle without joint": (lambda: sw.simulate("robot", "circle:1", output="mine.gait"), "^output is the limit cycle .* passive,"),
    "picture of another kind": (lambda: sw.simulate("robot", "circle:1", picture="way.txt"), "way.txt"),
    "width without picture": (lambda: sw.simulate("robot", "circle:1", width=85), "width=85: .*also give picture"),
    "width of an animation": (lambda: sw.simulate("robot", "circle:1", picture="way.gif", width=85), "width is for figures"),
    "width": (lambda: sw.simulate("robot", "circle:1", picture="way.svg", width=100), "width=100: give 85"),  # type: ignore[arg-type]
    "swimmer": (lambda: sw.simulate("purcel", "circle:1"), "purcel"),
    "swimmer that is a number": (lambda: sw.simulate(3, "circle:1"), "swimmer=3: give a Swimmer"),  # type: ignore[arg-type]
    "closed form": (lambda: sw.simulate("purcell", "circel:1"), "did you mean circle:1"),
    "gait file": (lambda: sw.simulate("purcell", "missing.gait"), "missing.gait"),
    # atlas
    "starts": (lambda: sw.atlas("purcell", objective="displacement", starts=0), "starts=0: give a whole number from 1"),
    "objective of an atlas": (lambda: sw.atlas("purcell", objective="turning"), "objective='turning': choose"),  # type: ignore[arg-type]
    "rate of an atlas": (lambda: sw.atlas("purcell", objective="speed"), "give max_rate, or playable=True"),
    "parameter": (lambda: sw.atlas("purcell", objective="efficiency", continue_="mass=1..2"), "continue_='mass=1..2': write a parameter"),
    "gait to follow": (lambda: sw.atlas("purcell", objective="efficiency", continue_="chi=2..1", gait="best"), "gait='best': choose"),
    "gait that is not followed": (lambda: sw.atlas("purcell", objective="efficiency", gait="small"), "gait='small': .*continue_"),
    "gait of displacement": (lambda: sw.atlas("purcell", objective="displacement", continue_="chi=2..1", gait="small"), 'for objective="displacement"'),
    "speed that is followed": (lambda: sw.atlas("purcell", objective="speed", max_rate=3.0, continue_="chi=2..1"), "^continue_ follows"),
    # plan
    "target": (lambda: sw.plan("robot", to="there", max_rate=3.0), "to"),
    "target in degrees": (lambda: sw.plan("robot", to=(0.2, 0.1, 90.0), max_rate=3.0), r"90\.0deg"),
    "target with a word": (lambda: sw.plan("robot", to=(0.2, "wide"), max_rate=3.0), "to=.*give .x, y. in metres"),  # type: ignore[arg-type]
    "start": (lambda: sw.plan("robot", to=(0.2, 0.1), from_=(0.2,), max_rate=3.0), r"from_=\(0\.2,\): give"),
    "tank": (lambda: sw.plan("robot", to=(0.2, 0.1), tank=(1.0, -1.0), max_rate=3.0), "tank=.*length and width"),
    "margin": (lambda: sw.plan("robot", to=(0.2, 0.1), margin=-1.0, max_rate=3.0), r"margin=-1\.0: give a length"),
    "rate of a plan": (lambda: sw.plan("robot", to=(0.2, 0.1)), "give max_rate or playable=True"),
    "shape of a folder": (lambda: sw.plan("robot", to=(0.2, 0.1), gaits=".", shape=(0.0, 0.0), max_rate=3.0), "shape=.*leave it out"),
    "gaits of a plan": (lambda: sw.plan("robot", to=(0.2, 0.1), gaits=".", max_rate=3.0), "forward.gait"),
    "playlist": (lambda: sw.plan("robot", to=(0.2, 0.1), max_rate=3.0, output="kept"), "kept exists"),
    # calibrate and tracks
    "level": (lambda: sw.calibrate("campaign.toml", level=95.0), r"level=95\.0: give a share between 0 and 1"),
    "nuisance": (lambda: sw.calibrate("campaign.toml", fit_also="luck"), "fit_also='luck': choose from ct, offsets"),
    "period of a campaign": (lambda: sw.calibrate("campaign.toml", period=15.0), r"period=15\.0: .*single tracking file"),
    "missing campaign": (lambda: sw.calibrate("campaign.toml"), "campaign.toml"),
    "gait of a recording": (lambda: sw.calibrate("run.csv"), "name the gait: gait, period and swimmer"),
    "axes": (lambda: sw.tracks("run.csv", axes="up"), "axes='up': "),
    "scale": (lambda: sw.tracks("run.csv", scale=0), "scale=0: give the metres per unit"),
    "missing recording": (lambda: sw.tracks("run.csv"), "run.csv"),
    # Gait and Swimmer
    "column of angles": (lambda: sw.Gait(np.zeros((5, 3))), "joint angles have shape"),
    "no closed curve": (lambda: sw.Gait(np.zeros((1, 2))), "gait from samples"),
    "phase": (lambda: sw.Gait.circle(1.0).at(np.nan), "fraction of the period"),
    "amplitude in degrees": (lambda: sw.Gait.circle(70.0), "did you mean 70.0deg"),
    "link in millimetres": (lambda: sw.Swimmer(middle=71.0, side=137.0), "did you mean"),
    "one side link": (lambda: sw.Swimmer(middle=0.07, front=0.1), "side, or front and back"),
    "preset": (lambda: sw.Swimmer.preset("purcel"), "there is no preset"),
    "swimmer file": (lambda: sw.Swimmer.from_toml("middle"), "swimmer.toml"),
    # Robot and experiment
    "axes of cameras": (lambda: sw.Robot("twin", axes="sideways"), "axes='sideways': "),
    "scale of cameras": (lambda: sw.Robot("twin", scale=-1.0), r"scale=-1\.0: give the metres per unit"),
    "heading": (lambda: sw.Robot("twin", facing=90.0), r"facing=90\.0: .*90\.0deg"),
    "cameras of a twin": (lambda: sw.Robot("twin", track="tcp:nowhere"), "tcp:HOST:PORT"),
    "baud": (lambda: sw.Robot("twin", baud=0), "baud=0: give a whole number"),
    "experiment without cameras": (lambda: sw.experiment.run("missing.toml", "/dev/ttyACM9"), "name the source of the cameras' frames"),
    "missing spec": (lambda: sw.experiment.plan("missing.toml"), "missing.toml"),
    "no experiment": (lambda: sw.experiment.status("missing.toml"), "missing"),
    "no report": (lambda: sw.experiment.report("missing.toml"), "missing"),
    # sweep
    "missing sweep": (lambda: sw.sweep.plan("missing.toml", output="small"), "missing.toml"),
    "shard": (lambda: sw.sweep.run("small", shard="three"), "shard='three': .*2/7"),
    "threads": (lambda: sw.sweep.run("small", threads=0), "threads=0: give a whole number from 1 to 1024"),
    "axis": (lambda: sw.sweep.map("small", up="chi"), "up='chi': an axis is one of .*drag.chi"),
    "axis of a value": (lambda: sw.sweep.map("small", at={"chi": 2}), "at=.*an axis is one of"),
    "value of an axis": (lambda: sw.sweep.map("small", at={"drag.chi": "much"}), "at=.*no value of drag.chi"),
    "values of axes": (lambda: sw.sweep.map("small", at="drag.chi=2"), "at=.*give a value for each axis"),  # type: ignore[arg-type]
    "quantity": (lambda: sw.sweep.map("small", quantity="luck"), "quantity='luck': choose"),  # type: ignore[arg-type]
    "picture of a map": (lambda: sw.sweep.map("small", output="map.gif"), "map.gif"),
    "table": (lambda: sw.sweep.merge("small", output="kept"), "kept exists"),
    "no plan": (lambda: sw.sweep.status("small"), "small"),
    "table of no plan": (lambda: sw.sweep.merge("small", output="small.parquet"), "small"),
    "map of no plan": (lambda: sw.sweep.map("small"), "small"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_as_in_python(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kept").touch()
    call, expected = MISTAKES[name]
    with pytest.raises((sw.BadInput, sw.Failed)) as refused:
        call()
    message = str(refused.value)
    assert re.search(expected, message, re.DOTALL), message
    assert "--" not in message and "argument" not in message and "<" not in message, message
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_failures_and_warnings_speak_python(purcell: sw.Swimmer, robot: sw.Swimmer) -> None:
    with pytest.raises(sw.Failed) as failed:
        sw.optimize.efficiency(purcell, gait="large", max_angle=1.0)
    assert "--" not in str(failed.value)
    weak = sw.Swimmer.from_toml(robot.to_toml() + "[servo]\nmax_angle = 0.8\n")
    with pytest.warns(sw.Doubt, match=r"`swimmer\.optimize\.…\(playable=True\)`") as warned:
        sw.simulate(weak, "circle:1.2")
    assert all("--" not in str(one.message) for one in warned)
