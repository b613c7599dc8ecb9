"""Thousands of designs: `swimmer sweep …`. A spec becomes a plan in a folder, the plan is run, and its table is read with polars or pandas.

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
    """Makes an immutable plan of a spec (TOML) in the folder `output`: `plan` (its hash), `tasks`, `blocks`, `axes`.

    Made again of the same spec it is the same; a folder with another one is refused.
    """
    with Run("sweep", "plan", os.fspath(spec)) as run:
        run.options({"output": output})
        return Result(run.document())


def run(folder: Text, *, shard: str | None = None, threads: int | None = None) -> Result:
    """Solves the designs of a plan that are not solved yet: `done`, `failed`, `blocks`, `blocks_skipped`, `seconds`.

    `shard="2/7"` runs a part of the blocks. On Ctrl-C this returns at once, while the blocks that are being solved go on until this
    Python ends; what is finished stays and is passed over the next time.
    """
    with Run("sweep", "run", os.fspath(folder)) as run:
        run.options({"shard": shard, "threads": threads})
        return Result(run.document())


def status(folder: Text) -> Result:
    """How far a sweep is, over all shards: `done` of `tasks`, `uncertified`, `warm`, `blocks_broken`, … and what a design costs, `cold_s`, `warm_s`."""
    with Run("sweep", "status", os.fspath(folder)) as run:
        return Result(run.document())


def merge(folder: Text, *, output: Text) -> Result:
    """Writes all designs of a finished sweep as one Parquet table, sorted by key: `table` (its path), `certified`, `failed`, `sha256`."""
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
    """A finished grid over two of its axes: `designs`, `kinds`, `doubts`, …; `output` is its picture, `export` its numbers as JSON.

    `at={"drag.chi": 2}` takes the nearest value of another axis.
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
