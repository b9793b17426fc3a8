# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Published grids with machines of assumed data (scripts/matpower_to_network.py): both solvers start in the steady state of the
power flow and stay there, and a load step swings them alike."""
import csv
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BIN = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).parents[3]))
CASES = SOURCE / "tests/golden/powerflow"


def convert(case, target, *options):
    made = subprocess.run([sys.executable, str(SOURCE / "scripts/matpower_to_network.py"), str(CASES / case), *options],
                          capture_output=True, text=True, check=True)
    target.write_text(made.stdout)
    return target


class PublishedCases(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def simulate(self, network, solver, until, *more):
        table = self.folder / "out.csv"
        done = subprocess.run([str(BIN), "simulate", str(network), "--solver", solver, "--until", until, "--quiet", "--signals",
                               "bus.*.v_pu,machine.*.frequency_hz", "--csv", str(table), *map(str, more)],
                              capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        header, *rows = csv.reader(table.open())
        return header, [[float(x) for x in row] for row in rows]

    def test_both_solvers_stay_in_the_published_steady_state(self):
        for case, buses in (("case9", 9), ("case14", 14), ("case30", 30), ("case39", 39), ("case57", 57), ("case118", 118)):
            reference = {f"bus.B{int(row['bus'])}.v_pu": float(row["v_pu"])
                         for row in csv.DictReader((CASES / f"{case}.reference.csv").open())}
            self.assertEqual(len(reference), buses)
            network = convert(f"{case}.m", self.folder / f"{case}.yaml", "--loads", "constant_power")
            for solver, until in (("phasor", "1s"), ("emt", "0.02s")):
                with self.subTest(case=case, solver=solver):
                    header, rows = self.simulate(network, solver, until, *(["--every", "48"] if solver == "emt" else []))
                    for k, name in enumerate(header):
                        for row in (rows[0], rows[-1]):
                            if name in reference:
                                self.assertAlmostEqual(row[k], reference[name], delta=2e-6, msg=f"{name} at {row[0]} s")
                            elif name.startswith("machine."):
                                self.assertAlmostEqual(row[k], 60, delta=1e-5, msg=f"{name} at {row[0]} s")

    def test_every_shipped_network_with_machines_stays_where_it_starts_for_a_second_in_both_solvers(self):
        tried = 0
        for network in sorted((SOURCE / "configs/networks").glob("*.yaml")):
            if "\nmachines:" not in network.read_text():
                continue
            tried += 1
            for solver in ("phasor", "emt"):
                with self.subTest(network=network.name, solver=solver):
                    header, rows = self.simulate(network, solver, "1s", *(["--every", "960"] if solver == "emt" else []))
                    for k, name in enumerate(header[1:], 1):
                        start = rows[0][k]
                        allowed = 1e-5 if name.startswith("machine.") else 1e-6
                        self.assertLess(max(abs(row[k] - start) for row in rows), allowed, name)
        self.assertGreaterEqual(tried, 7)

    def test_a_load_step_swings_the_machines_alike_in_both_solvers(self):
        network = convert("case9.m", self.folder / "n.yaml", "--frequency-hz", "50")
        events = self.folder / "e.yaml"
        events.write_text("events: {s: {at_s: 0.1, set: {loads.D5.p_kw: 150000}}}\n")
        got = []
        for solver in ("phasor", "emt"):
            every = ["--every", "48"] if solver == "emt" else []
            header, rows = self.simulate(network, solver, "0.6s", "--events", events, *every)
            machines = [k for k, name in enumerate(header) if name.startswith("machine.")]
            self.assertEqual(len(machines), 3)
            got.append([[row[k] for k in machines] for row in rows])
        swing = max(abs(a - 50) for row in got[0] for a in row)
        apart = max(abs(a - b) for p, w in zip(*got) for a, b in zip(p, w))
        self.assertGreater(swing, 0.05)
        self.assertLess(apart, 0.05 * swing)
        self.assertTrue(all(math.isfinite(a) for row in got[1] for a in row))


if __name__ == "__main__":
    unittest.main()
