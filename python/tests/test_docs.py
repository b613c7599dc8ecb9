"""The examples of the docstrings, and the page about Python."""

import doctest
import re
from pathlib import Path

import pytest
import swimmer
import swimmer._commands
import swimmer.robot

BOOK = Path(__file__).parents[2] / "docs"

SPEC = """
swimmer = "robot"
drive = "straight"
repeats = 1
cycles = 2
period = 12.0
settle = 1.0
[tank]
length = 1.6
width = 1.2
[[gait]]
gait = "circle:50deg"
[[gait]]
gait = "circle:70deg"
[[gait]]
gait = "circle:90deg"
"""


@pytest.mark.parametrize("module", [swimmer.robot, swimmer._commands, swimmer])
def test_examples_of_the_docstrings_hold(module: object) -> None:
    outcome = doctest.testmod(module)  # type: ignore[arg-type]
    assert outcome.attempted > 0 and outcome.failed == 0


def test_every_part_of_the_robot_is_documented() -> None:
    public = [getattr(swimmer.Robot, name) for name in dir(swimmer.Robot) if not name.startswith("_")]
    functions = [part for part in public if callable(part)]
    functions += [getattr(swimmer.experiment, name) for name in ("plan", "run", "status", "report")]
    for function in functions:
        assert function.__doc__ and "Raises\n" in function.__doc__, function
    assert swimmer.Robot.__doc__ and "Parameters\n" in swimmer.Robot.__doc__ and "Examples\n" in swimmer.Robot.__doc__


@pytest.mark.filterwarnings("default::swimmer.Doubt")
def test_the_page_about_python_runs(tmp_path: Path, straight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("missing.toml").write_text(SPEC.replace('"straight"', f'"{straight.as_posix()}"'))
    page = (BOOK / "how-to" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 3
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "python.md", "exec"), names)
    assert names["played"].cause == "finished" and len(names["path"]) > 1000  # type: ignore[attr-defined,arg-type]
    assert names["report"].done == 3  # type: ignore[attr-defined]
