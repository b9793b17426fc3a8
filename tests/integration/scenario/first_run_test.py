#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A first run from a checkout (`./gridspace run`, scripts/build.sh) has compiled gridspace-runner and what it names, and nothing else."""
import json
import shutil
import subprocess
import unittest

import harness

SHORT = ["--until", "60s", "--set", "expect=~"]


class FirstRun(harness.ScenarioTest):
    def programs_of(self, scenario):
        code, out, err = harness.gridspace("run", "--programs", scenario)
        self.assertEqual(code, harness.OK, err)
        return out.split()

    def run_with(self, programs, name):
        """Case 1 with only these programs beside gridspace-runner: (exit code, folder, what it says)."""
        folder = self.folder / f"bin_{name}/bin"
        folder.mkdir(parents=True)
        for program in ["gridspace-runner", *programs]:
            shutil.copy(harness.BIN / program, folder / program)
        done = subprocess.run([folder / "gridspace-runner", "run", harness.CASE_1, *SHORT, *harness.BASE, "--out", self.folder / name],
                              capture_output=True, text=True, timeout=harness.HANG_S)
        return done.returncode, self.folder / name, done.stdout + done.stderr

    def test_what_it_names_is_enough_and_gives_the_same_run(self):
        programs = self.programs_of(harness.CASE_1)
        self.assertNotIn("gridspace-relay", programs)
        self.assertIn("gridspace-sim", programs)
        code, first, said = self.run_with(programs, "first")
        self.assertEqual(code, harness.OK, said)
        whole = self.run_to_end("whole", [*SHORT, *harness.BASE])
        code, out, err = harness.gridspace("compare", whole.folder, first)
        self.assertEqual(code, harness.OK, out + err)

    def test_without_one_of_them_it_says_which(self):
        programs = [p for p in self.programs_of(harness.CASE_1) if p != "gridspace-mcca"]
        code, _, said = self.run_with(programs, "less")
        self.assertNotEqual(code, harness.OK, said)
        self.assertIn("gridspace-mcca", said)

    def test_a_program_of_somebody_else_may_need_any(self):
        own = self.write("own.yaml", json.dumps({"extends": str(harness.CASE_1), "processes": {
            "own": {"program": "exec", "host": "board1", "command": ["sleep", "1"]}}}))
        self.assertIn("programs", self.programs_of(own))


if __name__ == "__main__":
    unittest.main()
