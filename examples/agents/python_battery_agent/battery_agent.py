#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
import gridspace
from gridspace import Reads, Setting, Writes


class BatteryAgent(gridspace.Agent):
    """Steers a battery so that its bus takes nothing from the grid and gives nothing back."""

    battery = Setting("name", doc="the battery that it steers", element="battery", does="steers", defaults={"bus": "bus"})
    bus = Setting("text", required=False, doc="where it is; from the network when not given")
    period_s = Setting("fraction", 10, above=0, whole_steps=True, doc="time between two set-points")
    latency_us = Setting("fraction", 1_000_000, min=0, latency=True, doc="from measurement to set-point, in lockstep")

    measurements = Reads("bus_measurements", "BusMeasurement")
    set_points = Writes("set_points", "SetPoint")

    def begin(self):
        self.net_kw = None
        self.wanted_kw = 0.0
        self.every(self.period_s, self.steer)

    def on_measurements(self, measured):
        if measured.bus == self.bus:
            self.net_kw = measured.p_kw  # positive: consumed; what the battery gives is counted

    def steer(self):
        if self.net_kw is None:
            return
        self.wanted_kw += self.net_kw
        self.set_points(element=f"battery.{self.battery}", quantity="p_kw", value=self.wanted_kw, valid_for_s=3 * float(self.period_s))


if __name__ == "__main__":
    BatteryAgent.main()
