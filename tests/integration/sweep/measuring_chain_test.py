# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""configs/studies/measuring_chain.yaml in short: two faults at each setting, and what happens without the estimate."""
import csv
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import OK, SOURCE, ScenarioTest, gridspace  # noqa: E402

STUDY = (SOURCE / "configs/studies/measuring_chain.yaml").read_text()


class MeasuringChain(ScenarioTest):
    def rows(self, name, *changes):
        text = STUDY
        for old, new in (("scenario: ", f"scenario: {SOURCE}/configs/studies/"), ("samples: 24", "samples: 1"),
                         ("[3ph_g, 3ph, 1ph_g, 2ph, 2ph_g]", "[3ph, 1ph_g]"), *changes):
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, new)
        code, out, err = gridspace("sweep", self.write(f"{name}.yaml", text), "--out", self.folder / name, "--jobs", "2", "--quiet")
        self.assertEqual(code, OK, out + err)
        with (self.folder / name / "results.csv").open(newline="") as stream:
            return list(csv.DictReader(stream))

    def test_errors_within_the_classes_lose_and_delay_no_fault_and_without_the_estimate_they_do(self):
        rows = self.rows("estimated")
        self.assertEqual(len(rows), 12)
        for row in rows:
            self.assertEqual((row["faults_tripped"], row["false_trips"]), ("1", "0"), row)
            self.assertLessEqual(float(row["added_ms"]), 0.21, row)
        without = self.rows("without", ("\nvary:", "\nset: {processes.relay2.ids.supervise.class_percent: 0}\nvary:"))
        late = [row for row in without if float(row["added_ms"]) > 0.21]
        self.assertTrue(any("error_percent" in row["chain"] for row in late))
        self.assertTrue(any("c_nf" in row["chain"] for row in late))
        self.assertTrue(any(float(row["skew_us"]) > 1 and "c_nf" not in row["chain"] for row in late))
        self.assertFalse([row for row in late if float(row["skew_us"]) < 1 and "error_percent" not in row["chain"] and "c_nf" not in row["chain"]])

    def test_a_chain_beyond_the_classes_is_an_alarm_before_there_is_a_fault(self):
        told = {}
        for error_percent in (1, 16):
            run = self.run_to_end(f"error_{error_percent}", ["--set", f"simulation.network_changes.ct_types.left.error_percent={error_percent}"],
                                  SOURCE / "configs/studies/measuring_chain_scenario.yaml")
            told[error_percent] = [e["text"] for e in run.events() if e["event"] == "ids_alarm" and e["time_s"] < 0.45]
        self.assertEqual(told[1], [])
        self.assertIn("measuring_chain", told[16][0])


if __name__ == "__main__":
    unittest.main(verbosity=2)
