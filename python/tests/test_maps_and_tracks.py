"""Height maps, the atlas, recordings and their fit, and the figures of all."""

import json
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import swimmer as sw

matplotlib.use("Agg")


@pytest.fixture(scope="module")
def heights(purcell: sw.Swimmer) -> sw.HeightMap:
    return sw.height_map(purcell, max_angle=2.5, gait=[sw.Gait.circle(1.2), "circle:0.3"])


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a demo leaves: nine circles that the twin swam, as its cameras saw them, and their campaign."""
    folder = tmp_path_factory.mktemp("demo") / "lab"
    command = [sys.executable, "-m", "swimmer", "demo", "--seed", "1", "-o", str(folder)]
    subprocess.run(command, check=True, capture_output=True)
    return folder


def test_height_maps_are_arrays(heights: sw.HeightMap) -> None:
    assert heights.at_origin_over_length == pytest.approx(0.0205761317, abs=5e-11)
    assert heights.zero_on_diagonal == pytest.approx(1.41638, abs=5e-6)
    assert heights.phi.shape == (201,) and heights.height.shape == (201, 201)
    assert heights.phi[0] == -2.5 and heights.phi[100] == 0.0
    assert heights.height[100, 100] == pytest.approx(heights.at_origin_over_length, rel=1e-9)
    # Mirror and half turn: H(φ₁, φ₂) = H(φ₂, φ₁) = H(−φ₁, −φ₂) for the row x of a swimmer with equal side links.
    np.testing.assert_allclose(heights.height, heights.height.T, atol=1e-9)
    np.testing.assert_allclose(heights.height, heights.height[::-1, ::-1], atol=1e-9)
    assert [rule.gait for rule in heights.gaits] == ["circle:1.2", "circle:0.3"]


def test_axes_of_a_height_map_are_not_exchanged(robot: sw.Swimmer) -> None:
    lopsided = robot.replace(front=0.2, name="lopsided")
    heights = sw.height_map(lopsided, max_angle=2.0, row="theta")
    assert not np.allclose(heights.height, heights.height.T, atol=1e-6)
    # The row θ of the curvature is what it is in every frame.
    one, two = np.meshgrid(heights.phi, heights.phi, indexing="ij")
    turn = lopsided.F(np.stack([one, two], axis=-1))[..., 2]
    np.testing.assert_allclose(heights.height, turn, rtol=0, atol=1e-9)


def test_the_atlas_holds_gaits(purcell: sw.Swimmer) -> None:
    atlas = sw.atlas(purcell, objective="displacement", max_angle=1.2, starts=2, seed=1)
    assert len(atlas.optima) >= 1
    best = atlas.optima[0]
    assert isinstance(best, sw.OptimalGait) and best.certificate.pass_
    swum = sw.simulate(best.swimmer, best.gait)
    assert swum.displacement_over_length == pytest.approx(best.displacement_over_length, abs=1e-8)
    table = atlas.optima.to_pandas()
    assert table["displacement_over_length"].tolist() == [optimum.displacement_over_length for optimum in atlas.optima]
    assert table["certificate.pass"].all() and len(table) == len(atlas.optima)


def test_gaits_are_followed_as_a_bound_changes(purcell: sw.Swimmer) -> None:
    followed = sw.atlas(purcell, objective="displacement", continue_="max-angle=1.4..1.2", steps=2)
    assert followed.optima == () and followed.optima.to_pandas().empty
    points = followed.continuation.points.to_pandas()
    ends = points[points["value"] == 1.2]
    best = sw.optimize.displacement(purcell, max_angle=1.2)
    assert best.displacement_over_length == pytest.approx(ends["displacement_over_length"].abs().max(), rel=1e-7)


def test_gaits_to_steer_by_are_gaits(robot: sw.Swimmer, tmp_path: Path) -> None:
    folder = tmp_path / "straight"
    steering = sw.optimize.steer(robot, max_rate=3.0, max_angle=1.0, no_overlap=True, shape=(0.0, 0.0), output=folder)
    forward, *_, turn = steering.gaits
    assert sw.simulate(robot, forward.gait).displacement_m == pytest.approx(forward.x_m, abs=1e-6)
    assert sw.simulate(robot, turn.gait).rotation_rad == pytest.approx(turn.rotation_rad, abs=1e-6)
    for gait in steering.gaits:
        assert sw.Gait.load(folder / f"{gait.name}.gait") == gait.gait


def test_a_passive_joint_is_simulated(tmp_path: Path) -> None:
    best = sw.optimize.passive("elastic-tail", max_angle=1.0, harmonics=1)
    picture, cycle = tmp_path / "tail.svg", tmp_path / "tail.gait"
    driven = sw.simulate("elastic-tail", "sine:1.0", period=best.period_s, picture=picture, output=cycle)
    assert driven.passive_start_rad is not None and picture.read_text(encoding="utf-8").startswith("<svg")
    same = sw.simulate(best.swimmer, best.gait, period=best.period_s)
    swum = np.hypot(same.displacement_over_length, same.lateral_over_length)
    assert swum == pytest.approx(best.displacement_over_length, rel=1e-5)
    assert sw.simulate("purcell", sw.Gait.load(cycle)).displacement_m == pytest.approx(
        sw.simulate("purcell", cycle).displacement_m, rel=1e-12
    )


def test_a_campaign_is_fitted(laboratory: Path) -> None:
    fit = sw.calibrate(laboratory / "campaign.toml")
    # What the demo's tank was made of is the robot preset.
    assert fit.chi == pytest.approx(3.598, rel=2e-3) and fit.sphere_radius_m == pytest.approx(0.0692, rel=2e-3)
    low, high = fit.intervals.chi
    assert low < fit.chi < high and fit.verdict == "trust"
    assert fit.swimmer is not None and fit.swimmer.chi == fit.chi
    assert len(fit.runs) == 9 and fit.runs[0].file == "circle-030.csv"
    table = fit.runs.to_pandas()
    assert table["x_m"].tolist() == [run.x_m for run in fit.runs] and table["samples.frames"].min() > 1000
    robust = sw.optimize.displacement(fit.swimmer, max_angle=1.5, robust=fit).robust
    assert robust.robust.worst >= robust.nominal_optimum.worst > 0


def test_a_single_run_gives_its_cycles(laboratory: Path, robot: sw.Swimmer, tmp_path: Path) -> None:
    file = laboratory / "circle-070.csv"
    one = sw.calibrate(file, gait=sw.Gait.load("circle:70deg"), period=15.0, swimmer=robot)
    assert one.swimmer is None and len(one.runs) == 1 and one.runs[0].cycles >= 3
    sampled = sw.calibrate(file, gait=sw.Gait(sw.Gait.circle(np.radians(70)).phi), period=15.0, swimmer=robot)
    assert sampled.runs[0].x_m == pytest.approx(one.runs[0].x_m, rel=1e-9)
    with pytest.raises(sw.BadInput, match="a single run is not fitted"):
        sw.calibrate(file, gait="circle:70deg", period=15.0, swimmer=robot, output=tmp_path / "fit")


def test_a_calibration_leaves_the_folder_of_the_command(laboratory: Path, tmp_path: Path) -> None:
    fit = sw.calibrate(laboratory / "campaign.toml", level=0.9, fit_also=["gain"], advise=True, output=tmp_path / "fit")
    words = ["calibrate", str(laboratory / "campaign.toml"), "--level=0.9", "--fit-also=gain", "--advise", "--json"]
    command = json.loads(subprocess.run([sys.executable, "-m", "swimmer", *words], check=True, capture_output=True).stdout)
    assert fit.to_dict() == command == json.loads((tmp_path / "fit" / "fit.json").read_text())
    assert fit.swimmer == sw.Swimmer.load(tmp_path / "fit" / "fitted.toml")
    assert (tmp_path / "fit" / "report.html").exists()
    of_file, of_fit = (sw.optimize.displacement(fit.swimmer, max_angle=1.5, robust=one).robust for one in (tmp_path / "fit" / "fit.json", fit))
    assert of_file.robust.worst == pytest.approx(of_fit.robust.worst, rel=1e-12)
    with pytest.raises(sw.BadInput, match="not empty"):
        sw.calibrate(laboratory / "campaign.toml", output=tmp_path / "fit")


def test_without_pandas_a_table_says_what_to_install(purcell: sw.Swimmer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        sw.optimize.turning(purcell, max_angle=1.0).certificate.checks.to_pandas()


def test_tracks_say_what_a_recording_holds(laboratory: Path) -> None:
    held = sw.tracks(laboratory / "circle-070.csv")
    assert held.frames > 1000 and {"Front", "Back"} <= {point.name for point in held.points}


def test_everything_can_be_drawn(purcell: sw.Swimmer, heights: sw.HeightMap) -> None:
    ax = heights.plot()
    best = sw.optimize.turning(purcell, max_angle=1.0)
    assert best.plot(ax, color="k") is ax and len(ax.lines) == 1 + len(heights.zero_curves)
    corner = np.abs(ax.lines[-1].get_xydata()).max()
    assert corner == pytest.approx(1.0, abs=1e-9)
    way = sw.simulate(purcell, best.gait, cycles=2).plot()
    assert way.get_xlabel() == "x [m]"
    matplotlib.pyplot.close("all")


def test_without_matplotlib_a_plot_says_what_to_install(purcell: sw.Swimmer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="pip install matplotlib"):
        sw.simulate(purcell, "circle:1").plot()
