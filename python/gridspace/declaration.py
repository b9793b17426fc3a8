# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What an agent says of itself, as attributes of its class: settings, topics, signals (docs/reference/program_description.md)."""
from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from gridspace import library
from gridspace.samples import Sample

if TYPE_CHECKING:
    from gridspace.agent import Agent


class Declared:
    """An attribute that knows its name."""

    name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name


class Setting(Declared):
    """A setting: its kind ("number", "fraction", "integer", "text", "name", "flag", "word", …), its default, doc and range.

    Without a default it must be given, unless required=False; it is None then. element: the kind of element that it names; does: what
    only one process may do for an element ("acts for"); defaults: settings that are taken from the element, by its quantity
    ({"bus": "bus"}). whole_steps: it is a whole multiple of the step. latency: it is the latency, in microseconds.
    """

    def __init__(self, kind: str, default: Any = None, *, doc: str = "", required: bool | None = None, min: float | None = None,  # noqa: A002
                 max: float | None = None, above: float | None = None, below: float | None = None, words: tuple[str, ...] = (),  # noqa: A002
                 keys: list[dict] | None = None, element: str = "", does: str = "", defaults: Mapping[str, str] | None = None,
                 whole_steps: bool = False, latency: bool = False):
        self.kind, self.default, self.doc = kind, default, doc
        self.required = default is None if required is None else required
        self.range = {k: v for k, v in (("min", min), ("max", max), ("above", above), ("below", below)) if v is not None}
        self.words, self.keys, self.element, self.does, self.defaults = words, keys, element, does, defaults or {}
        self.whole_steps, self.latency = whole_steps, latency

    def __get__(self, agent: Agent | None, owner: type | None = None) -> Any:
        return self if agent is None else agent.settings.get(self.name)

    def described(self) -> dict[str, Any]:
        out: dict[str, Any] = {"key": self.name, "kind": self.kind, "doc": self.doc, **self.range}
        if self.required:
            out["required"] = True
        if self.default is not None:
            out["default"] = str(self.default).lower() if isinstance(self.default, bool) else str(self.default)
        if self.words:
            out["words"] = list(self.words)
        if self.keys:
            out["keys"] = self.keys
        return out

    def value(self, given: Any) -> Any:
        """As the agent sees it: a fraction is exact."""
        return Fraction(str(given)) if self.kind == "fraction" and given is not None else given


class Topic(Declared):
    """A topic and the type of its samples. idl: the file that defines it, from the folder of the agent; without it a type of Gridspace."""

    def __init__(self, topic: str, type: str, *, optional: bool = False, idl: str | None = None):  # noqa: A002
        self.topic, self.type, self.optional, self.idl = topic, type, optional, idl

    def described(self) -> dict[str, Any]:
        return {"topic": self.topic, "type": self.type, **({"optional": True} if self.optional else {}), **({"idl": self.idl} if self.idl else {})}


class Reads(Topic):
    """A topic that the agent reads: a sample is given to its method on_ATTRIBUTE. triggers: in the same tick as it was written. only: the
    samples that it wants, by texts in them ({"bus": "{bus}"}); others cost nothing."""

    def __init__(self, topic: str, type: str, *, triggers: bool = False, optional: bool = False, idl: str | None = None,  # noqa: A002
                 only: Mapping[str, str] | None = None):
        super().__init__(topic, type, optional=optional, idl=idl)
        self.triggers, self.only = triggers, dict(only or {})

    def described(self) -> dict[str, Any]:
        return {**super().described(), **({"triggers": True} if self.triggers else {}), **({"only": self.only} if self.only else {})}


class Writes(Topic):
    """A topic that the agent writes: self.ATTRIBUTE(member=value, …) sends a sample, self.ATTRIBUTE.write(sample) one that is there."""

    def __get__(self, agent: Agent | None, owner: type | None = None) -> Any:
        return self if agent is None else agent._writers[self.name]


class ReadsStream(Reads):
    """A stream of sampled values or GOOSE of the scenario: a sample, or a message, is given to its method on_ATTRIBUTE. Beside the members
    of its data set ("mag.f" is mag_f) it has time_ns, alive, and smp_cnt and smp_synch or st_num and sq_num."""

    def __init__(self, stream: str):
        super().__init__(stream, "")

    def described(self) -> dict[str, Any]:
        return {"stream": self.topic}


class WritesStream(Writes):
    """A stream that the agent publishes: self.ATTRIBUTE(member=value, …) gives it new values. GOOSE is repeated, and sampled values are sent
    at their rate, without its doing."""

    def __init__(self, stream: str):
        super().__init__(stream, "")

    def described(self) -> dict[str, Any]:
        return {"stream": self.topic}


class Signal(Declared):
    """A signal of the agent, for recording and display: self.ATTRIBUTE = value. Where the pattern names several: self.ATTRIBUTE[name] = value."""

    def __init__(self, name: str, unit: str = "", *, rate_hz: float = 0):
        self.signal, self.unit, self.rate_hz = name, unit, rate_hz

    def described(self) -> dict[str, Any]:
        return {"name": self.signal, "unit": self.unit, "rate_hz": self.rate_hz}

    def __get__(self, agent: Agent | None, owner: type | None = None) -> Any:
        if agent is None:
            return self
        if self.several:
            return agent._signals.setdefault(self.name, SignalValues(self, agent))
        return agent._signals.get(self.name)

    def __set__(self, agent: Agent, value: float) -> None:
        columns = agent._columns.get(self.name, {})
        if agent._handle and len(columns) != 1:
            names = ", ".join(f"self.{self.name}[{v!r}]" for v in columns)
            raise ValueError(f"'{self.signal}' is no signal here: what it is named after is not given" if not columns
                             else f"'{self.signal}' is several signals, set one of them: {names}")
        self.publish(agent, next(iter(columns), ""), value)
        agent._signals[self.name] = float(value)

    def publish(self, agent: Agent, which: str, value: float) -> None:
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"the signal '{self.signal}' is {number}, which is not finite")
        if agent._handle and agent._library.gridspace_signal(agent._handle, agent._columns[self.name][which], number) != 0:
            raise ValueError(library.last_error())

    @property
    def several(self) -> bool:
        """Whether the pattern may name several: it has a placeholder beside the process."""
        return "{" in self.signal.replace("{process}", "")


class SignalValues(dict):
    """The newest values of the signals that one pattern names, by what is filled in: self.ATTRIBUTE["EV1"] = value."""

    def __init__(self, signal: Signal, agent: Agent):
        super().__init__()
        self._signal, self._agent = signal, agent

    def __setitem__(self, which: str, value: float) -> None:
        columns = self._agent._columns.get(self._signal.name, {})
        if self._agent._handle and which not in columns:
            raise KeyError(f"'{self._signal.signal}' is no signal for '{which}', but for: {', '.join(columns) or 'nothing, its setting is not given'}")
        self._signal.publish(self._agent, which, value)
        super().__setitem__(which, float(value))


class Writer:
    """The writing end of a topic. `sent`: what was written without a run, by a test."""

    def __init__(self, send: Any, sample_type: type[Sample]):
        self._send, self.type, self.sent = send, sample_type, []

    def __call__(self, **members: Any) -> None:
        self.write(self.type(**members))

    def write(self, sample: Sample) -> None:
        """Raises TypeError for a sample of another type, ValueError for what the type does not allow."""
        if type(sample) is not self.type:
            raise TypeError(f"a {type(sample).__name__} was written, and the topic has {self.type.__name__}")
        self._send(self, sample)
