# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The leaderboard of detectors, in short: two runs of one attack, one of our detectors and the checker of rules."""
import csv
import importlib.util
import json
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BIN, OK, SOURCE, ScenarioTest, gridspace  # noqa: E402

LEADERBOARD = SOURCE / "bench/ids/leaderboard.py"
STUDY = f"""---
gridspace_study: 1
name: short
scenario: {SOURCE}/configs/scenarios/ids_benchmark.yaml
vary:
  model: {{set: processes.relay2.ids.model, files: [{SOURCE}/configs/models/ar_20.json]}}
  on_unconfirmed: {{set: processes.relay2.ids.supervise.on_unconfirmed, values: [delay]}}
  attack: {{set: attacks.forged.value, values: [{{bias_a: 5}}, {{bias_a: ~, factor: 2}}]}}
expectations: [false_trips, without, real_faults, real_faults_tripped, real_fault_trip_added_ms]
"""
OURS, RULES = "supervision (delay), ar_20", "rules on headers"


def module():
    spec = importlib.util.spec_from_file_location("leaderboard", LEADERBOARD)
    out = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(out)
    return out


class Leaderboard(ScenarioTest):
    def test_it_says_what_score_and_the_runs_say(self):
        study = self.write("short.yaml", STUDY)
        code, out, err = gridspace("ids", "sweep", study, "--keep", "--quiet", "--out", self.folder / "study", "--jobs", "2")
        self.assertEqual(code, OK, out + err)
        done = subprocess.run([sys.executable, LEADERBOARD, self.folder / "study", "--out", self.folder / "out", "--program", BIN / "gridspace", "--foreign", RULES],
                              capture_output=True, text=True, timeout=240, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        board = json.loads((self.folder / "out/leaderboard.json").read_text())["detectors"]
        self.assertEqual(set(board), {OURS, RULES})
        with (self.folder / "study/results.csv").open(newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(len(rows), 2)
        for name in (OURS, RULES):
            scores = []
            for row in rows:
                verdicts = self.folder / "out/verdicts" / name.replace(" ", "_") / f"{row['key']}.csv"
                code, out, err = gridspace("ids", "score", row["folder"], verdicts, "--json")
                self.assertEqual(code, OK, err)
                scores.append(json.loads(out))
            tp, fn = (sum(s[k] for s in scores) for k in ("true_positives", "false_negatives"))
            self.assertGreater(tp + fn, 0)
            self.assertAlmostEqual(board[name]["recall"]["value"], tp / (tp + fn))
            self.assertEqual(board[name]["seen"], sum(any(a["seen"] for a in s["attacks"]) for s in scores))
        self.assertEqual(board[OURS]["seen"], 2)   # both attacks jump
        self.assertEqual(board[RULES]["seen"], 0)  # headers, counters and times are all right
        self.assertIsNone(board[RULES]["consequence"])
        self.assertEqual(board[OURS]["consequence"]["real_faults"], int(sum(float(r["real_faults"]) for r in rows)))
        tables = subprocess.run([sys.executable, LEADERBOARD, "--tables", self.folder / "out/leaderboard.json"], capture_output=True, text=True, timeout=60, check=True).stdout
        self.assertEqual(tables, (self.folder / "out/tables.md").read_text())
        self.assertIn(f"| {OURS} | 2 of 2 |", tables)

    def test_its_figures_are_those_of_arithmetic(self):
        sut = module()
        one = {"true_positives": 3, "false_positives": 1, "true_negatives": 95, "false_negatives": 1}
        none = {"true_positives": 0, "false_positives": 0, "true_negatives": 100, "false_negatives": 4}
        self.assertEqual(sut.pooled([one, none]), {"precision": 3 / 4, "recall": 3 / 8, "false_positives": 1 / 196})
        self.assertIsNone(sut.pooled([none])["precision"])
        found = sut.with_intervals([one, none])["recall"]
        self.assertEqual((found["low"], found["value"], found["high"]), (0, 3 / 8, 3 / 4))
        rows = [{"real_faults": "1", "real_faults_tripped": "0", "real_fault_trip_added_ms": "", "false_trips": "2", "without": "1"},
                {"real_faults": "1", "real_faults_tripped": "1", "real_fault_trip_added_ms": "0.5", "false_trips": "0", "without": ""}]
        self.assertEqual(sut.consequence(rows), {"real_faults": 2, "lost": 1, "late": 1, "false": 2, "false_without": 1})


if __name__ == "__main__":
    unittest.main()
