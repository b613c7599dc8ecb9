"""An experiment on the twin: planned, run, reported, and interrupted."""

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import swimmer as sw

SPEC = """
swimmer = "robot"
repeats = 2
cycles = 1
period = 12.0
settle = 2.0
drive = "drive"
[tank]
length = 1.6
width = 1.2
[start]
x = -0.1
[[gait]]
gait = "circle:70deg"
[[gait]]
name = "mine"
gait = "mine.gait"
neighbours = 0.1
"""


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory, robot: sw.Swimmer, straight: Path) -> Path:
    folder = tmp_path_factory.mktemp("experiment")
    shutil.copytree(straight, folder / "drive")
    best = sw.optimize.displacement(robot, max_angle=1.2, playable=True)
    best.to_gait_file(folder / "mine.gait")
    path = folder / "small.toml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="module")
def planned(spec: Path) -> sw.experiment.Plan:
    with pytest.warns(sw.Doubt, match="the servos of the twin are assumed"):
        return sw.experiment.plan(spec)


def test_a_plan_holds_gaits(planned: sw.experiment.Plan, robot: sw.Swimmer) -> None:
    assert [gait.name for gait in planned.gaits] == ["circle-70deg", "mine", "mine-10", "mine+10"]
    assert len(planned.trials) == planned.runs == 8
    for gait in planned.gaits:
        forecast = sw.simulate(robot, gait.gait, played=True, period=gait.period_s).played
        predicted = math.hypot(*gait.predicted_xy_m)
        assert predicted == pytest.approx(math.hypot(forecast.displacement_m, forecast.lateral_m), rel=0.02)
    with pytest.raises(AttributeError, match="frozen"):
        planned.runs = 9


def test_a_run_measures_what_is_predicted(spec: Path, planned: sw.experiment.Plan) -> None:
    assert sw.experiment.status(spec).done == 0
    run = sw.experiment.run(spec, "twin")
    assert (run.done, run.given_up, run.finished_now) == (8, 0, 8)
    assert sw.experiment.run(spec, "twin").finished_now == 0
    status = sw.experiment.status(spec)
    assert (status.done, status.next, status.interruption) == (8, None, None)
    report = sw.experiment.report(spec)
    for gait in report.gaits:
        assert gait.runs == 2 and gait.measured_m == pytest.approx(gait.predicted_m, rel=0.03)
    assert {(one.better, one.than) for one in report.comparisons} == {("mine", "mine-10"), ("mine", "mine+10")}
    axes = report.plot()
    assert [label.get_text() for label in axes.get_xticklabels()] == [gait.gait for gait in report.gaits]
    words = [sys.executable, "-m", "swimmer", "experiment", "report", str(spec), "--json"]
    command = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    assert report.to_dict() == command


@pytest.mark.skipif(sys.platform == "win32", reason="os.kill sends no Ctrl-C there")
def test_ctrl_c_interrupts_and_the_same_call_goes_on(spec: Path, planned: sw.experiment.Plan, tmp_path: Path) -> None:
    program = f"""
import os, signal, threading
import swimmer as sw
signal.signal(signal.SIGINT, signal.default_int_handler)
sw.experiment.plan({str(spec)!r}, folder={str(tmp_path / "other")!r})
threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    sw.experiment.run({str(spec)!r}, "twin", folder={str(tmp_path / "other")!r})
except KeyboardInterrupt:
    print("interrupted")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert ended.stdout.split() == ["interrupted"], ended
    status = sw.experiment.status(spec, folder=tmp_path / "other")
    assert status.done < 8
    assert sw.experiment.run(spec, "twin", folder=tmp_path / "other").done == 8


def test_mistakes_are_named(spec: Path, planned: sw.experiment.Plan, tmp_path: Path) -> None:
    with pytest.raises(sw.BadInput, match="name the source of the cameras' frames"):
        sw.experiment.run(spec, "/dev/ttyACM9")
    with pytest.raises(sw.BadInput, match="is not empty"):
        sw.experiment.plan(spec)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(SPEC.replace("repeats = 2", "repeats = 0"))
    with pytest.raises(sw.BadInput, match="0 is not between 1"):
        sw.experiment.plan(wrong)
    with pytest.raises(sw.BadInput, match="no planned experiment"):
        sw.experiment.status(spec, folder=tmp_path)
