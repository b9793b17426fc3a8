# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace ids train` and `evaluate`: what a model has learnt from is not what it is judged on."""
import json
import math
import unittest

from harness import OK, USAGE, ScenarioTest, gridspace

RATE_HZ = 4800


class Train(ScenarioTest):
    def test_files_are_not_evaluated_as_unseen(self):
        rows = "".join(f"{n / RATE_HZ:.9f}," + ",".join(f"{10 * math.sin(2 * math.pi * (60 * n / RATE_HZ - k / 3)):.6f}" for k in range(3)) + "\n"
                       for n in range(RATE_HZ))
        recording = self.write("recording.csv", "t,a,b,c\n" + rows)
        training = {"gridspace_ids_training": 1, "name": "files", "output": "model.json", "rate_hz": RATE_HZ,
                    "training": {"epochs": 1, "windows": 1000}, "data": {"files": [{"file": "recording.csv"}]}}
        config, model = self.write("train.yaml", json.dumps(training)), self.folder / "model.json"
        code, out, err = gridspace("ids", "train", config, "--json")
        self.assertEqual(code, OK, out + err)
        self.assertIsNone(json.loads(out)["unseen_rms_scaled"])
        code, out, err = gridspace("ids", "evaluate", model, config)
        self.assertEqual(code, USAGE, out + err)
        self.assertIn("'files' learns from files only", err)
        self.assertEqual(gridspace("ids", "evaluate", model, recording)[0], OK)
        training["data"]["synthetic"] = {"recordings": 10}
        code, out, err = gridspace("ids", "train", self.write("both.yaml", json.dumps(training)), "--json")
        self.assertEqual(code, OK, out + err)
        self.assertGreater(json.loads(out)["unseen_rms_scaled"], 0)


if __name__ == "__main__":
    unittest.main()
