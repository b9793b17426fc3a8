#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
import gridspace
from gridspace import Reads, Setting, Signal, Writes


class EvAgent(gridspace.Agent):
    """EV agent in Python: asks for the charging current that its EV needs."""

    role = "ev_agent"
    ev = Setting("name", doc="the EV that it acts for", element="ev", does="acts for", defaults={"bus": "bus", "capacity_kwh": "capacity_kwh"})
    bus = Setting("text", required=False, doc="bus of the EV; from the network when not given")
    capacity_kwh = Setting("number", 24, above=0, doc="energy of the battery; from the network when not given")
    battery_v = Setting("number", 360, above=0, doc="voltage of the battery")
    rated_current_a = Setting("number", 15, above=0, doc="most that it asks for")
    soc_target_percent = Setting("number", 80, min=0, max=100, doc="wanted state of charge")
    requested_h = Setting("number", 4, above=0, doc="time after the start in which it shall be reached")
    time_base = Setting("word", "remaining", words=("remaining", "fixed"), doc="what is left of requested_h, or requested_h")
    min_remaining_h = Setting("number", 0.1, above=0, doc="least of what is left")
    period_s = Setting("fraction", 360, above=0, whole_steps=True, doc="time between two requests")
    latency_us = Setting("fraction", 0, min=0, latency=True, doc="from measurement to request, in lockstep")

    measurements = Reads("bus_measurements", "BusMeasurement", only={"bus": "{bus}"})
    requests = Writes("requests", "ChargingRequest")
    requested_a = Signal("agent.{process}.requested_a", "A")
    v_pu = Signal("agent.{process}.v_pu", "p.u.")

    def begin(self):
        self.seen, self.request_period_s = None, float(self.period_s)
        self.every(self.period_s, self.ask)

    def on_measurements(self, measured):
        self.seen = next(((measured.v_pu, ev.soc_percent) for ev in measured.evs if ev.ev == self.ev), self.seen)

    def ask(self):
        if self.seen is None:
            return self.log(f"no measurement of {self.ev} at {self.bus} yet: no request", "warning")
        v_pu, soc_percent = self.seen
        current_a = self.wanted_a(soc_percent)
        self.requests(ev=self.ev, current_a=current_a, v_pu=v_pu, soc_percent=soc_percent, period_s=self.request_period_s)
        self.requested_a, self.v_pu = current_a, v_pu

    def wanted_a(self, soc_percent):
        """Eq. (1): I = (target - SoC) x capacity / (time x voltage); Eq. (2): capped at the rated current."""
        missing = max((self.soc_target_percent - soc_percent) / 100, 0)
        left_h = max(self.requested_h - self.now_s / 3600, self.min_remaining_h) if self.time_base == "remaining" else self.requested_h
        return min(missing * self.capacity_kwh * 1e3 / (left_h * self.battery_v), self.rated_current_a)


if __name__ == "__main__":
    EvAgent.main()
