# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a differential element publishes of itself, against a full-cycle DFT of the currents that it was sent, and the plane of the report."""
import cmath
import csv
import json
import math
import unittest

import harness

THREE_LINES = harness.SOURCE / "configs/scenarios/protection_three_lines.yaml"
CYCLE = 80  # samples of 60 Hz at 4800 Hz
SHORT = ["--set", "processes.monitor=~", "--set", "simulation.duration_s=0.3", "--set", "events.fault.at_s=0.2", "--set", "expect=~"]


def table(run, column):
    """The rows of the exported table that has this column: {time_s: row}."""
    for file in sorted((run.folder / "csv").glob("*.csv")):
        with open(file, newline="") as stream:
            rows = csv.DictReader(stream)
            if column in rows.fieldnames:
                return {round(float(row["time_s"]), 9): row for row in rows}
    raise AssertionError(f"no table has {column}")


def samples(run, topic):
    """Currents by the number of their sample, of phases a, b, c."""
    out = {}
    with open(run.folder / "csv" / f"{topic}.csv", newline="") as stream:
        for row in csv.DictReader(stream):
            for k in range(4):
                if row.get(f"samples_{k}_ia"):
                    out[int(row["first_index"]) + k] = tuple(float(row[f"samples_{k}_i{p}"]) for p in "abc")
    return out


def phasor(currents, last, phase):
    """RMS phasor of the cycle that ends with sample `last`."""
    return math.sqrt(2) / CYCLE * sum(currents[last - CYCLE + 1 + k][phase] * cmath.exp(-2j * math.pi * k / CYCLE) for k in range(CYCLE))


class Restraint(harness.ScenarioTest):
    def test_the_published_currents_are_those_of_an_independent_dft(self):
        run = self.run_to_end("run", SHORT, scenario=THREE_LINES)
        code, _, said = harness.gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, harness.OK, said)
        own = table(run, "relay.relay1.differential_a.a")
        near, far = samples(run, "TL_11"), samples(run, "TL_12")
        self.assertGreater(len(own), 1000)
        compared, most = 0, 0
        for time_s, row in own.items():
            index = round(time_s * 4800)
            if index % 37 or index < CYCLE:  # some of each part of the run: before, in and after the fault
                continue
            for k, phase in enumerate("abc"):
                a, b = phasor(near, index, k), -phasor(far, index, k)  # both into the line
                wanted = {"differential_a": abs(a + b), "restraint_a": (abs(a) + abs(b)) / 2}
                wanted["operate_at_a"] = max(15, 0.3 * wanted["restraint_a"])
                for name, value in wanted.items():
                    # Frames carry single precision: a part in ten million of the currents themselves.
                    self.assertAlmostEqual(float(row[f"relay.relay1.{name}.{phase}"]), value, delta=1e-6 * max(1.0, abs(a)), msg=(name, phase, time_s))
                compared, most = compared + 1, max(most, wanted["restraint_a"])
        self.assertGreater(compared, 60)
        self.assertGreater(most, 30, "the fault of the neighbour went through this line")

        page = (run.folder / "report/index.html").read_text()
        for relay in ("relay1", "relay2", "relay3"):
            self.assertIn(f"Differential over restraint current: {relay}", page)
        self.assertIn("pickup, trip", (run.folder / "report/figures/restraint_relay2.svg").read_text())
        self.assertNotIn("pickup", (run.folder / "report/figures/restraint_relay1.svg").read_text(), "the element of the line beside is restrained")

    def test_without_being_asked_nothing_is_published_and_nothing_else_changes(self):
        asked = self.run_to_end("asked", SHORT, scenario=THREE_LINES)
        quiet = self.run_to_end("quiet", [*SHORT, *(word for n in (1, 2, 3) for word in ("--set", f"processes.relay{n}.element.publish_values=false"))],
                                scenario=THREE_LINES)
        code, listed, said = harness.gridspace("info", quiet.folder, "--json")
        self.assertEqual(code, harness.OK, said)
        self.assertNotIn("restraint_a", json.dumps(json.loads(listed)))
        tables = {}
        for run in (asked, quiet):
            code, _, said = harness.gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
            self.assertEqual(code, harness.OK, said)
            tables[run] = {file.read_text() for file in (run.folder / "csv").glob("*.csv")
                           if not file.name.startswith(("simulation_clock", "clock_ack"))}  # they count what was sent
        self.assertTrue(any("restraint_a" in text for text in tables[asked]))
        self.assertFalse(any("restraint_a" in text for text in tables[quiet]))
        self.assertEqual({text for text in tables[asked] if "restraint_a" not in text}, tables[quiet])


if __name__ == "__main__":
    unittest.main()
