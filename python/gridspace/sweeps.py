# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Many runs of one scenario: `gridspace sweep`, and the table that it makes."""
from __future__ import annotations

import contextlib
import json
import os
import pathlib
import sqlite3
import tempfile
from collections.abc import Iterator, Sequence
from typing import Any

from gridspace.launcher import EXPECTATION_FAILED, Error, ask
from gridspace.recording import Run, open_run

CHILD_DIED, STALLED = 4, 5


class Sweep(Sequence):
    """The runs of a study, in the order of its design: each is a dictionary of the columns of docs/reference/sweep.md.

    Numbers are floats or integers; a value that is not there is None.
    """

    def __init__(self, folder: str | os.PathLike):
        self.folder = pathlib.Path(folder).resolve()
        file = self.folder / "results.sqlite"
        if not file.is_file():
            raise Error(f"'{folder}' is not the folder of a study: it has no results.sqlite", 2)
        with contextlib.closing(sqlite3.connect(f"{file.as_uri()}?mode=ro", uri=True)) as database:
            database.row_factory = sqlite3.Row
            cursor = database.execute("SELECT * FROM runs ORDER BY run")
            self.columns: list[str] = [column[0] for column in cursor.description]
            self.rows: list[dict[str, Any]] = [dict(row) for row in cursor]

    def __repr__(self) -> str:
        return f"<gridspace.Sweep {self.folder}: {len(self)} runs>"

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, place):
        return self.rows[place]

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self.rows)

    @property
    def passed(self) -> bool:
        """Every run is done, and passed."""
        return all(row["state"] == "passed" for row in self.rows)

    def column(self, name: str) -> list[Any]:
        """The values of one column, by run. Raises KeyError for a name that is none."""
        if name not in self.columns:
            raise KeyError(f"there is no column '{name}'; there are {', '.join(self.columns)}")
        return [row[name] for row in self.rows]

    def open(self, run: int) -> Run:
        """The recording of a run, by its number. Raises KeyError when there is no such run, and Error when its folder was not kept."""
        row = next((row for row in self.rows if row["run"] == run), None)
        if row is None:
            raise KeyError(f"there is no run {run}; there are 1 to {len(self)}")
        if not row["folder"]:
            raise Error(f"the folder of run {run} was not kept: gridspace.sweep(..., keep=True), or {row['command']}", 2)
        return open_run(row["folder"])

    def frame(self):
        """The same as a pandas DataFrame."""
        try:
            import pandas
        except ImportError as e:
            raise Error("pandas is not installed: pip install pandas, or use rows", 2) from e
        return pandas.DataFrame(self.rows, columns=self.columns)


def sweep(study: str | os.PathLike, *, out: str | os.PathLike | None = None, jobs: int | None = None, keep: bool = False) -> Sweep:
    """Does the runs of a study that are not there yet, and returns the table of all of them, whether or not they passed (Sweep.passed).

    out: the folder of the study; a new one in the temporary folder of the machine when not given, and then nothing is found there that
    was done before. jobs: runs at once. keep: keep the folders of runs that passed, too. Raises Error when nothing could be run.
    """
    folder = pathlib.Path(out) if out is not None else pathlib.Path(tempfile.mkdtemp(prefix="gridspace-")) / "study"
    words = ["sweep", os.fspath(study), "--out", str(folder), "--json"]
    words += ["--jobs", str(jobs)] if jobs is not None else []
    words += ["--keep"] if keep else []
    summary = json.loads(ask(words, accept=(0, EXPECTATION_FAILED, CHILD_DIED, STALLED)))
    return Sweep(summary["folder"])
