"""What comes back: frozen, with the command line's keys and sentences."""

import copy
import inspect
import json
import pickle
import re
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import swimmer as sw


@pytest.fixture(scope="module")
def swum(purcell: sw.Swimmer) -> sw.Simulation:
    return sw.simulate(purcell, "circle:1.6331625", cycles=2)


def test_keys_are_attributes_and_items(swum: sw.Simulation) -> None:
    assert swum.displacement_over_length == pytest.approx(0.0822853931, abs=5e-11)
    assert swum["displacement_over_length"] == swum.displacement_over_length
    assert "efficiency" in swum and "efficiency" in dir(swum) and len(swum) == len(swum.to_dict())
    with pytest.raises(AttributeError, match="has no speed: it has links_cross, displacement_over_length"):
        swum.speed


def test_results_are_frozen(swum: sw.Simulation, purcell: sw.Swimmer) -> None:
    with pytest.raises(AttributeError, match="frozen"):
        swum.displacement_m = 1.0
    with pytest.raises(AttributeError, match="frozen"):
        del swum.displacement_m
    with pytest.raises(TypeError):
        swum["displacement_m"] = 1.0
    with pytest.raises(AttributeError):
        purcell.chi = 3.0  # type: ignore[misc]
    document = swum.to_dict()
    document["displacement_m"] = 1.0
    assert swum.displacement_m != 1.0


def test_the_trajectory_goes_on_from_cycle_to_cycle(swum: sw.Simulation) -> None:
    way = swum.trajectory
    assert way.phi.shape == (len(way.u), 2) and way.pose.shape == (len(way.u), 3)
    assert set(way.cycle) == {0, 1} and np.all(np.diff(way.cycle + way.u) > 0)
    np.testing.assert_allclose(way.pose[-1, 0], 2 * swum.displacement_m, atol=1e-12)


def test_results_can_be_sent_and_compared(swum: sw.Simulation, purcell: sw.Swimmer) -> None:
    again = pickle.loads(pickle.dumps(swum))
    assert again == swum and hash(again) == hash(swum)
    assert np.array_equal(again.trajectory.pose, swum.trajectory.pose)
    assert json.loads(json.dumps(swum.to_dict())) == swum.to_dict()
    best = sw.optimize.turning(purcell, max_angle=1.0)
    sent = copy.deepcopy(best)
    assert sent == best and sent.gait == best.gait and sent.swimmer == best.swimmer


def test_results_show_themselves(swum: sw.Simulation, purcell: sw.Swimmer) -> None:
    assert "displacement_over_length=0.0822853" in repr(swum)
    shown = sw.optimize.turning(purcell, max_angle=1.0)._repr_html_()
    assert shown.startswith("<table>") and "<th style='text-align:left'>certificate</th>" in shown


def test_bad_input_says_what_the_command_says(purcell: sw.Swimmer, tmp_path: Path) -> None:
    missing = tmp_path / "missing.toml"
    command = [sys.executable, "-m", "swimmer", "simulate", f"--swimmer={missing}", "--gait=circle:1"]
    told = subprocess.run(command, capture_output=True, text=True)
    assert told.returncode == 2
    with pytest.raises(sw.BadInput) as refused:
        sw.simulate(missing, "circle:1")
    assert told.stderr.strip() == f"error: {refused.value}"
    with pytest.raises(sw.BadInput, match="did you mean circle:70deg"):
        sw.simulate(purcell, "circel:70deg")
    with pytest.raises(sw.BadInput, match="max_angle"):
        sw.optimize.displacement(purcell, max_angle=-1.0)
    with pytest.raises(sw.BadInput, match="there is no preset `purcel`"):
        sw.Swimmer.preset("purcel")


def test_a_slip_of_a_unit_is_bad_input(robot: sw.Swimmer) -> None:
    with pytest.raises(sw.BadInput, match="middle = 50 is in metres: did you mean 50 mm"):
        robot.replace(middle=50.0)
    with pytest.raises(sw.BadInput, match="did you mean 90.0deg"):
        sw.plan(robot, to=(0.2, 0.1, 90.0), max_rate=3.0)
    with pytest.raises(sw.BadInput, match="did you mean 200.0deg"):
        sw.optimize.speed(robot, max_rate=200.0)
    with pytest.raises(sw.BadInput, match="did you mean 70.0deg"):
        sw.Gait.circle(70.0)


