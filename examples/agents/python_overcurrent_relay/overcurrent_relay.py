#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
import gridspace
from gridspace import ReadsStream, Setting, Signal, WritesStream


class OvercurrentRelay(gridspace.Agent):
    """An instantaneous overcurrent relay: sampled values in, a trip by GOOSE out."""

    currents = Setting("name", doc="the stream of sampled values that it looks at")
    trip = Setting("name", doc="the GOOSE stream that it trips by; `status` is its trip")
    pickup_a = Setting("number", above=0, doc="a current above this, in any phase, for so many samples trips")
    samples = Setting("integer", 3, min=1, doc="samples in a row")
    latency_us = Setting("fraction", 900, min=0, latency=True, doc="from a sample to the message, in lockstep")

    samples_in = ReadsStream("{currents}")
    trip_out = WritesStream("{trip}")
    tripped = Signal("relay.{process}.trip")
    smp_cnt = Signal("relay.{process}.smp_cnt")

    def begin(self):
        self.in_a_row = 0
        self.trip_out(status=False)
        self.tripped = 0

    def on_samples_in(self, sample):
        if not sample.alive:
            self.in_a_row = 0
            return
        above = max(abs(sample.Ia), abs(sample.Ib), abs(sample.Ic)) > self.pickup_a
        self.in_a_row = self.in_a_row + 1 if above else 0
        if self.in_a_row == self.samples:
            self.trip_out(status=True)
            self.tripped, self.smp_cnt = 1, sample.smp_cnt


if __name__ == "__main__":
    OvercurrentRelay.main()
