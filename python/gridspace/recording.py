# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a finished run has recorded: signals, events, expectations."""
from __future__ import annotations

import csv
import dataclasses
import fnmatch
import functools
import json
import os
import pathlib
from array import array
from typing import Any

from gridspace.launcher import Error, ask


@dataclasses.dataclass(frozen=True)
class Signal:
    """A recorded signal: simulated seconds and values, arrays of doubles of the same length."""

    name: str
    time_s: array
    values: array

    def __len__(self) -> int:
        return len(self.values)

    def at(self, time_s: float) -> float:
        """The newest value at that time. Raises ValueError before the first."""
        import bisect

        place = bisect.bisect_right(self.time_s, time_s)
        if place == 0:
            raise ValueError(f"{self.name} begins at {self.time_s[0] if self.time_s else 'no time'} s, and {time_s} s is before that")
        return self.values[place - 1]


@dataclasses.dataclass(frozen=True)
class Event:
    """Something that happened, in simulated seconds."""

    time_s: float
    source: str
    event: str
    text: str


@dataclasses.dataclass(frozen=True)
class Expectation:
    """How an expectation was judged. passed is None when it was not: said of the wall clock, in lockstep."""

    name: str
    verb: str
    value: float | None
    unit: str
    low: float | None
    high: float | None
    passed: bool | None
    advisory: bool
    detail: str


class Run:
    """A run folder. Everything is read when it is first asked for."""

    def __init__(self, folder: str | os.PathLike):
        self.folder = pathlib.Path(folder).resolve()

    def __repr__(self) -> str:
        return f"<gridspace.Run {self.folder}>"

    @functools.cached_property
    def summary(self) -> dict[str, Any]:
        """report/summary.json."""
        return json.loads((self.folder / "report/summary.json").read_text())

    @functools.cached_property
    def manifest(self) -> dict[str, Any]:
        """manifest.json: versions, hashes, how each process ended."""
        return json.loads((self.folder / "manifest.json").read_text())

    @property
    def passed(self) -> bool:
        """Every process ended well, and every expectation that is not advisory holds."""
        return self.summary["exit"] == 0

    @functools.cached_property
    def expectations(self) -> list[Expectation]:
        names = {field.name for field in dataclasses.fields(Expectation)}
        return [Expectation(passed=e["pass"], **{k: v for k, v in e.items() if k in names}) for e in self.summary["expectations"]]

    @functools.cached_property
    def events(self) -> list[Event]:
        file = self.folder / "events.ndjson"
        lines = [json.loads(line) for line in file.read_text().splitlines() if line] if file.is_file() else []
        return [Event(float(e.get("time_s") or 0), e.get("source", ""), e.get("event", ""), e.get("text", "")) for e in lines]

    @functools.cached_property
    def _tables(self) -> dict[str, tuple[pathlib.Path, int]]:
        """Where each signal is: a file of RUN/csv and a column. The launcher writes the tables once."""
        folder = self.folder / "csv"
        data = self.folder / "data.mcap"
        if not any(folder.glob("signals*.csv")) or (data.exists() and folder.stat().st_mtime < data.stat().st_mtime):
            ask(["export", str(self.folder), "--csv", "--out", str(folder)])
        out = {}
        for file in sorted(folder.glob("signals*.csv")):
            with file.open(newline="") as stream:
                for column, name in enumerate(next(csv.reader(stream), [])):
                    if column > 0:
                        out[name] = (file, column)
        return out

    @property
    def signal_names(self) -> list[str]:
        return sorted(self._tables)

    def signals(self, *patterns: str) -> dict[str, Signal]:
        """Signals by name: those that fit one of the patterns ("bus.*.v_pu"); all without one. Raises KeyError for a pattern that fits none."""
        wanted = set()
        for pattern in patterns or ("*",):
            found = fnmatch.filter(self._tables, pattern)
            if not found:
                raise KeyError(f"no signal of {self.folder} fits '{pattern}'")
            wanted.update(found)
        out: dict[str, Signal] = {}
        for file in sorted({self._tables[name][0] for name in wanted}):
            columns = {self._tables[name][1]: name for name in wanted if self._tables[name][0] == file}
            out.update(_read(file, columns))
        return {name: out[name] for name in sorted(out)}

    def signal(self, name: str) -> Signal:
        """One signal by its exact name."""
        if name not in self._tables:
            raise KeyError(f"no signal of {self.folder} is called '{name}'")
        return self.signals(name)[name]

    def frame(self, *patterns: str):
        """The same as signals(), as a pandas DataFrame over simulated seconds; NaN where a signal has no value at a time."""
        try:
            import pandas
        except ImportError as e:
            raise Error("pandas is not installed: pip install pandas, or use signals()", 2) from e
        return pandas.DataFrame({n: pandas.Series(s.values, index=s.time_s) for n, s in self.signals(*patterns).items()})


def _read(file: pathlib.Path, columns: dict[int, str]) -> dict[str, Signal]:
    out = {name: Signal(name, array("d"), array("d")) for name in columns.values()}
    with file.open(newline="") as stream:
        rows = csv.reader(stream)
        next(rows, None)
        for row in rows:
            time_s = float(row[0])
            for column, name in columns.items():
                if row[column] != "":
                    out[name].time_s.append(time_s)
                    out[name].values.append(float(row[column]))
    return out


def open_run(folder: str | os.PathLike) -> Run:
    """The run in this folder. Raises Error when it is not the folder of a run."""
    run = Run(folder)
    if not (run.folder / "manifest.json").is_file():
        raise Error(f"'{folder}' is not the folder of a run: it has no manifest.json", 2)
    return run
