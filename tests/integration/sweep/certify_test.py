#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace certify`: the tutorial's case in a short form, what is not done again, and a relay that is too slow."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
HANG_S = 240  # nothing that works takes that long, even beside ten other jobs

# The shipped case with one type of fault, so that each group has one run for a sample.
CASE = f"""
extends: {SOURCE}/configs/certify/feeder_distance.yaml
scenario: {SOURCE}/configs/scenarios/feeder_distance.yaml
vary: {{type: {{values: [1ph_g]}}}}
faults: {{behind: {{vary: ~}}}}
"""
TOO_SLOW = "processes.relay_b.functions.PDIS1.delay_ms=60"


class Certify(unittest.TestCase):
    def certify(self, folder, case, *arguments):
        (folder / "case.yaml").write_text(case)
        done = subprocess.run([BIN / "gridspace", "certify", "case.yaml", "--samples", "1", "--json", *arguments], cwd=folder,
                              capture_output=True, text=True, timeout=HANG_S, check=False)
        return done.returncode, json.loads(done.stdout) if done.stdout else {}, done.stderr

    def test_a_relay_that_is_right_passes_and_one_that_is_too_slow_does_not(self):
        with tempfile.TemporaryDirectory(prefix="gridspace-certify-") as name:
            folder = pathlib.Path(name)
            code, verdict, said = self.certify(folder, CASE, "--out", "out")
            self.assertEqual(code, 0, said)
            self.assertTrue(verdict["passed"])
            self.assertEqual((verdict["dependability"]["successes"], verdict["dependability"]["of"]), (1, 1))
            self.assertEqual((verdict["security"]["successes"], verdict["security"]["of"]), (1, 1))
            self.assertGreater(verdict["trip_ms"]["max"], 2)
            self.assertLess(verdict["trip_ms"]["max"], 40)
            self.assertIn("gridspace run", verdict["worst"][0]["command"])
            self.assertIn("Clopper-Pearson", (folder / "out/index.html").read_text())
            # The worst is kept, with the disturbance record of its fault.
            self.assertTrue((pathlib.Path(verdict["worst"][0]["folder"]) / "comtrade/fault_1_ascii.cfg").is_file())
            # The same again: nothing is run, and the verdict is the same.
            records = {r: r.stat().st_mtime_ns for r in (folder / "out").glob("*/runs/*/record.json")}
            self.assertEqual(len(records), 2)
            self.assertEqual(self.certify(folder, CASE, "--out", "out")[1], verdict)
            self.assertEqual({r: r.stat().st_mtime_ns for r in records}, records)
            alone = CASE.replace("{vary: ~}", "~") + "criteria: {security_at_least: ~}\n"
            code, verdict, said = self.certify(folder, alone, "--out", "slow", "--set", TOO_SLOW)
            self.assertEqual(code, 1, said)
            self.assertEqual(verdict["dependability"]["successes"], 0)
            self.assertIn("had to within 50 ms", verdict["worst"][0]["why"])

    def test_a_mistake_in_the_case_is_said_with_its_place_and_starts_nothing(self):
        with tempfile.TemporaryDirectory(prefix="gridspace-certify-") as name:
            folder = pathlib.Path(name)
            code, _, said = self.certify(folder, CASE.replace("[1ph_g]", "[1ph_x]"), "--out", "out")
            self.assertEqual(code, 2, said)
            self.assertIn("1ph_x", said)
            self.assertFalse((folder / "out").exists())
            for wrong, expected in ((CASE + "criteria: {security_bound_at_least: 0.9}\n", "with 1 of 1 right the lower end is 0.0250"),
                                    (CASE.replace("behind: {vary: ~}", "behind: ~"), "no group of faults has `must: stay`"),
                                    (CASE + "fault: short\n", "short"),
                                    (CASE + "set: {simulation.duration_s: 0.14}\n", "expected a run of at least 0.1"),
                                    (CASE + "trip: relay.relay_x.trip == true\n", "relay_x"),
                                    (CASE.replace("1ph_g]}", "1ph_g]}, place: {set: events.fault.where.far, values: [1]}"), "where")):
                code, _, said = self.certify(folder, wrong, "--out", "out")
                self.assertEqual(code, 2, said)
                self.assertIn(expected, said)
                self.assertRegex(said, r"case\.yaml:\d+:\d+: error|feeder_distance\.yaml:\d+:\d+: error")


if __name__ == "__main__":
    unittest.main()
