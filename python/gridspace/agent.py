# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Agents: a class that says what it reads, writes and needs, and what it does. docs/reference/python.md."""
from __future__ import annotations

import ctypes
import functools
import inspect
import json
import pathlib
import re
import sys
import traceback
import types
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from gridspace import library
from gridspace.declaration import Declared, Reads, Setting, Signal, Writer, Writes
from gridspace.samples import Kept, Sample, sample_class, sample_type

_OWN = {"settings"}  # in addition to those of the class


def _references_of_a_local() -> int:
    sample = object()
    return sys.getrefcount(sample)


_ALONE = _references_of_a_local()  # whether a call counts what it is given depends on the version of Python
LEVELS = {"debug": 0, "info": 1, "warning": 2, "error": 3}


class Agent:
    """A member of a run, in lockstep and in real time.

    A subclass names its settings, topics and signals as attributes (Setting, Reads, Writes, Signal). It is called, in the order of
    simulated time: begin() once, on_ATTRIBUTE(sample) for a sample of a topic that it reads, and what it gave to every() and at().
    `program` is the name that scenarios and messages show; `role` its QoS role. The first line of its docstring describes it.

    Agent(setting=value, …) makes one without a run, for a test: `now_s` can then be set, and writers keep what they `sent`.
    """

    program = ""
    role = "member"

    def __init_subclass__(cls, **options: Any):
        super().__init_subclass__(**options)
        for name, value in vars(cls).items():
            if isinstance(value, Declared) and (hasattr(Agent, name) or name in _OWN):
                raise TypeError(f"{cls.__name__}.{name}: an agent has that attribute already; give it another name")

    def __init__(self, **settings: Any):
        unknown = settings.keys() - {s.name for s in _declared(type(self), Setting)}
        if unknown:
            raise TypeError(f"{type(self).__name__} has no setting '{min(unknown)}'")
        self._prepare(None, {s.name: settings.get(s.name, s.default) for s in _declared(type(self), Setting)})
        self._writers = {w.name: Writer(lambda writer, sample: writer.sent.append(sample),
                                        sample_type(w.type, _idl_file(type(self), w)) if w.type else types.SimpleNamespace)  # a stream: any members
                         for w in _declared(type(self), Writes)}

    def _prepare(self, handle: int | None, settings: dict[str, Any]) -> None:
        self._now_ns = 0
        self._handle, self._library = handle, library.load() if handle else None
        by_name = {s.name: s for s in _declared(type(self), Setting)}
        self.settings = {name: by_name[name].value(value) if name in by_name else value for name, value in settings.items()}
        vars(self).update((name, value) for name, value in self.settings.items() if name in by_name)  # read without a call, in each tick
        self._signals: dict[str, float | SignalValues] = {}
        self._columns: dict[str, dict[str, int]] = {}  # by attribute and value of the placeholder: the signal's number
        self._timers: dict[int, tuple[Callable[[], None], bool]] = {}

    # ---- what a subclass says

    def begin(self) -> None:
        """Once, in the first tick."""

    def end(self) -> None:
        """When the run is over. Nothing can be written any more."""

    # ---- what it may use

    @property
    def now_s(self) -> float:
        """Simulated seconds: of the sample or timer that it was called for."""
        return self._library.gridspace_now_s(self._handle) if self._handle else self._now_ns / 1e9

    @now_s.setter
    def now_s(self, time_s: float) -> None:  # of a test
        self._now_ns = round(time_s * 1e9)

    @property
    def now_ns(self) -> int:
        """The same in nanoseconds."""
        return self._library.gridspace_now_ns(self._handle) if self._handle else self._now_ns

    @property
    def process(self) -> str:
        """Its name in the scenario."""
        return self._library.gridspace_process(self._handle).decode() if self._handle else type(self).__name__

    @property
    def lockstep(self) -> bool:
        return not self._handle or bool(self._library.gridspace_is_lockstep(self._handle))

    @property
    def effect_ns(self) -> int:
        """When what it writes now takes effect."""
        return self._library.gridspace_effect_ns(self._handle) if self._handle else self.now_ns

    def every(self, period_s: float | Fraction | str, function: Callable[[], None]) -> int:
        """Calls the function at whole multiples of the period, from now on. Returns the timer, for cancel()."""
        text = str(Fraction(repr(float(period_s))) if isinstance(period_s, float) else period_s)  # float(): numpy writes its own otherwise
        return self._timer("every", text.encode(), function, True)

    def at(self, time_s: float, function: Callable[[], None]) -> int:
        """Calls the function once, at a simulated time. Returns the timer, for cancel()."""
        return self._timer("at", round(time_s * 1_000_000_000), function, False)

    def _timer(self, kind: str, when: Any, function: Callable[[], None], periodic: bool) -> int:
        number = getattr(self._library, f"gridspace_{kind}")(self._handle, when) if self._handle else len(self._timers)
        if number < 0:
            raise ValueError(library.last_error())
        self._timers[number] = (function, periodic)
        return number

    def cancel(self, timer: int) -> None:
        del self._timers[timer]
        if self._handle:
            self._library.gridspace_cancel(self._handle, timer)

    def log(self, text: str, level: str = "info") -> None:
        """A line of its log, with the simulated time: "debug", "info", "warning" or "error"."""
        if self._handle:
            self._library.gridspace_log(LEVELS[level], text.encode(errors="replace"))
        else:
            print(f"{level}  {text}", file=sys.stderr)

    # ---- how it is run

    @classmethod
    def main(cls, arguments: Sequence[str] | None = None) -> None:
        """Runs the program, and ends it with its exit code: `if __name__ == "__main__": MyAgent.main()`."""
        sys.stdout.reconfigure(line_buffering=True)
        words = [sys.argv[0], *(sys.argv[1:] if arguments is None else arguments)]
        if "--describe" in words:  # without the library: who asks waits, and a busy machine loads slowly
            print(json.dumps(cls.describe(), indent=1))
            sys.exit(0)
        sys.exit(_Life(cls).run(words))

    @classmethod
    def describe(cls) -> dict[str, Any]:
        """What `PROGRAM --describe` prints (docs/reference/program_description.md)."""
        settings, signals = _declared(cls, Setting), _declared(cls, Signal)
        latency = [s.name for s in settings if s.latency]
        return {
            "gridspace_program": 1,
            "name": cls.program or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", cls.__name__).lower(),
            "description": (inspect.cleandoc(cls.__doc__).splitlines()[0].rstrip(".") if cls.__dict__.get("__doc__") else ""),
            "role": cls.role,
            "daemon": True,
            "settings": [s.described() for s in settings],
            "whole_steps": [s.name for s in settings if s.whole_steps],
            **({"latency": latency[0]} if latency else {}),
            "elements": [{"key": s.name, "kind": s.element, "does": s.does, "defaults": [{"key": k, "quantity": q} for k, q in s.defaults.items()]}
                         for s in settings if s.element],
            "reads": [t.described() for t in _declared(cls, Reads)],
            "writes": [t.described() for t in _declared(cls, Writes)],
            "signals": [s.described() for s in signals],
        }


