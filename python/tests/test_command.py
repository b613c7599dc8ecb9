"""The command inside the wheel."""

import functools
import json
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path

import swimmer as sw


def test_the_wheel_brings_the_command(purcell: sw.Swimmer) -> None:
    command = shutil.which("swimmer", path=sysconfig.get_path("scripts"))
    assert command is not None
    words = [command, "simulate", "--swimmer=purcell", "--gait=circle:1.1", "--json"]
    told = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    assert told == {**sw.simulate(purcell, "circle:1.1").to_dict()}
    refused = subprocess.run([command, "simulate", "--gait=circle:1"], capture_output=True, text=True)
    assert refused.returncode == 2 and "--swimmer" in refused.stderr


def test_the_package_is_typed() -> None:
    folder = Path(sw.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_swimmer.pyi").exists()


def test_the_page_for_matlab_names_what_is_there() -> None:
    page = (Path(__file__).parents[2] / "docs" / "from-matlab.md").read_text(encoding="utf-8")
    names = set(re.findall(r"py\.swimmer\.([\w.]+)", page))
    assert {"Swimmer.preset", "optimize.displacement", "calibrate"} <= names
    for name in names:
        assert callable(functools.reduce(getattr, name.split("."), sw)), name
