#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Small unbalanced circuits by Kirchhoff's loop equations, written by hand for each: another way than the nodal matrix
of sim/opendss. Prints what tests/unit/opendss/circuit_test.cpp compares with: name, magnitude in V, angle in degrees."""
import cmath
import math

import numpy as np
from scipy.optimize import fsolve

A = cmath.exp(2j * math.pi / 3)


def show(name, x):
    print(f"{name:24s} {abs(x):14.6f} {math.degrees(cmath.phase(x)):12.6f}")


def solve(residual, start):
    """Roots of a complex residual."""
    n = len(start)

    def real(x):
        r = residual(x[:n] + 1j * x[n:])
        return np.concatenate([np.real(r), np.imag(r)])

    x, _, ok, message = fsolve(real, np.concatenate([np.real(start), np.imag(start)]), xtol=1e-13, full_output=True)
    assert ok == 1, message
    return x[:n] + 1j * x[n:]


def lateral():
    """Two phases (b, c) behind a source: a load of constant power b to earth, one of constant current b to c."""
    e = 4160 / math.sqrt(3) * np.array([A ** -1, A])
    z1, z0 = 0.1 + 0.5j, 0.3 + 1.5j
    source = np.array([[2 * z1 + z0, z0 - z1], [z0 - z1, 2 * z1 + z0]]) / 3
    line = 0.5 * np.array([[1.3238 + 1.3569j, 0.2066 + 0.4591j], [0.2066 + 0.4591j, 1.3294 + 1.3471j]])

    def residual(v):
        vbc = v[0] - v[1]
        wye = np.conj((100e3 + 50e3j) / v[0])
        delta = np.conj((80e3 + 40e3j) / 4160) * vbc / abs(vbc)
        return e - (source + line) @ np.array([wye + delta, -delta]) - v

    v = solve(residual, e)
    show("lateral b", v[0])
    show("lateral c", v[1])


def delta_wye():
    """A delta-wye transformer at a stiff source, low voltage 30 degrees behind, with one load of constant power."""
    e = 4160 / math.sqrt(3) * np.array([1, A ** -1, A])
    base = 480 / math.sqrt(3)
    z = (0.011 + 0.02j) * base ** 2 / (500e3 / 3)
    ideal = [base * (e[k] - e[k - 1]) / 4160 for k in range(3)]
    v = solve(lambda v: np.array([ideal[0] - z * np.conj((60e3 + 20e3j) / v[0]) - v[0]]), np.array([ideal[0]]))
    show("delta-wye a", v[0])
    show("delta-wye b", ideal[1])


def open_delta():
    """Two transformers from phase a and b to a delta of three impedances."""
    e = 7200 * np.array([1, A ** -1])
    z = (0.01 + 0.06j) * 4160 ** 2 / 2000e3
    y = [np.conj(s) / 4160 ** 2 for s in (850e3 + 526e3j, 1200e3 + 581e3j, 400e3 + 100e3j)]
    # v12 = n ea - z (i12 - i31), v23 = n eb - z (i23 - i31), i31 = -y31 (v12 + v23)
    m = np.array([[1 + z * (y[0] + y[2]), z * y[2]], [z * y[2], 1 + z * (y[1] + y[2])]])
    v = np.linalg.solve(m, 4160 / 7200 * e)
    show("open delta 12", v[0])
    show("open delta 23", v[1])


def centre_tapped():
    """A 120/240 V transformer as a star of three impedances, with loads of constant impedance on each half and both."""
    x12, x13, x23 = 0.0204, 0.0204, 0.0136
    star = [0.006 + 0.5j * (x12 + x13 - x23), 0.012 + 0.5j * (x12 + x23 - x13), 0.012 + 0.5j * (x13 + x23 - x12)]
    kva = 25.0
    y = [5 / kva, 3 / kva, 4 / kva / 4]  # p.u. of 120 V and 25 kVA; the last lies on twice the voltage
    # unknown: voltages u of the halves; currents of the halves: y u + y3 (u1 + u2)
    y_halves = np.array([[y[0] + y[2], y[2]], [y[2], y[1] + y[2]]])
    z = np.array([[star[0] + star[1], star[0]], [star[0], star[0] + star[2]]])
    u = np.linalg.solve(np.eye(2) + z @ y_halves, np.ones(2)) * 120
    show("centre-tapped 1", u[0])
    show("centre-tapped 2", -u[1])


for circuit in (lateral, delta_wye, open_delta, centre_tapped):
    circuit()
