#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
from managed_site import ManagedSite

from gridspace import Setting


class RuleBased(ManagedSite):
    """Manages the energy of a site by rules: it looks at what is, and at the price of this hour."""

    program = "rule-based-energy-manager"

    cheap_eur_per_kwh = Setting("number", doc="up to this price the battery is filled to its reserve, and the cold store cooled ahead")
    dear_eur_per_kwh = Setting("number", doc="from this price on the battery gives all that is needed, and the compressors rest")
    reserve_percent = Setting("number", min=0, max=100, doc="state of charge that is kept for dear hours, and for the night")
    refill_kw = Setting("number", above=0, doc="power with which the battery is filled to its reserve")
    compressor_period_s = Setting("fraction", 900, above=0, whole_steps=True, doc="so long a number of compressors runs at least")

    def begin(self):
        self.chosen, self.choose_again_s = 1, 0.0
        super().begin()

    def decide(self):
        if self.now_s >= self.choose_again_s:
            self.chosen = self.choose_compressors()
            self.choose_again_s = self.now_s + float(self.compressor_period_s)
        return self.battery_power(self.need_kw + self.chosen * self.compressor_kw), self.chosen

    def choose_compressors(self):
        price = self.prices.at("import_eur_per_kwh", self.now_s)
        if price >= self.dear_eur_per_kwh:
            wanted = 0
        elif price <= self.cheap_eur_per_kwh:
            wanted = self.compressor_count
        else:
            wanted = max(1, int(-self.need_kw // self.compressor_kw))
        period_h = float(self.compressor_period_s) / 3600
        possible = [n for n in range(self.compressor_count + 1) if self.keeps_cold(n, period_h)]
        if not possible:
            return 0 if self.ahead_kwh > 0 else self.compressor_count
        return min(possible, key=lambda n: abs(n - wanted))

    def keeps_cold(self, n, period_h):
        """Whether the store stays within its buffer when n compressors run for a period, and can end the day where it began."""
        ahead = self.ahead_kwh + (n - 1) * self.compressor_kw * period_h
        later_kwh = self.compressor_kw * max(0.0, self.hours_left - period_h)  # that one compressor uses until the end
        return -min(self.buffer_kwh, (self.compressor_count - 1) * later_kwh) <= ahead <= min(self.buffer_kwh, later_kwh + self.compressor_kw * period_h)

    def battery_power(self, need_kw):
        """need_kw: what is missing at the site, or too much where it is negative."""
        price = self.prices.at("import_eur_per_kwh", self.now_s)
        wanted = 0.0
        if need_kw < 0 or price >= self.dear_eur_per_kwh or self.soc_percent > self.reserve_percent + 1:
            wanted = need_kw
        if price <= self.cheap_eur_per_kwh and self.soc_percent < self.reserve_percent:
            wanted = min(wanted, -self.refill_kw)
        if wanted > 0 and self.soc_percent <= self.low_percent or wanted < 0 and self.soc_percent >= self.high_percent:
            wanted = 0.0
        return min(max(wanted, -self.battery_kw), self.battery_kw)


if __name__ == "__main__":
    RuleBased.main()
