#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Solves the cases of this folder by an independent method, in plain Python, and writes <case>.reference.csv.

Gauss-Seidel on the bus admittance matrix (Stevenson, Elements of Power System Analysis, chapter 8), iterated until no
voltage changes by more than 1e-14: another method, another language and another reading of the file than ours.
Run it by hand when a case is added: ./make_reference.py case9.m
"""
import cmath
import math
import re
import sys


def matrix(text, name):
    body = re.search(r"mpc\.%s\s*=\s*\[(.*?)\]" % name, text, re.S).group(1)
    body = re.sub(r"%.*", "", body)
    return [[float(x) for x in row.split()] for row in body.split(";") if row.split()]


def read(path):
    text = open(path).read()
    base = float(re.search(r"baseMVA\s*=\s*([\d.]+)", text).group(1))
    bus, gen, branch = matrix(text, "bus"), matrix(text, "gen"), matrix(text, "branch")
    if "in kW" in text:  # the conversion that the file spells out at its end
        z = (bus[0][9] * 1e3) ** 2 / (base * 1e6)
        for row in branch:
            row[2] /= z
            row[3] /= z
        for row in bus:
            row[2] /= 1e3
            row[3] /= 1e3
    return base, bus, gen, branch


def solve(path):
    base, bus, gen, branch = read(path)
    number = {int(row[0]): i for i, row in enumerate(bus)}
    n = len(bus)
    y = [dict() for _ in range(n)]

    def add(i, j, value):
        y[i][j] = y[i].get(j, 0) + value

    for row in branch:
        if len(row) > 10 and row[10] <= 0:
            continue
        i, j = number[int(row[0])], number[int(row[1])]
        series, half = 1 / complex(row[2], row[3]), 0.5j * row[4]
        tap = cmath.rect(row[8] or 1, math.radians(row[9]))
        add(i, i, (series + half) / abs(tap) ** 2)
        add(j, j, series + half)
        add(i, j, -series / tap.conjugate())
        add(j, i, -series / tap)
    for i, row in enumerate(bus):
        add(i, i, complex(row[4], row[5]) / base)

    s = [-complex(row[2], row[3]) / base for row in bus]
    held = [None] * n
    for row in gen:
        if row[7] <= 0:
            continue
        i = number[int(row[0])]
        s[i] += row[1] / base
        held[i] = row[5]
    kind = [int(row[1]) for row in bus]
    v = [cmath.rect(held[i] if held[i] and kind[i] > 1 else 1, math.radians(bus[i][8]) if kind[i] == 3 else 0) for i in range(n)]
    for sweep in range(2_000_000):
        change = 0
        for i in range(n):
            if kind[i] == 3:
                continue
            rest = sum(yij * v[j] for j, yij in y[i].items() if j != i)
            power = s[i]
            if kind[i] == 2:
                q = (v[i] * (y[i][i] * v[i] + rest).conjugate()).imag
                power = complex(s[i].real, q)
            new = ((power / v[i]).conjugate() - rest) / y[i][i]
            if kind[i] == 2:
                new *= held[i] / abs(new)
            else:
                new = v[i] + 1.4 * (new - v[i])  # over-relaxation
            change = max(change, abs(new - v[i]))
            v[i] = new
        if change < 1e-14:
            break
    worst = 0
    for i in range(n):
        power = v[i] * sum(yij * v[j] for j, yij in y[i].items()).conjugate()
        if kind[i] != 3:
            worst = max(worst, abs((power - s[i]).real))
        if kind[i] == 1:
            worst = max(worst, abs((power - s[i]).imag))
    print(f"{path}: {sweep + 1} sweeps, worst mismatch {worst:.1e} p.u.")
    return [(int(bus[i][0]), abs(v[i]), math.degrees(cmath.phase(v[i]))) for i in range(n)]


for path in sys.argv[1:]:
    with open(path.replace(".m", ".reference.csv"), "w") as out:
        out.write("bus,v_pu,angle_deg\n")
        for row in solve(path):
            out.write("%d,%.12f,%.10f\n" % row)
