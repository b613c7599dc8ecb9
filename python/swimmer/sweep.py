"""Sweeps over thousands of designs: a spec becomes a plan in a folder, the plan is run, and its designs become one table.

>>> import swimmer as sw
>>> sw.sweep.plan("small.toml", output="small").tasks  # doctest: +SKIP
12
>>> sw.sweep.run("small").failed  # doctest: +SKIP
0
>>> sw.sweep.merge("small", output="small.parquet").certified  # doctest: +SKIP
12
"""

import os
from collections.abc import Mapping
from typing import Literal

from ._run import Run, Text
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
    with Run("sweep", "plan", os.fspath(spec)) as run:
        run.options({"output": output})
        return Result(run.document())


def run(folder: Text, *, shard: str | None = None, threads: int | None = None) -> Result:
    """Solves the designs of a plan that are not solved yet.

    After Ctrl-C the finished blocks stay, and the same call goes on.

    Parameters
    ----------
    folder : path
        Folder of the plan.
    shard : str, optional
        Part of the blocks, as ``2/7``.
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
    with Run("sweep", "run", os.fspath(folder)) as run:
        run.options({"shard": shard, "threads": threads})
        return Result(run.document())


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
    with Run("sweep", "status", os.fspath(folder)) as run:
        return Result(run.document())


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
    with Run("sweep", "merge", os.fspath(folder)) as run:
        run.options({"output": output})
        return Result(run.document())


def map(
    folder: Text,
    *,
    across: str | None = None,
    up: str | None = None,
    at: Mapping[str, float] | None = None,
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
    export: Text | None = None,
) -> Result:
    """Maps a finished grid over two of its axes.

    Parameters
    ----------
    folder : path
        Folder of the plan.
    across, up : str, optional
        Names of the axes.
    at : mapping of str to float, optional
        Values of other axes, as ``{"drag.chi": 2}``; the nearest ones are taken.
    quantity : str, optional
        ``displacement``, ``efficiency``, ``speed``, ``amplitude``, ``rotation``, ``lateral``, ``structure`` or ``pareto``.
    output : path, optional
        New picture.
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
    with Run("sweep", "map", os.fspath(folder)) as run:
        run.options(
            {
                "across": across,
                "up": up,
                "quantity": quantity,
                "output": output,
                "export": export,
            }
        )
        for axis, value in (at or {}).items():
            run.words(f"--at={axis}={float(value)!r}")
        return Result(run.document())
