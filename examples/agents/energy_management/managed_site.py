# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What both energy managers have in common: what they see of the site, and what they may do there."""
import hourly

import gridspace
from gridspace import Reads, Setting, Signal, Writes


class ManagedSite(gridspace.Agent):
    """Sees the buses and the battery of a site, and steers the battery and the compressors of a cold store."""

    battery = Setting("name", doc="the battery that it steers", element="battery", does="steers", defaults={"capacity_kwh": "capacity_kwh"})
    capacity_kwh = Setting("number", required=False, above=0, doc="energy of its cells; from the network when not given")
    battery_kw = Setting("number", above=0, doc="the most that it shall give or take")
    low_percent = Setting("number", 10, min=0, max=100, doc="state of charge that it is not discharged below")
    high_percent = Setting("number", 95, min=0, max=100, doc="state of charge that it is not charged above")

    compressors = Setting("name", doc="the load that the compressors are", element="load", does="steers",
                          defaults={"compressor_bus": "bus", "compressor_kw": "p_kw"})
    compressor_bus = Setting("text", required=False, doc="their bus, which has no other load; from the network when not given")
    compressor_kw = Setting("number", required=False, above=0, doc="power of one of them, which is what keeps the store cold in the mean")
    compressor_count = Setting("integer", 4, min=1, doc="how many there are")
    buffer_kwh = Setting("number", 20, above=0, doc="so far ahead of an even supply, or behind it, may the store be")

    others = Setting("names", doc="buses of all that nobody steers", element="bus")
    tariff = Setting("file", doc="prices by the hour: hour, import_eur_per_kwh, export_eur_per_kwh")
    day_h = Setting("number", 24, above=0, doc="at its end battery and store shall be where they began")
    period_s = Setting("fraction", 60, above=0, whole_steps=True, doc="time between two set-points")
    latency_us = Setting("fraction", 10_000_000, min=0, latency=True, doc="from measurement to set-point, in lockstep")

    measurements = Reads("bus_measurements", "BusMeasurement")
    battery_measurements = Reads("battery_measurements", "BatteryMeasurement")
    set_points = Writes("set_points", "SetPoint")
    wanted_kw = Signal("agent.{process}.wanted_battery_kw", "kW")
    running = Signal("agent.{process}.running_compressors", "")

    def begin(self):
        self.prices = hourly.tariff(self.tariff)
        self.bus_kw = {}  # consumption of each bus
        self.soc_percent = None
        self.served_kwh, self.served_until_s = 0.0, 0.0
        self.every(self.period_s, self.work)

    def on_measurements(self, measured):
        if measured.bus == self.compressor_bus:
            self.served_kwh += self.bus_kw.get(measured.bus, measured.p_kw) * (self.now_s - self.served_until_s) / 3600
            self.served_until_s = self.now_s
        self.bus_kw[measured.bus] = measured.p_kw

    def on_battery_measurements(self, measured):
        if measured.battery == self.battery:
            self.soc_percent = measured.soc_percent

    @property
    def need_kw(self):
        """What all that nobody steers takes; negative: gives."""
        return sum(self.bus_kw[bus] for bus in self.others)

    @property
    def ahead_kwh(self):
        """How far the cold store is ahead of an even supply."""
        return self.served_kwh - self.compressor_kw * self.served_until_s / 3600

    @property
    def hours_left(self):
        return max(0.0, self.day_h - self.now_s / 3600)

    def work(self):
        if self.soc_percent is None or any(bus not in self.bus_kw for bus in (*self.others, self.compressor_bus)):
            return  # nothing is known yet
        battery_kw, running = self.decide()
        self.ask(f"battery.{self.battery}", "p_kw", battery_kw)
        self.ask(f"load.{self.compressors}", "demand_pu", running)
        self.wanted_kw, self.running = battery_kw, running

    def decide(self):
        """Power of the battery (positive: into the network), and how many compressors shall run."""
        raise NotImplementedError

    def ask(self, element, quantity, value):
        self.set_points(element=element, quantity=quantity, value=value, valid_for_s=3 * float(self.period_s))
