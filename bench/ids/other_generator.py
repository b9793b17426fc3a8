#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Waveforms that nothing of Gridspace has made: a two-source line in plain Python, to try forecasters on data of another origin.

48,434 samples of 6 currents at 4800 Hz (the published number), as CSV for `gridspace ids evaluate`. Per phase, integrated by the
classical Runge-Kutta method: source 1, line, bus with a load, source 2. Frequency wanders; 5th and 7th harmonics; ratio errors and noise of the
transformers. A load step at 2 s, an angle jump of source 2 at 4 s, a fault behind the line from 6.0 to 6.07 s, a second load step
at 8 s, and a fault on the line at 9.9 s.
"""
import argparse
import math
import random
import sys

RATE, SUB, SAMPLES = 4800, 5, 48434
NOMINAL_PEAK_A = 60.0


class Phase:
    def __init__(self, number):
        self.shift = -2 * math.pi * number / 3
        self.i = [0.0, 0.0, 0.0]  # from end, to end, source 2

    def slopes(self, t, i, angle, r):
        # volts, ohms, henries
        e1 = 660.0 * math.cos(angle + self.shift) + 6 * math.cos(5 * angle + self.shift)
        e2 = 650.0 * math.cos(angle + self.shift - r["angle2"]) + 4 * math.cos(7 * angle + self.shift)
        l1, r1, ll, rl, l2, r2, lload = 2.1e-3, 0.12, 1.3e-3, 0.35, 3.4e-3, 0.2, 6e-3
        i_from, i_to, i2 = i
        load = i_to + i2
        if r["line_fault"]:
            near, rest = l1 + 0.4 * ll, 0.6 * ll
            vf = 0.08 * (i_from - i_to)
            d_from = (e1 - vf - (r1 + 0.4 * rl) * i_from) / near
            # bus: d(i_to) + d(i2) = d(load)
            a = (vf - 0.6 * rl * i_to) / rest + (e2 - r2 * i2) / l2 + r["load"] * load / lload
            vb = a / (1 / rest + 1 / l2 + 1 / lload)
            return [d_from, (vf - vb - 0.6 * rl * i_to) / rest, (e2 - vb - r2 * i2) / l2]
        la, ra = l1 + ll, r1 + rl
        if r["bus_fault"]:  # the load hardly matters then
            vb = 0.15 * load
        else:
            a = (e1 - ra * i_from) / la + (e2 - r2 * i2) / l2 + r["load"] * load / lload
            vb = a / (1 / la + 1 / l2 + 1 / lload)
        d = (e1 - vb - ra * i_from) / la
        return [d, d, (e2 - vb - r2 * i2) / l2]

    def step(self, t, h, angle, omega, r):
        def at(k, f):
            return [x + f * h * y for x, y in zip(self.i, k)]

        k1 = self.slopes(t, self.i, angle, r)
        k2 = self.slopes(t, at(k1, 0.5), angle + omega * h / 2, r)
        k3 = self.slopes(t, at(k2, 0.5), angle + omega * h / 2, r)
        k4 = self.slopes(t, at(k3, 1.0), angle + omega * h, r)
        self.i = [x + h / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(self.i, k1, k2, k3, k4)]


def regime(t):
    return {
        "load": 9.0 if t < 2 else 7.0 if t < 8 else 10.5,
        "angle2": math.radians(2.0 if t < 4 else 4.0),
        "bus_fault": 6.0 <= t < 6.07,
        "line_fault": t >= 9.9,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default="-", help="CSV file")
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--noise-percent", type=float, default=0.3, help="standard deviation, of the nominal peak")
    parser.add_argument("--samples", type=int, default=SAMPLES)
    a = parser.parse_args()
    rng = random.Random(a.seed)
    phases = [Phase(k) for k in range(3)]
    ratios = [1 + rng.gauss(0, 0.002) for _ in range(6)]
    angle, h = 0.0, 1.0 / (RATE * SUB)
    out = sys.stdout if a.out == "-" else open(a.out, "w")
    out.write("# bench/ids/other_generator.py, nominal peak %g A\n" % NOMINAL_PEAK_A)
    out.write("time_s,from_a,from_b,from_c,to_a,to_b,to_c\n")
    warm = RATE  # a second to settle, not written
    for n in range(-warm, a.samples):
        t = n / RATE
        omega = 2 * math.pi * (60 + 0.05 * math.sin(2 * math.pi * 0.2 * t))
        r = regime(t)
        if n >= 0:
            sigma = a.noise_percent / 100 * NOMINAL_PEAK_A
            row = [p.i[0] for p in phases] + [p.i[1] for p in phases]
            row = [round(x * g + rng.gauss(0, sigma), 3) for x, g in zip(row, ratios)]
            out.write("%.9f," % t + ",".join("%.3f" % x for x in row) + "\n")
        before = regime(t - 1 / RATE)
        if r["line_fault"] and not before["line_fault"]:
            for p in phases:
                p.i[1] = p.i[0]
        for _ in range(SUB):
            for p in phases:
                p.step(t, h, angle, omega, r)
            angle += omega * h
    if out is not sys.stdout:
        out.close()


if __name__ == "__main__":
    main()
