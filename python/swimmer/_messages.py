"""Messages of calls as warnings."""

import os
import warnings
from collections.abc import Sequence
from typing import TypeAlias

Text: TypeAlias = str | os.PathLike[str]


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
