"""Python's arguments as the words of a command, and its JSON document back."""

import json
import os
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeAlias

from . import _swimmer
from ._swimmer import Error, Gait, Swimmer

Document: TypeAlias = dict[str, Any]
Text: TypeAlias = str | os.PathLike[str]


PRESETS = ("purcell", "robot", "robot-slender", "perfect-fluid", "kinematic-snake", "elastic-tail")


class Doubt(UserWarning):
    """Warning about a doubtful value, file or result.

    Examples
    --------
    >>> import warnings
    >>> import swimmer as sw
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", sw.Doubt)
    ...     swum = sw.simulate(sw.Swimmer.preset("purcell").replace(chi=0.5), "circle:1")
    """


def warn(notes: Sequence[str], *, stacklevel: int) -> None:
    """Turns what a call reports apart from its result into warnings."""
    for note in notes:
        kind, _, text = note.partition(": ")
        if kind in ("warning", "note"):
            warnings.warn(text, Doubt, stacklevel=stacklevel)


class Run:
    """One command, with a temporary folder for objects that are in memory.

    Messages and results name files of that folder without the folder.
    """

    def __init__(self, *command: str) -> None:
        self._words = list(command)
        self._folder = tempfile.TemporaryDirectory(prefix="swimmer-")
        self._names: set[str] = set()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._folder.cleanup()

    def place(self, name: str) -> Path:
        """A free path in the folder."""
        stem, ending = os.path.splitext(name)
        number = 1
        while name in self._names:
            number += 1
            name = f"{stem}-{number}{ending}"
        self._names.add(name)
        return Path(self._folder.name) / name

    def found(self, shown: str) -> Path:
        """Path of a file that the result names."""
        return Path(self._folder.name) / shown

    def swimmer(self, swimmer: Swimmer | Text) -> None:
        """`--swimmer`: an object, a preset's name or a path."""
        if not isinstance(swimmer, Swimmer):
            word = os.fspath(swimmer)
        elif swimmer.name in PRESETS and swimmer == Swimmer.preset(swimmer.name):
            word = swimmer.name
        else:
            path = self.place("swimmer.toml")
            swimmer.save(path)
            word = str(path)
        self._words.append(f"--swimmer={word}")

    def gait(self, gait: Gait | Text) -> None:
        """`--gait`: an object, `circle:70deg` or a path."""
        self._words.append(f"--gait={self.named(gait)}")

    def named(self, gait: Gait | Text) -> str:
        """A gait as a word."""
        if not isinstance(gait, Gait):
            return os.fspath(gait)
        if gait.closed_form is not None:
            return gait.closed_form
        path = self.place("gait.gait")
        gait.save(path)
        return str(path)

    def options(self, options: Mapping[str, object]) -> None:
        """`--max-angle=1.2` for `max_angle=1.2`; none for None and False, the bare flag for True, several values for several."""
        for key, value in options.items():
            name = "--" + key.rstrip("_").replace("_", "-")
            if value is None or value is False:
                continue
            if value is True:
                self._words.append(name)
            elif isinstance(value, Sequence) and not isinstance(value, str):
                self._words += [name, *map(_word, value)]
            else:
                self._words.append(f"{name}={_word(value)}")

    def words(self, *words: str) -> None:
        """Words as they are."""
        self._words += words

    def document(self, stacklevel: int = 3) -> Document:
        """Runs the command and returns its JSON document; its notes become warnings at the caller's caller."""
        try:
            text, notes = _swimmer.run_captured(self._words)
        except Error as error:
            raise type(error)(self._shown(str(error))) from None
        for note in notes:
            warnings.warn(
                self._shown(note).removeprefix("warning: "),
                Doubt,
                stacklevel=stacklevel,
            )
        document: Document = self._shown_in(json.loads(text))
        return document

    def _shown(self, text: str) -> str:
        return text.replace(self._folder.name + os.sep, "")

    def _shown_in(self, value: Any) -> Any:
        if isinstance(value, str):
            return self._shown(value)
        if isinstance(value, list):
            return [self._shown_in(item) for item in value]
        if isinstance(value, dict):
            return {key: self._shown_in(item) for key, item in value.items()}
        return value


def _word(value: object) -> str:
    # NumPy's numbers are not Python's: repr would name their type.
    if isinstance(value, str | int | os.PathLike):
        return os.fspath(value) if isinstance(value, os.PathLike) else str(value)
    return repr(float(value))  # type: ignore[arg-type]  # anything that is a number
