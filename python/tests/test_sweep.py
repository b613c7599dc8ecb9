"""A sweep from its spec to its table."""

import importlib
import json
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest
import swimmer as sw

SPEC = """
swimmer = "purcell"
objective = "displacement"
max_rate = 1.0
[bounds]
max_angle = 2.0
[[axis]]
name = "drag.chi"
values = [1.8, 2.0]
[[axis]]
name = "sphere.radius"
values = [0.0, 0.1, 0.2]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of six designs, run in two shards."""
    here = tmp_path_factory.mktemp("sweep")
    (here / "spec.toml").write_text(SPEC, encoding="utf-8")
    planned = sw.sweep.plan(here / "spec.toml", output=here / "small")
    assert planned.tasks == 6 and [axis.count for axis in planned.axes] == [2, 3]
    assert sw.sweep.plan(here / "spec.toml", output=here / "small").plan == planned.plan
    assert sw.sweep.status(here / "small").done == 0
    for shard in ("1/2", "2/2"):
        ran = sw.sweep.run(here / "small", shard=shard, threads=1)
        assert ran.shard == shard and ran.failed == 0
    assert sw.sweep.run(here / "small").blocks_skipped == planned.blocks
    return here / "small"


def test_the_table_has_every_design(folder: Path, purcell: sw.Swimmer) -> None:
    merged = sw.sweep.merge(folder, output=folder / "small.parquet")
    assert merged.certified == merged.tasks == 6
    polars, pandas = (importlib.import_module(name) for name in ("polars", "pandas"))
    table = polars.read_parquet(merged.table)
    assert table["key"].to_list() == list(range(6))
    design = table.filter((polars.col("drag.chi") == 2.0) & (polars.col("sphere.radius") == 0.0))
    best = sw.optimize.displacement(purcell, max_angle=2.0)
    assert design["objective"].item() == pytest.approx(best.displacement_over_length, rel=1e-7)
    assert pandas.read_parquet(merged.table)["objective"].tolist() == table["objective"].to_list()


def test_a_map_is_drawn_and_exported(folder: Path, tmp_path: Path) -> None:
    picture, export = tmp_path / "map.svg", tmp_path / "map.json"
    drawn = sw.sweep.map(
        folder,
        across="sphere.radius",
        up="drag.chi",
        at={"drag.chi": 2},
        quantity="speed",
        output=picture,
        export=export,
    )
    assert drawn.designs == 6 and drawn.without_gait == 0 and drawn.doubts == ()
    assert picture.read_text(encoding="utf-8").startswith("<svg")
    numbers = json.loads(export.read_text(encoding="utf-8"))
    assert numbers["axes"][1]["values"] == [1.8, 2.0]
    # Keys are whole numbers, as in the table.
    assert all(type(one["key"]) is int for one in numbers["pareto"])


def test_outputs_are_those_of_the_command(folder: Path) -> None:
    command = shutil.which("swimmer", path=sysconfig.get_path("scripts"))
    assert command is not None
    axes = ["--across=sphere.radius", "--at=drag.chi=2.0"]
    for words, output in (
        (["status"], sw.sweep.status(folder)),
        (["map", *axes], sw.sweep.map(folder, across="sphere.radius", at={"drag.chi": 2})),
    ):
        line = [command, "sweep", words[0], str(folder), *words[1:], "--json"]
        printed = subprocess.run(line, check=True, capture_output=True).stdout
        assert json.loads(printed) == output.to_dict()


def test_what_is_wrong_is_said(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(sw.BadInput, match="2/7"):
        sw.sweep.run(folder, shard="three")
    spec = tmp_path / "spec.toml"
    spec.write_text(SPEC.replace("drag.chi", "drag.chy"), encoding="utf-8")
    with pytest.raises(sw.BadInput, match="did you mean drag.chi"):
        sw.sweep.plan(spec, output=tmp_path / "other")