def _declared(cls: type[Agent], kind: type) -> list:
    """Attributes of a kind, in the order in which they are written, those of base classes first."""
    found: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        found.update({name: value for name, value in vars(base).items() if isinstance(value, kind)})
    return list(found.values())


def _folder(cls: type[Agent]) -> pathlib.Path:
    return pathlib.Path(inspect.getfile(cls)).resolve().parent


def _idl_file(cls: type[Agent], topic: Reads | Writes) -> pathlib.Path | None:
    return _folder(cls) / topic.idl if topic.idl else None


class _Life:
    """A run of an agent: what the library calls."""

    def __init__(self, cls: type[Agent]):
        self._cls, self._library = cls, library.load()
        self._agent: Agent | None = None
        self._handlers: list[tuple[type[Sample], Callable[[Sample], None] | None]] = []

    def run(self, words: Sequence[str]) -> int:
        description = json.dumps(self._cls.describe(), indent=1).encode()
        program = library.Program(ctypes.sizeof(library.Program), description, str(_folder(self._cls)).encode(), None,
                                  library.Begin(self._begin), library.SampleCame(self._sample), library.Due(self._due), library.End(self._end))
        return self._library.gridspace_main(ctypes.byref(program), len(words), (ctypes.c_char_p * len(words))(*[w.encode() for w in words]))

    def _failed(self, handle: int, e: BaseException) -> int:
        """An exception ends the run: its traceback is in the log, and it is the first thing that the message says."""
        traceback.print_exc()
        sys.stderr.flush()
        self._library.gridspace_fail(handle, _said(e, self._cls).encode(errors="replace"), b"the traceback is in its log")
        return -1

    # The callbacks: nothing may pass through the library, and each call more is paid in each tick.

    def _begin(self, handle: int, _user: int) -> int:
        try:
            self._open(handle)
            self._agent.begin()
            return 0
        except BaseException as e:
            return self._failed(handle, e)

    def _open(self, handle: int) -> None:
        cls = self._cls
        agent = self._agent = cls.__new__(cls)
        agent._prepare(handle, json.loads(self._library.gridspace_settings(handle)))
        topics = json.loads(self._library.gridspace_topics(handle))
        for end in topics["reads"]:
            reads = next(r for r in _declared(cls, Reads) if r.topic == end["declared"])
            self._handlers.append((sample_class(end["layout"]).from_address, getattr(agent, f"on_{reads.name}", None)))
        agent._writers = {}
        for number, end in enumerate(topics["writes"]):
            writes = next(w for w in _declared(cls, Writes) if w.topic == end["declared"])
            agent._writers[writes.name] = Writer(functools.partial(self._write, handle, number), sample_class(end["layout"]))
        for signal in _declared(cls, Signal):
            agent._columns[signal.name] = {s["value"]: number for number, s in enumerate(topics["signals"]) if s["declared"] == signal.signal}

    def _write(self, handle: int, number: int, _writer: Writer, sample: Sample) -> None:
        if self._library.gridspace_write(handle, number, ctypes.addressof(sample), ctypes.sizeof(sample)) != 0:
            raise ValueError(library.last_error())

    def _sample(self, handle: int, reader: int, address: int, _size: int, _user: int) -> int:
        try:
            made_of, handler = self._handlers[reader]
            if handler is not None:
                sample = made_of(address)
                sample.__dict__["_kept"] = None
                handler(sample)
                if sys.getrefcount(sample) > _ALONE:  # somebody still looks at it, or at a part: the memory stays as long as it does
                    sample.__dict__["_kept"] = Kept(address)
            return 0
        except BaseException as e:
            return self._failed(handle, e)

    def _due(self, handle: int, timer: int, _user: int) -> int:
        try:
            function, periodic = self._agent._timers[timer]
            if not periodic:
                del self._agent._timers[timer]
            function()
            return 0
        except BaseException as e:
            return self._failed(handle, e)

    def _end(self, handle: int, _user: int) -> None:
        try:
            if self._agent is not None:
                self._agent.end()
        except BaseException as e:
            self._failed(handle, e)


def _said(e: BaseException, cls: type[Agent]) -> str:
    """"ValueError: too low (ems.py:31 in decide)": the innermost line that is the agent's own."""
    frames = traceback.extract_tb(e.__traceback__)
    package = pathlib.Path(__file__).resolve().parent
    files = [pathlib.Path(f.filename).resolve() for f in frames]
    own = [f for f, file in zip(frames, files) if file.is_relative_to(_folder(cls)) and not file.is_relative_to(package)] or frames
    where = f" ({pathlib.Path(own[-1].filename).name}:{own[-1].lineno} in {own[-1].name})" if own else ""
    return f"{''.join(traceback.format_exception_only(e)).strip()}{where}"
