# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a finished run has recorded: signals, events, expectations."""
from __future__ import annotations

import contextlib
import csv
import dataclasses
import datetime
import fnmatch
import functools
import json
import os
import pathlib
import re
import tempfile
from array import array
from collections.abc import Iterator
from typing import Any

from gridspace import frames, pcapng
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
        """report/summary.json. Raises Error when the run has not ended."""
        if not self._ended:
            raise Error(f"the run in '{self.folder}' has not ended: report/summary.json comes with its end", 2)
        return json.loads((self.folder / "report/summary.json").read_text())

    @property
    def _ended(self) -> bool:
        return (self.folder / "report/summary.json").is_file()

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
    def _csv(self) -> pathlib.Path:
        """The folder of the tables, RUN/csv. The launcher writes them once; it takes its name when all of them are there."""
        folder = self.folder / "csv"
        data = self.folder / "data.mcap"
        if not any(folder.glob("*.csv")) or (data.exists() and folder.stat().st_mtime < data.stat().st_mtime):
            with tempfile.TemporaryDirectory(prefix="csv.", dir=self.folder) as fresh:
                new = pathlib.Path(fresh, "new")
                ask(["export", str(self.folder), "--csv", "--out", str(new)])
                with contextlib.suppress(FileNotFoundError):
                    folder.rename(pathlib.Path(fresh, "old"))
                try:
                    new.rename(folder)
                except OSError:  # somebody else was faster
                    if not folder.is_dir():
                        raise
        return folder

    @functools.cached_property
    def _tables(self) -> dict[str, tuple[pathlib.Path, int]]:
        """Where each signal is: a file and a column."""
        out = {}
        for file in sorted(self._csv.glob("signals*.csv")):
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
                raise KeyError(f"no signal of {self.folder} fits '{pattern}'{'' if self._ended else '; the run has not ended, open it again later'}")
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

    def frame(self, *patterns: str, every_s: float | None = None):
        """The same as signals(), as a pandas DataFrame over simulated seconds; NaN where a signal has no row at a time.

        every_s: rows at multiples of it instead, with the newest value of each signal; NaN before its first. Of rows of one signal about
        the same time the last counts.
        """
        try:
            import pandas
        except ImportError as e:
            raise Error("pandas is not installed: on Debian python3-pandas, elsewhere pip install pandas; or use signals()", 2) from e
        columns = {}
        for name, signal in self.signals(*patterns).items():
            series = pandas.Series(signal.values, index=pandas.Index(signal.time_s, name="time_s"), dtype=float)
            columns[name] = series[~series.index.duplicated(keep="last")]
        table = pandas.DataFrame(columns)
        if every_s is not None:
            # In whole nanoseconds, as rows are stamped: as binary fractions 3 * 0.3 is before 0.9, and a row about 0.9 s would not count.
            table.index = [round(t * 1e9) for t in table.index]
            end = int((table.index[-1] + 0.5) / (every_s * 1e9)) if len(table) else 0
            table = table.ffill().reindex([round(i * every_s * 1e9) for i in range(end + 1)], method="ffill")
            table.index = pandas.Index([i * every_s for i in range(end + 1)], name="time_s")
        return table

    @property
    def topics(self) -> list[str]:
        """Recorded topics, those of the signals apart."""
        return sorted(file.stem for file in self._csv.glob("*.csv") if not file.stem.startswith("signals"))

    def samples(self, topic: str) -> list[dict[str, Any]]:
        """The samples of a topic in their order: time_s, process, and the members as `gridspace export` writes them."""
        if topic not in self.topics:
            raise KeyError(f"no topic of {self.folder} is called '{topic}'; there are {', '.join(self.topics)}")
        with (self._csv / f"{topic}.csv").open(newline="") as stream:
            return [{name: _value(text) for name, text in row.items()} for row in csv.DictReader(stream)]

    def frames(self, port: str = "*") -> Iterator[frames.Frame]:
        """Captured Ethernet frames (bus.pcapng.gz) in their order, of the ports that fit the pattern. A frame that is too short to be one is left out.

        Their time_s is simulated time; in real time that of what was simulated when they were captured, where the capture says it.
        """
        epoch = datetime.datetime.fromisoformat(self.manifest["clock"]["epoch"].replace("Z", "+00:00"))
        epoch_ns, lockstep = round(epoch.timestamp()) * 1_000_000_000, self.manifest["clock"]["mode"] == "lockstep"
        plain = self.folder / "bus.pcapng"
        for packet in pcapng.read(plain if plain.exists() else self.folder / "bus.pcapng.gz"):
            if len(packet.octets) >= 18 and fnmatch.fnmatchcase(packet.interface, port):
                time_s = (packet.time_ns - epoch_ns) / 1e9 if lockstep else _simulated(packet.comment)
                yield frames.parse(packet.octets, time_s, packet.time_ns, packet.interface, packet.direction)

    def sampled_values(self, stream: str = "*", port: str = "*") -> Iterator[frames.SampledValue]:
        """Sampled values in captured frames, of the streams (svID) that fit the pattern. Raises ValueError for a frame that cannot be read."""
        for frame in self.frames(port):
            yield from (s for s in frames.sampled_values(frame) if fnmatch.fnmatchcase(s.stream, stream))

    def goose(self, stream: str = "*", port: str = "*") -> Iterator[frames.Goose]:
        """GOOSE messages in captured frames, of the streams (gocbRef) that fit the pattern. Raises ValueError for a frame that cannot be read."""
        messages = (frames.goose(frame) for frame in self.frames(port))
        yield from (m for m in messages if m is not None and fnmatch.fnmatchcase(m.stream, stream))

    def plot(self, *patterns: str, from_s: float = 0.0, until_s: float | None = None, events: bool = False, axes: Any = None, **style: Any) -> Any:
        """Draws signals with matplotlib, over hours, minutes, seconds or milliseconds, and returns the axes. events: what happened, too.

        style: what matplotlib's plot() takes: drawstyle="steps-post".
        """
        from gridspace import plots

        return plots.plot(self, patterns, from_s=from_s, until_s=until_s, events=events, axes=axes, style=style)


def _value(text: str | None) -> Any:
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except (TypeError, ValueError):
            pass
    return text


def _simulated(comment: str) -> float:
    """The simulated time that the comment of a frame says; NaN where it says none."""
    found = re.search(r"simulated time (-?[\d.]+) s", comment)
    return float(found[1]) if found else float("nan")


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
