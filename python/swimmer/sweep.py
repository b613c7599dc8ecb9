"""Sweeps over thousands of designs: a spec becomes a plan in a folder, the plan is run, and its designs become one table.

>>> import swimmer as sw
>>> sw.sweep.plan("small.toml", output="small").tasks  # doctest: +SKIP
12
>>> sw.sweep.run("small").failed  # doctest: +SKIP
0
>>> sw.sweep.merge("small", output="small.parquet").certified  # doctest: +SKIP
12
"""

from collections.abc import Mapping
from typing import Any, Literal

from . import _swimmer
from ._messages import Text, warn
from .results import Result

__all__ = ["map", "merge", "plan", "run", "status"]


def plan(spec: Text, *, output: Text) -> Result:
    """Makes an immutable plan of a spec.

    The same spec gives the same plan again; a folder with another plan is refused.

    Parameters
    ----------
    spec : path
        Spec of the sweep (TOML).
    output : path
        Folder of the plan.

    Returns
    -------
    Result
        ``plan`` (its hash), ``tasks``, ``blocks``, ``axes``.

    Raises
    ------
    BadInput
        If the spec is invalid, or the folder holds another plan.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.sweep.plan("small.toml", output="small").tasks  # doctest: +SKIP
    12
    """
    return _result(_swimmer.sweep_plan(spec, output))


def run(folder: Text, *, shard: str | None = None, threads: int | None = None) -> Result:
    """Solves the designs of a plan that are not solved yet.

    Ctrl-C ends it after the blocks in work. Finished blocks stay, and the same call goes on.

    Parameters
    ----------
    folder : path
        Folder of the plan.
    shard : str, optional
        Part of the blocks, as ``2/7``; within a job array of Slurm the array's task unless given.
    threads : int, optional
        Number of threads, one for each core unless given.

    Returns
    -------
    Result
        ``done``, ``failed``, ``blocks``, ``blocks_skipped``, ``seconds``.

    Raises
    ------
    BadInput
        If a value cannot be used, or the folder holds no plan.
    Failed
        If the disk refuses.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.sweep.run("small", shard="1/2").failed  # doctest: +SKIP
    0
    """
    return _result(_swimmer.sweep_run(folder, {"shard": shard, "threads": threads}))


def status(folder: Text) -> Result:
    """Reports the progress of a sweep, over all shards.

    Parameters
    ----------
    folder : path
        Folder of the plan.

    Returns
    -------
    Result
        ``done`` of ``tasks``, ``uncertified``, ``warm``, ``blocks_broken``, …; ``cold_s`` and ``warm_s``, the cost of a design.

    Raises
    ------
    BadInput
        If the folder holds no plan.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.sweep.status("small").done  # doctest: +SKIP
    12
    """
    return _result(_swimmer.sweep_status(folder))


def merge(folder: Text, *, output: Text) -> Result:
    """Writes all designs of a finished sweep as one Parquet table, sorted by key.

    Parameters
    ----------
    folder : path
        Folder of the plan.
    output : path
        New table (.parquet), for polars or pandas.

    Returns
    -------
    Result
        ``table`` (its path), ``certified``, ``failed``, ``sha256``.

    Raises
    ------
    BadInput
        If the folder holds no plan.
    Failed
        If the sweep is not finished.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.sweep.merge("small", output="small.parquet").certified  # doctest: +SKIP
    12
    """
    return _result(_swimmer.sweep_merge(folder, output))


def map(
    folder: Text,
    *,
    across: str | None = None,
    up: str | None = None,
    at: Mapping[str, float | str] | None = None,
    quantity: Literal[
        "displacement",
        "efficiency",
        "speed",
        "amplitude",
        "rotation",
        "lateral",
        "structure",
        "pareto",
    ] = "displacement",
    output: Text | None = None,
    width: Literal[85, 170] | None = None,
    export: Text | None = None,
) -> Result:
    """Maps a finished grid over two of its axes.

    Parameters
    ----------
    folder : path
        Folder of the plan.
    across, up : str, optional
        Names of the axes.
    at : mapping of str to float or str, optional
        Values of other axes, as ``{"drag.chi": 2, "objective": "speed"}``; the nearest ones are taken.
    quantity : str, optional
        ``displacement``, ``efficiency``, ``speed``, ``amplitude``, ``rotation``, ``lateral``, ``structure`` or ``pareto``.
    output : path, optional
        New picture.
    width : {85, 170}, optional
        Width of the picture in print [mm]: one column of a journal, or both; 170 unless given.
    export : path, optional
        New file (.json) with the numbers.

    Returns
    -------
    Result
        ``designs``, ``without_gait``, ``kinds``, ``doubts``, …

    Raises
    ------
    BadInput
        If a value cannot be used.
    Failed
        If the sweep is not finished.

    Examples
    --------
    >>> import swimmer as sw
    >>> sw.sweep.map("small", across="sphere.radius", up="drag.chi", output="map.svg")  # doctest: +SKIP
    """
    keywords = {
        "across": across,
        "up": up,
        "at": at,
        "quantity": quantity,
        "output": output,
        "width": width,
        "export": export,
    }
    return _result(_swimmer.sweep_map(folder, keywords))


def _result(reply: tuple[dict[str, Any], list[str]]) -> Result:
    """The document of a reply; its messages become warnings at the caller of the public function."""
    document, notes = reply
    warn(notes, stacklevel=4)
    return Result(document)
