"""The Python reference of the book, made of the docstrings."""

import enum
import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass

import swimmer
from swimmer import experiment, optimize, sweep

HEAD = """\
# Python

`pip install .` in a clone installs the package; [Drive the robot from Python](../how-to/python.md) shows its use. This page holds the
docstrings: `help(swimmer.simulate)` prints the same. Lengths are in metres and angles in radians; a text such as `"70deg"` may stand for
an angle. Keywords are the options of the [command](commands.md) of the same name, and the keys of results are those of its
[JSON document](json.md).
"""

FUNCTIONS = "Functions"
CLASSES = "Swimmers, gaits, results"
ROBOT = "Robot"
ERRORS = "Errors and warnings"


class Kind(enum.Enum):
    FUNCTION = enum.auto()
    CLASS = enum.auto()
    METHOD = enum.auto()
    PROPERTY = enum.auto()


@dataclass(frozen=True)
class Item:
    """A public part of the package."""

    name: str
    kind: Kind
    object: object

    @property
    def doc(self) -> str:
        return inspect.getdoc(self.object) or ""

    @property
    def signature(self) -> str:
        """Name with parameters and defaults; types are in the text."""
        if self.kind is Kind.PROPERTY:
            return self.name
        try:
            full = inspect.signature(self.object)  # type: ignore[arg-type]
        except ValueError:
            return self.name
        bare = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in full.parameters.values()]
        if self.kind is Kind.METHOD:
            bare = [parameter for parameter in bare if parameter.name != "self"]
        return self.name + str(full.replace(parameters=bare, return_annotation=inspect.Signature.empty))


def sections() -> Iterator[tuple[str, str, list[Item]]]:
    """Title, introduction and items of each section."""
    names = [name for name in swimmer.__all__ if not name.startswith("_")]
    public = {name: getattr(swimmer, name) for name in names}
    robot = ("Robot", "Telemetry", "Pose")
    yield (FUNCTIONS, "", [Item(f"swimmer.{name}", Kind.FUNCTION, one) for name, one in public.items() if inspect.isfunction(one)])
    for module in (optimize, experiment, sweep):
        yield (module.__name__, inspect.getdoc(module) or "", list(of_names(module.__name__, module, module.__all__)))
    classes = {name: one for name, one in public.items() if inspect.isclass(one) and not issubclass(one, Exception)}
    yield (CLASSES, "", [item for name in classes if name not in robot for item in of_class(f"swimmer.{name}", classes[name])])
    yield (ROBOT, "", [item for name in robot for item in of_class(f"swimmer.{name}", classes[name])])
    errors = [Item(f"swimmer.{name}", Kind.CLASS, one) for name, one in public.items() if inspect.isclass(one) and issubclass(one, Exception)]
    yield (ERRORS, "", errors)


def of_names(prefix: str, module: object, names: list[str]) -> Iterator[Item]:
    functions = sorted(name for name in names if inspect.isfunction(getattr(module, name)))
    for name in functions:
        yield Item(f"{prefix}.{name}", Kind.FUNCTION, getattr(module, name))
    for name in names:
        if name not in functions:
            yield from of_class(f"{prefix}.{name}", getattr(module, name))


def of_class(prefix: str, of: type) -> Iterator[Item]:
    """A class with its own public methods and properties; those of its bases are described there."""
    yield Item(prefix, Kind.CLASS, of)
    parts = vars(of).items()
    if of.__module__.startswith("swimmer") and any(map(inspect.isgetsetdescriptor, vars(of).values())):
        # An extension has its parts in no fixed order.
        parts = sorted(parts)  # type: ignore[assignment]
    for name, part in parts:
        if name.startswith("_"):
            continue
        part = part.__func__ if isinstance(part, staticmethod) else part
        if inspect.isroutine(part):
            yield Item(f"{prefix}.{name}", Kind.METHOD, getattr(of, name))
        elif (isinstance(part, property) or inspect.isgetsetdescriptor(part)) and inspect.getdoc(part):
            yield Item(f"{prefix}.{name}", Kind.PROPERTY, part)


def items() -> Iterator[Item]:
    """Every public part."""
    for _, _, part in sections():
        yield from part


def markdown(doc: str) -> str:
    """A numpydoc text as Markdown: a list for parameters, code for examples."""
    blocks = re.split(r"^(\w+)\n-{3,}\n", doc, flags=re.MULTILINE)
    lines = [examples_as_code(blocks[0].strip())]
    for title, body in zip(blocks[1::2], blocks[2::2], strict=True):
        if title == "Examples":
            lines.append(f"```python\n{body.strip()}\n```")
        else:
            entries = re.split(r"\n(?=\S)", body.strip())
            lines.append(f"**{title}**\n\n" + "\n".join(entry(one, title) for one in entries))
    return "\n\n".join(lines)


def examples_as_code(text: str) -> str:
    """Paragraphs that are examples of a module, as code."""
    paragraphs = text.split("\n\n")
    return "\n\n".join(f"```python\n{one}\n```" if one.startswith(">>>") else one for one in paragraphs)


def entry(text: str, title: str) -> str:
    """A parameter, result or error with its description."""
    first, _, rest = text.partition("\n")
    name, _, kind = first.partition(" : ")
    described = " ".join(line.strip() for line in rest.splitlines())
    if title in ("Parameters", "Attributes"):
        names = ", ".join(f"`{one}`" for one in name.split(", "))
        return f"- {names}{f' ({kind})' if kind else ''}: {described}" if described else f"- {names}: {kind}"
    return f"- `{first}`: {described}" if described else f"- `{first}`"


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for title, introduction, part in sections():
        parts.append(f"## {title}\n")
        if introduction:
            parts.append(markdown(introduction) + "\n")
        for item in part:
            if item.kind is Kind.PROPERTY:
                parts.append(f"**`{item.name}`**: {' '.join(item.doc.split())}\n")
                continue
            level = "####" if item.kind is Kind.METHOD else "###"
            short = item.name.removeprefix("swimmer.")
            parts.append(f"{level} {short}\n")
            if item.kind is not Kind.CLASS or "Parameters\n" in item.doc:
                parts.append(f"```python\n{wrapped(item.signature)}\n```\n")
            parts.append(markdown(item.doc) + "\n")
    return "\n".join(parts)


def wrapped(signature: str) -> str:
    """A long signature with a line for each few parameters."""
    if len(signature) <= 100 or "(" not in signature:
        return signature
    name, _, inside = signature.partition("(")
    lines, line = [], "   "
    for one in inside.removesuffix(")").split(", "):
        if len(line) + len(one) > 96:
            lines.append(line)
            line = "   "
        line += f" {one},"
    return "\n".join([f"{name}(", *lines, line, ")"])
