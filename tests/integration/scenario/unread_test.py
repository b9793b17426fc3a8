# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run whose messages nobody reads goes on to its end, and says everything when somebody does."""
import contextlib
import json
import os
import subprocess
import time
import unittest

from harness import BASE, BIN, CASE_1, HANG_S, OK, ScenarioTest


class Unread(ScenarioTest):
    def test_a_run_ends_and_is_reported_while_its_pipe_is_full(self):
        ours, theirs = os.pipe()
        os.set_blocking(theirs, False)
        filled = 0
        with contextlib.suppress(BlockingIOError):
            while True:
                filled += os.write(theirs, b" " * 4096)
        os.set_blocking(theirs, True)
        folder = self.folder / "run"
        process = subprocess.Popen([BIN / "gridspace", "run", CASE_1, *BASE, "--set", "clock.mode=realtime", "--speed", "900", "--until", "3600s", "--json",
                                    "--set", "expect=~", "--set", "events={one: {at_s: 600, set: {loads.L1.p_kw: 10}}}", "--out", folder],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=theirs, start_new_session=True)
        os.close(theirs)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + HANG_S
        while not (folder / "report/summary.json").exists() and time.monotonic() < deadline:
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        self.assertTrue((folder / "report/summary.json").exists(), "the run does not come to its end")
        with os.fdopen(ours, "rb") as pipe:
            said = pipe.read()
        self.assertEqual(process.wait(HANG_S), OK)
        self.assertEqual(json.loads((folder / "report/summary.json").read_text())["simulated_s"], 3600)
        lines = [json.loads(line) for line in said[filled:].splitlines()]
        notes = [line["note"] for line in lines if "note" in line]
        self.assertTrue(any("run folder" in note for note in notes), notes)
        self.assertTrue(any("are ready" in note for note in notes), notes)
        self.assertIn("one", [line["text"] for line in lines if line.get("event") == "event"], lines)
        self.assertEqual([line["time_s"] for line in lines if "speed" in line][-1], 3600)


if __name__ == "__main__":
    unittest.main()
