# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What functions of a bay's relay publish of themselves: impedances and currents of faults whose place is known, and their figures."""
import csv
import math
import re
import unittest

import harness

DISTANCE = harness.SOURCE / "configs/scenarios/feeder_distance.yaml"
OVERCURRENT = harness.SOURCE / "configs/scenarios/feeder_overcurrent.yaml"
LINE = complex(1, 2 * math.pi * 50 * 0.01)  # BC of configs/networks/feeder.yaml
QUIET = ["--set", "processes.relay_b.functions.PDIS1.publish_values=false"]


class BayValues(harness.ScenarioTest):
    def tables(self, run):
        code, _, said = harness.gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, harness.OK, said)
        return {file.name: file.read_text() for file in (run.folder / "csv").glob("*.csv")}

    def column(self, run, name):
        """[(time_s, value)] of an exported signal; empty cells are no values."""
        for text in self.tables(run).values():
            rows = csv.DictReader(text.splitlines())
            if name in (rows.fieldnames or []):
                return [(float(row["time_s"]), float(row[name])) for row in rows if row[name] not in ("", "nan")]
        raise AssertionError(f"no table has {name}")

    def opens(self, run):
        return next(t for t, position in self.column(run, "breaker.QB.position") if t > 0.1 and position != 2)

    def test_the_locus_of_a_fault_to_earth_at_60_percent_ends_at_60_percent_of_the_line(self):
        for place, band in ((60, 0.01), (30, 0.01)):
            run = self.run_to_end(f"at_{place}", ["--set", f"events.fault.apply_fault.position_percent={place}"], scenario=DISTANCE)
            opens = self.opens(run)
            r = dict(self.column(run, "relay.relay_b.PDIS1.r_ohm.a"))
            x = dict(self.column(run, "relay.relay_b.PDIS1.x_ohm.a"))
            last = max(t for t in r if t < opens)
            self.assertLess(abs(complex(r[last], x[last]) - place / 100 * LINE), band * abs(LINE), (place, last))
            self.assertGreater(last, 0.12, "a cycle after the fault")
            page = (run.folder / "report/index.html").read_text()
            self.assertTrue("Measured impedance: relay_b" in page, "the report has no plane")
            self.assertIn("loop a", (run.folder / "report/figures/impedance_relay_b.csv").read_text())
            self.assertNotIn("loop b,", (run.folder / "report/figures/impedance_relay_b.csv").read_text(), "b is not faulted")

    def test_the_operating_point_lies_on_the_curve_at_the_current_of_the_fault(self):
        run = self.run_to_end("curve", ["--set", "processes.relay_a.functions.PTOC1.publish_values=true",
                                        "--set", "processes.relay_b.functions.PTOC1.publish_values=true"], scenario=OVERCURRENT)
        opens = self.opens(run)
        settled = [v for t, v in self.column(run, "relay.relay_b.PTOC1.current_a.a") if 0.2 < t < opens - 0.01]
        # 20 kV / sqrt(3) behind the source, AB and 60 % of BC; the load at B takes a little of it.
        wanted = 20000 / math.sqrt(3) / abs(complex(0.1, 100 * math.pi * 0.005) + LINE + 0.6 * LINE)
        self.assertGreater(len(settled), 100)
        for value in settled:
            self.assertAlmostEqual(value / wanted, 1, delta=0.02)
        page = (run.folder / "report/index.html").read_text()
        said = re.search(r"relay_b PTOC1 operates ([\d.]+) s after its start, at ([\d.]+) A", page)
        self.assertIsNotNone(said, "the report has no operating point")
        curve = 0.1 * 0.14 / ((wanted / 300) ** 0.02 - 1)  # IEC 60255-151, curve A
        self.assertAlmostEqual(float(said[1]), curve, delta=0.02)  # a cycle goes by until the current is there
        self.assertAlmostEqual(float(said[2]) / wanted, 1, delta=0.02)
        self.assertIsNotNone(re.search(r"relay_a PTOC1 is started for 0\.\d+ s", page), "the one behind it only starts")

    def test_without_being_asked_nothing_is_published_and_nothing_else_changes(self):
        asked, quiet = self.run_to_end("asked", scenario=DISTANCE), self.run_to_end("quiet", QUIET, scenario=DISTANCE)
        own = {name: text for name, text in self.tables(asked).items() if not name.startswith(("simulation_clock", "clock_ack"))}
        others = {name: text for name, text in self.tables(quiet).items() if not name.startswith(("simulation_clock", "clock_ack"))}
        self.assertTrue(any("r_ohm" in text for text in own.values()))
        self.assertFalse(any("r_ohm" in text for text in others.values()))
        self.assertEqual({text for text in own.values() if "r_ohm" not in text}, set(others.values()))
        self.assertFalse("Measured impedance" in (quiet.folder / "report/index.html").read_text(), "nothing was measured")


if __name__ == "__main__":
    unittest.main()
