"""The docstrings: their form, their examples, and the pages of the book about Python."""

import ast
import doctest
import inspect
import json
import os
import re
from pathlib import Path

import pytest
import swimmer

import reference
from reference import Item, Kind

BOOK = Path(__file__).parents[2] / "docs"
PAGE = BOOK / "reference" / "python.md"
UPDATE = "SWIMMER_PYTHON_REFERENCE"

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


ITEMS = list(reference.items())


def name_of(item: Item) -> str:
    return item.name


@pytest.mark.parametrize("item", [item for item in ITEMS if ">>>" in item.doc], ids=name_of)
def test_examples_of_the_docstrings_hold(item: Item, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest(item.doc, {}, item.name, None, None)
    outcome = doctest.DocTestRunner().run(test)
    assert outcome.failed == 0


def test_the_module_shows_an_example() -> None:
    test = doctest.DocTestParser().get_doctest(swimmer.__doc__ or "", {}, "swimmer", None, None)
    outcome = doctest.DocTestRunner().run(test)
    assert outcome.attempted > 0 and outcome.failed == 0


@pytest.mark.parametrize("item", ITEMS, ids=name_of)
def test_every_public_part_has_the_sections_of_numpydoc(item: Item) -> None:
    first = item.doc.splitlines()[0] if item.doc else ""
    assert re.search(r"[.:;]", item.doc.split("\n\n")[0]), "a summary"
    assert not re.match(r"(What|Whether|Who|How|Where)\b", first), first
    if item.kind in (Kind.FUNCTION, Kind.METHOD):
        signature = inspect.signature(item.object)  # type: ignore[arg-type]
        parameters = [name for name in signature.parameters if name != "self"]
        described = section(item.doc, "Parameters")
        for name in parameters:
            assert re.search(rf"^[\w*, ]*\b{name}\b", described, re.MULTILINE), f"parameter {name} of {item.name}"
        assert "Examples\n" in item.doc, item.name
        if signature.return_annotation not in (None, inspect.Signature.empty, "None"):
            assert section(item.doc, "Returns"), item.name
    if item.kind is Kind.FUNCTION:
        assert section(item.doc, "Raises"), item.name


def section(doc: str, title: str) -> str:
    """Text of a section; empty if it is missing."""
    found = re.search(rf"^{title}\n-{{3,}}\n(.*?)(?=^\w+\n-{{3,}}\n|\Z)", doc, re.MULTILINE | re.DOTALL)
    return found.group(1) if found else ""


def test_stubs_and_extension_have_the_same_docstrings() -> None:
    stub = ast.parse((Path(swimmer.__file__).parent / "_swimmer.pyi").read_text(encoding="utf-8"))
    compared = 0
    for node in stub.body:
        if not isinstance(node, ast.ClassDef) or node.name not in ("Swimmer", "Gait"):
            continue
        extension = getattr(swimmer, node.name)
        assert ast.get_docstring(node) == inspect.getdoc(extension), node.name
        for part in node.body:
            if isinstance(part, ast.FunctionDef) and not part.name.startswith("_"):
                assert ast.get_docstring(part) == inspect.getdoc(getattr(extension, part.name)), part.name
                compared += 1
    assert compared > 25


def test_the_reference_holds_the_docstrings() -> None:
    """With SWIMMER_PYTHON_REFERENCE=overwrite in the environment the page is written."""
    page = reference.page()
    if os.environ.get(UPDATE) == "overwrite":
        PAGE.write_text(page, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == page, f"{UPDATE}=overwrite writes the page anew"


def test_the_reference_is_in_the_book() -> None:
    assert "(reference/python.md)" in (BOOK / "SUMMARY.md").read_text(encoding="utf-8")


@pytest.mark.filterwarnings("default::swimmer.Doubt")
def test_the_page_about_python_runs(tmp_path: Path, straight: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("missing.toml").write_text(SPEC.replace('"straight"', f'"{straight.as_posix()}"'))
    page = (BOOK / "how-to" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == 4
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "python.md", "exec"), names)
    assert names["played"].cause == "finished" and len(names["path"]) > 1000  # type: ignore[attr-defined,arg-type]
    assert names["report"].done == 3  # type: ignore[attr-defined]
    assert len(names["table"]) == 3  # type: ignore[arg-type]


@pytest.mark.parametrize("path", sorted((BOOK.parent / "python" / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_is_committed_with_its_outputs(path: Path) -> None:
    """`python python/tests/notebooks.py` writes them."""
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    shown = json.dumps(outputs)
    assert "Traceback" not in shown and "/tmp/" not in shown and "/home/" not in shown
