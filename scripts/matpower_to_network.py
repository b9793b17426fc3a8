#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes a dynamic network file (YAML) of a MATPOWER case, which has only what a power flow needs.

    scripts/matpower_to_network.py case39.m > case39.yaml
    gridspace simulate case39.yaml --solver phasor --until 10s --signals 'machine.*.frequency_hz' --csv out.csv

`gridspace powerflow case39.m` reads the case itself; this is for faults and swings. What the case does not say is taken from
the options: every generator becomes a machine of one type (typical of a large turbo set, Kundur 1994, table 4.2; one damper
per axis), every load a constant impedance that draws its power at the voltage of the case. The machine of the reference bus
is made the largest, so that it balances the power flow. The zero sequence of lines is three times the positive one.
"""
import argparse
import math
import re
import sys

MACHINE_TYPE = """machine_types:
  turbo_set:               # assumed: the case has no data of machines
    constants_pu: {{xd: 1.8, xq: 1.7, xd1: 0.3, xd2: 0.23, xq2: 0.23, xl: 0.15, x0: 0.12, ra: 0.003}}
    times_s: {{td01: 8, td02: 0.03, tq02: 0.07}}
    inertia_h_s: {inertia}
    avr: {{ka: 50, ta_s: 0.02, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 8}}
    governor: {{droop_percent: 5, tg_s: 0.1, tt_s: 0.5}}
"""


def matrix(text, name):
    found = re.search(r"mpc\.%s\s*=\s*\[(.*?)\]" % name, text, re.S)
    if not found:
        sys.exit(f"the case has no matrix mpc.{name}")
    body = re.sub(r"%.*", "", found.group(1))
    return [[float(x) for x in row.replace(",", " ").split()] for row in re.split(r"[;\n]", body) if row.strip()]


def number(x):
    return f"{x:.12g}"


def mapping(**entries):
    return "{" + ", ".join(f"{k}: {v if isinstance(v, str) else number(v)}" for k, v in entries.items() if v is not None) + "}"


def convert(text, frequency_hz, inertia_s, loads):
    name = re.search(r"function\s+mpc\s*=\s*(\w+)", text)
    base_mva = float(re.search(r"mpc\.baseMVA\s*=\s*([\d.eE+-]+)", text).group(1))
    buses = {int(row[0]): row for row in matrix(text, "bus") if int(row[1]) != 4}
    volts = {n: (row[9] if row[9] > 0 else 1) * 1e3 for n, row in buses.items()}
    generators = [row for row in matrix(text, "gen") if row[7] > 0 and int(row[0]) in buses]
    out = [f"# Made by scripts/matpower_to_network.py. Machines: assumed data. Loads: {loads}.", "---", "gridspace_network: 1",
           f"name: {name.group(1) if name else 'matpower_case'}",
           f"base: {mapping(frequency_hz=frequency_hz, power_kva=base_mva * 1e3)}", "buses:"]
    out += [f"  B{n}: {mapping(voltage_v=volts[n])}" for n in buses]
    lines, transformers = [], []
    for k, row in enumerate(matrix(text, "branch"), 1):
        start, end = int(row[0]), int(row[1])
        if (len(row) > 10 and row[10] <= 0) or start not in buses or end not in buses:
            continue
        r, x, b, ratio, shift = row[2], row[3], row[4], row[8], row[9]
        if ratio != 0 or shift != 0 or volts[start] != volts[end] or x < 0:
            transformers.append(f"  T{k}: " + mapping(**{
                "from": f"B{start}", "to": f"B{end}", "rating_kva": base_mva * 1e3, "r_percent": 100 * r, "x_percent": 100 * x,
                "tap_ratio": ratio or 1, "phase_shift_deg": shift or None, "charging_percent": 100 * b or None}))
            continue
        z = volts[start] ** 2 / (base_mva * 1e6)
        c_nf = b / z / (2 * math.pi * frequency_hz) * 1e9
        lines.append(f"  L{k}: " + mapping(**{
            "from": f"B{start}", "to": f"B{end}", "r_ohm": r * z, "x_ohm": x * z, "c_nf": c_nf or None, "r0_ohm": 3 * r * z,
            "x0_ohm": 3 * x * z, "c0_nf": 0.6 * c_nf or None}))
    for section, rows in (("lines", lines), ("transformers", transformers)):
        if rows:
            out += [f"{section}:"] + rows
    out += [MACHINE_TYPE.format(inertia=number(inertia_s)).rstrip(), "machines:"]
    ratings = [max(row[6], abs(row[1]) / 0.85, row[8] / 0.85 if len(row) > 8 else 0) * 1e3 for row in generators]
    for k, (row, rating) in enumerate(zip(generators, ratings), 1):
        if int(buses[int(row[0])][1]) == 3:
            rating = max(rating, 1.001 * max(ratings))
        out.append(f"  G{k}: " + mapping(bus=f"B{int(row[0])}", type="turbo_set", rating_kva=rating, p_kw=row[1] * 1e3,
                                         voltage_setpoint_pu=row[5]))
    held = {int(row[0]): row[5] for row in generators}
    demands = []
    for n, row in buses.items():
        v = held.get(n, row[7] or 1) if loads == "constant_impedance" else 1
        if row[2] or row[3]:
            demands.append(f"  D{n}: " + mapping(bus=f"B{n}", p_kw=row[2] * 1e3 / v**2, q_kvar=row[3] * 1e3 / v**2, model=loads))
    shunts = [f"  S{n}: " + mapping(bus=f"B{n}", p_kw=row[4] * 1e3, q_kvar=row[5] * 1e3) for n, row in buses.items()
              if row[4] or row[5]]
    for section, rows in (("loads", demands), ("shunts", shunts)):
        if rows:
            out += [f"{section}:"] + rows
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", help="MATPOWER case file, version 2")
    parser.add_argument("--frequency-hz", type=float, default=60, help="nominal frequency, which a case does not know (60)")
    parser.add_argument("--inertia-s", type=float, default=4, help="inertia constant of every machine (4)")
    parser.add_argument("--loads", default="constant_impedance", choices=["constant_impedance", "constant_current", "constant_power"])
    arguments = parser.parse_args()
    with open(arguments.case, encoding="utf-8", errors="replace") as file:
        text = file.read()
    sys.stdout.write(convert(text, arguments.frequency_hz, arguments.inertia_s, arguments.loads))


if __name__ == "__main__":
    main()