def test_a_try_that_failed_says_so(purcell: sw.Swimmer) -> None:
    with pytest.raises(sw.Failed) as failed:
        sw.optimize.efficiency(purcell, gait="large", max_angle=1.0)
    assert "1" in str(failed.value) and not isinstance(failed.value, sw.BadInput)
    assert isinstance(failed.value, sw.Error)


def test_doubts_are_warnings_without_places_of_ours() -> None:
    odd = sw.Swimmer.preset("purcell").replace(chi=0.5, name="odd")
    with pytest.warns(sw.Doubt) as warned:
        sw.simulate(odd, "circle:1")
    assert len(warned) == 1 and str(warned[0].message).startswith("odd: chi = c_n/c_t = 0.5")
    assert warned[0].filename == __file__


def test_files_of_ours_are_named_shortly(robot: sw.Swimmer, purcell: sw.Swimmer) -> None:
    gait = sw.optimize.turning(purcell, max_angle=1.0).gait
    with pytest.warns(sw.Doubt, match="^the gait was made for another swimmer than robot"):
        sw.simulate(robot, gait)


@pytest.mark.parametrize(
    ("function", "path", "ours"),
    [
        (sw.simulate, ["simulate"], {"trajectory"}),
        (sw.certify, ["certify"], set()),
        (sw.atlas, ["atlas"], {"output", "width"}),
        (sw.height_map, ["height-map"], {"output", "width"}),
        (sw.calibrate, ["calibrate"], set()),
        (sw.tracks, ["tracks"], set()),
        (sw.optimize.displacement, ["optimize", "displacement"], {"output"}),
        (sw.optimize.efficiency, ["optimize", "efficiency"], {"output"}),
        (sw.optimize.turning, ["optimize", "turning"], {"output"}),
        (sw.optimize.sideways, ["optimize", "sideways"], {"output"}),
        (sw.optimize.speed, ["optimize", "speed"], {"output"}),
        (sw.optimize.steer, ["optimize", "steer"], set()),
        (sw.optimize.passive, ["optimize", "passive"], set()),
        (sw.plan, ["plan"], set()),
        (sw.sweep.plan, ["sweep", "plan"], set()),
        (sw.sweep.run, ["sweep", "run"], set()),
        (sw.sweep.merge, ["sweep", "merge"], set()),
        (sw.sweep.map, ["sweep", "map"], set()),
    ],
)
def test_keywords_are_the_commands_options(function: object, path: list[str], ours: set[str]) -> None:
    """`ours` are the options that the wheel gives itself, for files that become attributes."""
    have = {name.rstrip("_").replace("_", "-") for name in inspect.signature(function).parameters} - {"file", "folder", "spec"}  # type: ignore[arg-type]
    shown = subprocess.run([sys.executable, "-m", "swimmer", *path, "--help"], check=True, capture_output=True, text=True).stdout
    options = set(re.findall(r"^ +(?:-\w, )?--([a-z-]+)", shown, re.MULTILINE)) - {"json", "overwrite", "verbose", "help"}
    assert options, path
    assert have == options - ours


def test_calls_from_several_threads_do_not_mix(purcell: sw.Swimmer) -> None:
    answers: dict[int, float] = {}

    def swim(number: int) -> None:
        answers[number] = sw.simulate(purcell, sw.Gait.circle(0.5 + 0.1 * number)).displacement_over_length

    threads = [threading.Thread(target=swim, args=(number,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for number, answer in answers.items():
        assert answer == sw.simulate(purcell, sw.Gait.circle(0.5 + 0.1 * number)).displacement_over_length
    assert len(set(answers.values())) == 6


@pytest.mark.skipif(sys.platform == "win32", reason="os.kill sends no Ctrl-C there")
def test_ctrl_c_ends_a_long_call_at_once() -> None:
    program = """
import os, signal, threading, time
import swimmer as sw
# Who runs the tests in the background may have it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
began = time.perf_counter()
try:
    sw.atlas("purcell", objective="efficiency", starts=100_000)
except KeyboardInterrupt:
    print(time.perf_counter() - began)
# The threads of the search end at their next reports; then the process is at rest.
while True:
    used = time.process_time()
    time.sleep(0.5)
    if time.process_time() - used < 0.1:
        print(time.perf_counter() - began)
        break
"""
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    raised, rested = map(float, told.stdout.split())
    assert 0.9 < raised < 5.0 and rested < 45.0, told
