#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
import hourly

import gridspace
from gridspace import Reads, Setting, Signal


class Meter(gridspace.Agent):
    """Counts the energy of a site and what it costs. It steers nothing, and stays when the energy manager is lost."""

    program = "energy-meter"

    connection = Setting("name", element="bus", doc="where the site is connected to the grid")
    generation = Setting("names", element="bus", doc="buses of what generates")
    consumption = Setting("names", element="bus", doc="buses of what consumes")
    cold_store = Setting("name", element="bus", doc="bus of the cold store's compressors")
    even_kw = Setting("number", above=0, doc="power that would keep it cold in the mean")
    tariff = Setting("file", doc="prices by the hour: hour, import_eur_per_kwh, export_eur_per_kwh")
    period_s = Setting("fraction", 60, above=0, whole_steps=True, doc="time between two rows of its signals")

    measurements = Reads("bus_measurements", "BusMeasurement")
    price = Signal("agent.{process}.price_eur_per_kwh", "EUR/kWh")
    cost = Signal("agent.{process}.cost_eur", "EUR")
    imported = Signal("agent.{process}.imported_kwh", "kWh")
    exported = Signal("agent.{process}.exported_kwh", "kWh")
    generated = Signal("agent.{process}.generated_kwh", "kWh")
    consumed = Signal("agent.{process}.consumed_kwh", "kWh")
    self_consumption = Signal("agent.{process}.self_consumption_percent", "%")
    self_sufficiency = Signal("agent.{process}.self_sufficiency_percent", "%")
    ahead = Signal("agent.{process}.cold_store_ahead_kwh", "kWh")

    def begin(self):
        self.prices = hourly.tariff(self.tariff)
        self.last = {}  # by bus: time and power of its last measurement
        self.kwh = dict.fromkeys(("imported", "exported", "generated", "consumed", "cold"), 0.0)
        self.eur = 0.0
        self.every(self.period_s, self.publish)

    def on_measurements(self, measured):
        time_s, p_kw = self.last.get(measured.bus, (self.now_s, 0.0))
        self.count(measured.bus, time_s, p_kw * (self.now_s - time_s) / 3600)
        self.last[measured.bus] = (self.now_s, measured.p_kw)

    def count(self, bus, time_s, kwh):
        """Energy that a bus has consumed since time_s."""
        if bus == self.connection:  # the grid is a generator there
            self.kwh["imported"] += max(-kwh, 0.0)
            self.kwh["exported"] += max(kwh, 0.0)
            self.eur += max(-kwh, 0.0) * self.prices.at("import_eur_per_kwh", time_s) - max(kwh, 0.0) * self.prices.at("export_eur_per_kwh", time_s)
        if bus in self.generation:
            self.kwh["generated"] -= kwh
        if bus in self.consumption:
            self.kwh["consumed"] += kwh
        if bus == self.cold_store:
            self.kwh["cold"] += kwh

    def publish(self):
        self.price, self.cost = self.prices.at("import_eur_per_kwh", self.now_s), self.eur
        self.imported, self.exported = self.kwh["imported"], self.kwh["exported"]
        self.generated, self.consumed = self.kwh["generated"], self.kwh["consumed"]
        self.ahead = self.kwh["cold"] - self.even_kw * self.now_s / 3600
        if self.generated > 0:
            self.self_consumption = 100 * (1 - self.exported / self.generated)
        if self.consumed > 0:
            self.self_sufficiency = 100 * (1 - self.imported / self.consumed)


if __name__ == "__main__":
    Meter.main()
