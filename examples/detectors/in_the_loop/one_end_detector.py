#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A detector that is not Gridspace's, in the loop: it hears both ends of a line as frames, and a relay asks for its verdicts."""
import collections
import math

import gridspace
from gridspace import ReadsStream, Setting, Signal, Writes

JUDGED, FLAGGED = 1, 2  # idl/intrusion.idl


class End:
    """How far each sample of one end is from the sinusoid through the two before it, as a share of the largest of the last cycle."""

    def __init__(self, rate_hz, frequency_hz):
        self.turn = 2 * math.cos(2 * math.pi * frequency_hz / rate_hz)
        self.recent = collections.deque(maxlen=round(rate_hz / frequency_hz))
        self.kinks = {}

    def take(self, number, currents):
        peak = max((abs(i) for old in self.recent for i in old), default=0.0)
        if len(self.recent) == self.recent.maxlen and peak > 0:
            one, two = self.recent[-1], self.recent[-2]
            self.kinks[number] = max(abs(i - self.turn * a + b) for i, a, b in zip(currents, one, two)) / peak
        else:
            self.kinks[number] = None
        self.recent.append(currents)


class OneEndDetector(gridspace.Agent):
    """A fault kinks the currents of both ends at one instant; a forged stream kinks alone, and is flagged."""

    current_from = Setting("name", doc="stream of one end of the line")
    current_to = Setting("name", doc="stream of the other end")
    verdicts = Setting("name", doc="topic of its verdicts")
    limit = Setting("number", 0.1, above=0, doc="a kink, as a share of the largest current of the last cycle")
    beside = Setting("integer", 2, min=0, doc="samples before and after in which the other end must kink too")
    rate_hz = Setting("number", 4800, above=0, doc="samples a second")
    frequency_hz = Setting("number", 60, above=0, doc="of the grid")
    latency_us = Setting("fraction", 100, min=0, latency=True, doc="from a sample to the verdict, in lockstep")

    from_in, to_in = ReadsStream("{current_from}"), ReadsStream("{current_to}")
    verdict = Writes("{verdicts}", "IdsVerdict")
    flagged = Signal("detector.{process}.flagged")

    def begin(self):
        self.ends = {self.current_from: End(self.rate_hz, self.frequency_hz), self.current_to: End(self.rate_hz, self.frequency_hz)}
        self.next, self.count = None, 0
        self.flagged = 0

    def on_from_in(self, sample):
        self.take(self.current_from, sample)

    def on_to_in(self, sample):
        self.take(self.current_to, sample)

    def take(self, stream, sample):
        if not sample.alive:
            return
        second = round(self.now_ns / 1e9 - sample.smp_cnt / self.rate_hz)
        number = round(second * self.rate_hz) + sample.smp_cnt
        self.ends[stream].take(number, (sample.Ia, sample.Ib, sample.Ic))
        if self.next is None:
            self.next = number
        while all(self.next + self.beside in end.kinks for end in self.ends.values()):
            self.judge(self.next)
            self.next += 1

    def judge(self, number):
        around = range(number - self.beside, number + self.beside + 1)
        for stream, end in self.ends.items():
            other = next(e for s, e in self.ends.items() if s != stream)
            kink = end.kinks.get(number)
            answered = any((other.kinks.get(n) or 0) > self.limit / 2 for n in around)
            flag = kink is not None and kink > self.limit and not answered
            phase = {"flags": (JUDGED if kink is not None else 0) | (FLAGGED if flag else 0)}
            self.verdict(detector=self.process, stream=stream, time_ns=self.effect_ns, first_index=number, rate_num=round(self.rate_hz), rate_den=1,
                         samples=[{"a": phase, "b": phase, "c": phase}])
            if flag:
                self.count += 1
                self.flagged = self.count
        for end in self.ends.values():
            end.kinks.pop(number - self.beside - 1, None)


if __name__ == "__main__":
    OneEndDetector.main()
