# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A frequency-dependent overhead line against its exact equations. The oracle shares nothing with the simulator: impedances from the
conductors' places (complex depth, skin effect by a continued fraction), hyperbolic functions of each mode, and the time functions by
a numerical inverse Laplace transform [Wilcox, Int. J. Elect. Enging Educ. 15, 1978]."""
import cmath
import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"

# A horizontal 400 kV tower with bundles of two and two earth wires: phase, x, height, radius (m), ohm/km.
WIRES = [(phase, x + dx, 18.0, 0.0135, 0.0728) for phase, x in (("a", -11.0), ("b", 0.0), ("c", 11.0)) for dx in (-0.2, 0.2)] + [
    ("earth", -7.0, 27.0, 0.0056, 0.36), ("earth", 7.0, 27.0, 0.0056, 0.36)]
EARTH_OHM_M, KM, HZ, VOLTS = 250.0, 150.0, 50.0, 400000.0
PEAK = VOLTS * math.sqrt(2 / 3)
OMEGA = 2 * math.pi * HZ
MU0, EPSILON0 = 4e-7 * math.pi, 8.8541878128e-12


def wire_ohm(s, radius, ohm_per_m):
    """R z/2 I0(z) / I1(z): I1/I0 = 1/(2/z + 1/(4/z + 1/(6/z + ...)))."""
    z = cmath.sqrt(s * MU0 / (math.pi * ohm_per_m))
    tail = 0
    for n in range(int(abs(z)) + 40, 0, -1):
        tail = 1 / (2 * n / z + tail)
    return ohm_per_m * z / 2 / tail


def solved(m, right):
    """Gauss with the largest pivot: the columns x of m x = right."""
    n, rows = len(m), [list(a) + list(b) for a, b in zip(m, right)]
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(n):
            if i != k and rows[i][k] != 0:
                f = rows[i][k] / rows[k][k]
                rows[i] = [a - f * b for a, b in zip(rows[i], rows[k])]
    return [[x / rows[k][k] for x in rows[k][n:]] for k in range(n)]


def sequences(full):
    """Positive and zero sequence of what 1/(sum of the inverse by phase) leaves of a matrix of all wires."""
    own = [[float(w[0] == p) for p in "abc"] for w in WIRES]
    inverse = solved(full, own)
    by_phase = [[sum(inverse[i][k] for i in range(len(WIRES)) if own[i][j]) for k in range(3)] for j in range(3)]
    m = solved(by_phase, [[1.0 * (i == j) for j in range(3)] for i in range(3)])
    own_value, mutual = sum(m[i][i] for i in range(3)) / 3, (m[0][1] + m[0][2] + m[1][2]) / 3
    return own_value - mutual, own_value + 2 * mutual


def images(depth):
    """ln(D'/d) of all pairs; the image is 2 `depth` deeper."""
    out = []
    for i, (_, x, h, r, _) in enumerate(WIRES):
        out.append([])
        for j, (_, y, g, _, _) in enumerate(WIRES):
            apart = r if i == j else math.hypot(x - y, h - g)
            out[i].append(cmath.log(cmath.sqrt((h + g + 2 * depth) ** 2 + (x - y) ** 2) / apart))
    return out


FARAD = [1 / (p / (2 * math.pi * EPSILON0)).real for p in sequences(images(0))]


def modes(s):
    """(Zc, gamma l) of positive and zero sequence."""
    z = [[s * MU0 / (2 * math.pi) * x for x in row] for row in images(1 / cmath.sqrt(s * MU0 / EARTH_OHM_M))]
    for i, (_, _, _, radius, ohm) in enumerate(WIRES):
        z[i][i] += wire_ohm(s, radius, ohm * 1e-3)
    return [(cmath.sqrt(ohm / (s * c)), cmath.sqrt(ohm * s * c) * KM * 1e3) for ohm, c in zip(sequences(z), FARAD)]


def inverse_cosh(x):
    e = cmath.exp(-x)
    return 2 * e / (1 + e * e)


def tanh(x):
    e = cmath.exp(-2 * x)
    return (1 - e) / (1 + e)


class Laplace:
    """Time functions 0 <= t < END, of transforms at 2^13 odd frequencies with a Hann window."""
    END, COUNT = 0.02, 8192
    PERIOD = 2 * END
    DAMPING = math.log(1e6) / PERIOD

    def __init__(self):
        self.s = [complex(self.DAMPING, (2 * k + 1) * math.pi / self.PERIOD) for k in range(self.COUNT)]
        self.modes = [modes(s) for s in self.s]

    def times(self):
        return [n * self.PERIOD / self.COUNT for n in range(self.COUNT // 2)]

    def inverse(self, function):
        values = [function(s, *m) * (0.5 + 0.5 * math.cos(math.pi * k / self.COUNT)) for k, (s, m) in enumerate(zip(self.s, self.modes))]
        turned = fourier(values)
        return [2 / self.PERIOD * math.exp(self.DAMPING * t) * (turned[n] * cmath.exp(1j * math.pi * n / self.COUNT)).real
                for n, t in enumerate(self.times())]


def fourier(x):
    """sum x_k exp(2 pi j k n / N), N a power of two."""
    if len(x) == 1:
        return x
    even, odd = fourier(x[::2]), fourier(x[1::2])
    turned = [cmath.exp(2j * math.pi * n / len(x)) * o for n, o in enumerate(odd)]
    return [e + t for e, t in zip(even, turned)] + [e - t for e, t in zip(even, turned)]


def sine(s, phasor):
    """Of Re(phasor exp(j w t))."""
    return (s * phasor.real - OMEGA * phasor.imag) / (s * s + OMEGA * OMEGA)


class Refused(Exception):
    pass


class FrequencyDependent(unittest.TestCase):
    FAULT_OHM = 5.0

    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.holder.name)
        cls.laplace = Laplace()
        cls.nominal = modes(1j * OMEGA)

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def simulated(self, signals, *, model="frequency_dependent", state="closed", events=None, until=0.021, step="1/1000000"):
        network = {
            "gridspace_network": 1, "name": "line", "base": {"frequency_hz": HZ, "power_kva": 1e6},
            "buses": {"A": {"voltage_v": VOLTS}, "B": {"voltage_v": VOLTS}}, "sources": {"S": {"bus": "A"}},
            "line_types": {"tower": {"earth_ohm_m": EARTH_OHM_M, "conductors": [
                {"phase": p, "x_m": x, "height_m": h, "radius_m": r, "dc_ohm_per_km": ohm} for p, x, h, r, ohm in WIRES]}},
            "lines": {"L": {"from": "A", "to": "B", "type": "tower", "length_km": KM, "model": model}},
            "breaker_types": {"t": {}}, "breakers": {"K": {"line": "L", "end": "from", "type": "t", "state": state}}}
        (self.folder / "n.yaml").write_text(json.dumps(network))
        (self.folder / "e.yaml").write_text(json.dumps({"events": events or {}}))
        table = self.folder / "o.csv"
        command = [BIN, "simulate", self.folder / "n.yaml", "--until", f"{until}s", "--step", step, "--quiet", "--csv", table,
                   "--signals", ",".join(signals)]
        done = subprocess.run(list(map(str, command + (["--events", self.folder / "e.yaml"] if events else []))), capture_output=True,
                              text=True, timeout=300, check=False)
        if done.returncode != 0:
            raise Refused(done.returncode, done.stderr)
        rows = list(csv.reader(table.read_text().splitlines()))
        self.assertEqual(rows[0][1:], list(signals))
        return [[float(x) for x in row] for row in rows[1:]]

    def difference(self, rows, column, expected, start):
        """Root mean square and largest of what the simulation has from `start` on, over the largest of the oracle's."""
        step = rows[1][0] - rows[0][0]
        worst = square = count = 0
        for t, value in zip(self.laplace.times(), expected):
            at = (start + t) / step
            n = int(at + 1e-9)
            if n + 1 >= len(rows):
                break
            got = rows[n][column] + (at - n) * (rows[n + 1][column] - rows[n][column])
            worst, square, count = max(worst, abs(got - value)), square + (got - value) ** 2, count + 1
        peak = max(map(abs, expected))
        return math.sqrt(square / count) / peak, worst / peak

    def energised(self, model):
        start = 0.001
        rows = self.simulated(["bus.B.v.a", "bus.B.v.b"], model=model, state="open", events={"e": {"at_s": start, "close": ["K"]}})
        out = []
        for k in (0, 1):
            phasor = PEAK * cmath.exp(1j * (OMEGA * start - k * 2 * math.pi / 3))
            out.append(self.difference(rows, 1 + k, self.laplace.inverse(lambda s, one, _: sine(s, phasor) * inverse_cosh(one[1])), start))
        return out

    def faulted(self, model):
        """Phase a to earth at the open end: voltage of phase b there, current of phase a at the source."""
        start = 0.001
        rows = self.simulated(["bus.B.v.b", "line.L.from.i.a"], model=model, events={"f": {"at_s": start, "apply_fault": {
            "bus": "B", "type": "1ph_g", "resistance_ohm": self.FAULT_OHM}}})
        before = [PEAK * cmath.exp(1j * (OMEGA * start - k * 2 * math.pi / 3)) * inverse_cosh(self.nominal[0][1]) for k in (0, 1)]
        charging = PEAK * cmath.exp(1j * OMEGA * start) * tanh(self.nominal[0][1]) / self.nominal[0][0]

        def fault_current(s, one, zero):
            return sine(s, before[0]) / (self.FAULT_OHM + (2 * one[0] * tanh(one[1]) + zero[0] * tanh(zero[1])) / 3)

        voltage = self.laplace.inverse(lambda s, one, zero: sine(s, before[1]) - (
            zero[0] * tanh(zero[1]) - one[0] * tanh(one[1])) / 3 * fault_current(s, one, zero))
        current = self.laplace.inverse(lambda s, one, zero: sine(s, charging) + (
            2 * inverse_cosh(one[1]) + inverse_cosh(zero[1])) / 3 * fault_current(s, one, zero))
        return [self.difference(rows, 1, voltage, start), self.difference(rows, 2, current, start)]

    def test_the_open_end_after_energising_is_that_of_the_exact_equations(self):
        for mean, worst in self.energised("frequency_dependent"):
            self.assertLess(mean, 0.0025)
            self.assertLess(worst, 0.1)  # at the fronts, which the oracle's window rounds off
        for mean, _ in self.energised("bergeron"):  # negative control
            self.assertGreater(mean, 0.03)

    def test_an_earth_fault_at_the_end_is_that_of_the_exact_equations(self):
        for mean, worst in self.faulted("frequency_dependent"):
            self.assertLess(mean, 0.001)
            self.assertLess(worst, 0.04)
        for mean, _ in self.faulted("bergeron"):  # negative control
            self.assertGreater(mean, 0.04)

    def test_the_steady_state_is_that_of_the_exact_equations_and_stays(self):
        rows = self.simulated(["bus.B.v_pu", "line.L.from.i_a"], step="1/48000", until=0.1)
        (surge, gamma), _ = self.nominal
        volts, amperes = abs(inverse_cosh(gamma)), abs(PEAK * tanh(gamma) / surge) / math.sqrt(2)
        self.assertAlmostEqual(rows[0][1] / volts, 1, delta=1e-6)
        self.assertAlmostEqual(rows[0][2] / amperes, 1, delta=5e-6)
        self.assertLess(max(abs(row[1] - rows[0][1]) for row in rows), 1e-9)

    def test_a_fault_elsewhere_inside_is_refused_before_the_run(self):
        with self.assertRaises(Refused) as refused:
            self.simulated(["bus.B.v.a"], events={"f": {"at_s": 0.001, "apply_fault": {"line": "L", "position_percent": 40, "type": "1ph_g"}}})
        code, text = refused.exception.args
        self.assertEqual(code, 2)
        self.assertRegex(text, r"e\.yaml:1:\d+: error: event 'f' has a fault at 40 % of line 'L', but a frequency-dependent line is not cut")
        self.assertIn("fault_places_percent", text)


if __name__ == "__main__":
    unittest.main()
