#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A long recording in bounded memory; a disk that is full or read-only. By command with the samples of a whole day, accelerated:
  long_recording_test.py --hours 24
"""
import contextlib
import json
import os
import pathlib
import re
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BASE, CASE_1, ENVIRONMENT, OK, ScenarioTest, gridspace  # noqa: E402

INSIDE = "GRIDSPACE_LONG_RECORDING_TEST_INSIDE"
HOURS = float(os.environ.get("GRIDSPACE_LONG_RECORDING_HOURS", "2"))
GROWTH_KB = 8 * 1024


def watch(pid, memory):
    """Resident memory of a process in kB, until it ends."""
    with contextlib.suppress(OSError, AttributeError):
        while True:
            memory.append(int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text()).group(1)))
            time.sleep(0.02)


class LongRecording(ScenarioTest):
    def test_memory_of_the_recorder_does_not_grow_with_the_recording(self):
        end_s = HOURS * 3600
        run = self.start("long", [*BASE, "--speed", "720", "--set", f"simulation.duration_h={HOURS:g}", "--set", "expect=~"])
        run.wait_for(lambda line: line.get("note", "").startswith("all "), "everybody to be ready")
        memory = []
        watcher = threading.Thread(target=watch, args=(run.pid_of("recorder"), memory))
        watcher.start()
        self.assertEqual(run.finish(timeout=max(240, HOURS * 240)), OK, run.stderr())
        watcher.join()
        self.assertGreater(len(memory), 20)
        early, late = memory[len(memory) // 4], max(memory)
        info = json.loads(gridspace("info", run.folder, "--json", timeout=600)[1])
        print(f"{HOURS:g} h: {info['recording']['samples']} samples, {info['recording']['file_octets'] / 1e6:.1f} MB on disk; "
              f"recorder {early / 1024:.1f} MB after a quarter, {late / 1024:.1f} MB at most")
        eighths = [memory[max(i * len(memory) // 8 - 1, 0)] / 1024 for i in range(9)]
        print("  MB at each eighth of the run: " + " ".join(f"{mb:.1f}" for mb in eighths))
        per_hour = (eighths[7] - eighths[3]) / (HOURS / 2)  # of the middle, past the beginning and short of the end
        print(f"  growth between 3/8 and 7/8: {per_hour:+.3f} MB an hour, so {per_hour * 24:+.1f} MB a day")
        self.assertLess(late - early, GROWTH_KB)
        self.assertTrue(info["recording"]["complete"])
        measured = next(t for t in info["recording"]["topics"] if t["name"] == "bus_measurements")
        self.assertEqual(measured["samples"], 4 * (int(end_s) + 1))


class Disk(ScenarioTest):
    """On file systems of the test's own mount namespace."""

    def mount(self, name, options):
        folder = self.folder / name
        folder.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", folder], check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", folder])
        return folder

    def test_a_full_disk_ends_the_run_and_what_was_recorded_is_readable(self):
        small = self.mount("small", "size=4m")
        run = self.start("run", [*BASE, "--set", "expect=~", "--set", "processes.recorder.compress=false"], folder=small / "run")
        self.assertEqual(run.finish(), ENVIRONMENT, run.stderr())
        self.assertIn("disk is full", run.stderr())
        self.assertEqual(run.left_over(), {})
        code, out, err = gridspace("info", run.folder, "--json")
        self.assertEqual(code, OK, err)
        recording = json.loads(out)["recording"]
        self.assertFalse(recording["complete"])
        self.assertGreater(recording["samples"], 1000)
        out_folder = self.folder / "csv"
        code, _, err = gridspace("export", run.folder, "--csv", "--out", out_folder)
        self.assertEqual(code, OK, err)
        self.assertTrue(list(out_folder.glob("*.csv")))
        # The negative control: with room it ends as it should.
        large = self.mount("large", "size=200m")
        run = self.start("run", [*BASE, "--set", "expect=~", "--until", "1200s"], folder=large / "run")
        self.assertEqual(run.finish(), OK, run.stderr())

    def test_a_read_only_disk_is_named_before_anything_starts(self):
        read_only = self.mount("read_only", "size=1m,ro")
        run = self.start("run", [*BASE, "--until", "600s"], folder=read_only / "run")
        self.assertEqual(run.finish(), ENVIRONMENT)
        self.assertIn(str(read_only / "run"), run.stderr())
        self.assertIn("Read-only file system", run.stderr())
        self.assertEqual(run.left_over(), {})


if __name__ == "__main__":
    if "--hours" in sys.argv:
        at = sys.argv.index("--hours")
        os.environ["GRIDSPACE_LONG_RECORDING_HOURS"] = sys.argv[at + 1]
        del sys.argv[at:at + 2]
        sys.argv.insert(1, "LongRecording")
    if os.environ.get(INSIDE) is None:
        kind = ["unshare", "--mount"] if os.geteuid() == 0 else ["unshare", "--mount", "--map-root-user"]
        os.execvpe("unshare", [*kind, sys.executable, *sys.argv], {**os.environ, INSIDE: "1"})
    unittest.main(verbosity=2)
