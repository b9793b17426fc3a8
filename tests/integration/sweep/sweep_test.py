#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace sweep` runs a short piece of case 1 several times: results, what is not done again, what may interrupt it, what repeats a run."""
import contextlib
import csv
import fcntl
import json
import os
import pathlib
import shlex
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
HANG_S = 240  # nothing that works takes that long, even beside ten other jobs

sys.path.insert(0, str(SOURCE / "python"))
import gridspace  # noqa: E402

# Six minutes of case 1. The load decides whether the voltage is high enough.
STUDY = f"""
gridspace_study: 1
name: short
scenario: {SOURCE}/configs/scenarios/ev_charging.yaml
set: {{processes.monitor: ~, simulation.duration_h: 0.1, report: ~}}
vary:
  load_kw: {{set: simulation.network_changes.loads.L3.p_kw, values: [5, 20]}}
  requested_h: {{set: processes.ev1.requested_h, values: [4, 5]}}
expectations: []
results:
  v_min: {{min_of: bus.*.v_pu, above: 0.968}}
  soc: {{last_of: ev.EV1.soc_percent}}
"""


def sweep(folder, *arguments, study=STUDY, name="study.yaml", **kwargs):
    (folder / name).write_text(study)
    return subprocess.run([BIN / "gridspace", "sweep", name, "--out", "out", *arguments], cwd=folder, capture_output=True, text=True,
                          timeout=HANG_S, check=False, **kwargs)


def rows(folder):
    with (folder / "out/results.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="gridspace-sweep-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)


class Results(unittest.TestCase):
    """One study that is looked at from all sides."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="gridspace-sweep-")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.done = sweep(cls.folder, "--jobs", "2", "--json")
        cls.rows = rows(cls.folder) if (cls.folder / "out/results.csv").exists() else []

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_every_point_is_a_row_and_the_high_load_fails(self):
        self.assertEqual(self.done.returncode, 1, self.done.stderr)
        self.assertEqual([(r["load_kw"], r["requested_h"], r["state"]) for r in self.rows],
                         [("5", "4", "passed"), ("5", "5", "passed"), ("20", "4", "failed"), ("20", "5", "failed")])
        self.assertTrue(all(float(r["soc"]) > 20 for r in self.rows))
        self.assertTrue(all((float(r["v_min"]) > 0.968) == (r["state"] == "passed") for r in self.rows))
        summary = json.loads(self.done.stdout)
        self.assertEqual([summary[k] for k in ("runs", "passed", "failed", "ended_early", "open")], [4, 2, 2, 0, 0])

    def test_the_database_says_the_same(self):
        with contextlib.closing(sqlite3.connect(self.folder / "out/results.sqlite")) as database:
            found = database.execute("SELECT load_kw, requested_h, state, v_min FROM runs ORDER BY run").fetchall()
        self.assertEqual(found, [(float(r["load_kw"]), float(r["requested_h"]), r["state"], float(r["v_min"])) for r in self.rows])

    def test_a_run_that_passed_keeps_its_record_and_one_that_failed_its_folder(self):
        for row in self.rows:
            folder = self.folder / "out/runs" / row["key"]
            self.assertEqual((folder / "run").exists(), row["state"] == "failed")
            self.assertEqual(row["folder"], "" if row["state"] == "passed" else str((folder / "run").resolve()))
            self.assertTrue((folder / "record.json").is_file())

    def test_the_command_of_a_failed_run_repeats_it_octet_for_octet(self):
        row = next(r for r in self.rows if r["state"] == "failed")
        again = self.folder / "again"
        done = subprocess.run([*shlex.split(row["command"]), "--out", again, "--quiet"], capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        compared = subprocess.run([BIN / "gridspace", "compare", row["folder"], again], capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertTrue(compared.stdout.startswith("identical: "), compared.stdout + compared.stderr)

    def test_a_second_call_runs_nothing(self):
        before = {f: f.stat().st_mtime_ns for f in (self.folder / "out").rglob("record.json")}
        done = sweep(self.folder, "--json")
        self.assertEqual(json.loads(done.stdout)["there_already"], 4)
        self.assertEqual(before, {f: f.stat().st_mtime_ns for f in (self.folder / "out").rglob("record.json")})

    def test_a_further_value_runs_alone(self):
        more = STUDY.replace("values: [4, 5]", "values: [4, 5, 6]").replace("values: [5, 20]", "values: [5]")
        done = sweep(self.folder, "--json", study=more)
        summary = json.loads(done.stdout)
        self.assertEqual((done.returncode, summary["runs"], summary["there_already"], summary["passed"]), (0, 3, 2, 3), done.stderr)

    def test_a_dry_run_shows_the_runs_and_writes_nothing(self):
        (self.folder / "dry").mkdir(exist_ok=True)
        done = sweep(self.folder / "dry", "--dry-run")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("study short: 4 runs of ev_charging", done.stdout)
        self.assertIn("load_kw = 20, requested_h = 5", done.stdout)
        self.assertFalse((self.folder / "dry/out").exists())

    def test_the_page_names_the_worst_case_and_links_its_report(self):
        page = (self.folder / "out/index.html").read_text()
        row = next(r for r in self.rows if r["state"] == "failed")
        self.assertIn(f"runs/{row['key']}/run/report/index.html", page)
        self.assertIn(row["command"], page)
        self.assertNotIn("http-equiv", page)
        self.assertNotIn("src=\"http", page)


class Interrupted(Folder):
    LONGER = STUDY.replace("duration_h: 0.1", "duration_h: 0.5").replace("values: [4, 5]", "values: [4, 5, 6]").replace("above: 0.968", "above: 0.1")

    def start(self):
        (self.folder / "study.yaml").write_text(self.LONGER)
        process = subprocess.Popen([BIN / "gridspace", "sweep", "study.yaml", "--out", "out", "--jobs", "2"], cwd=self.folder,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + HANG_S
        while not (records := list(self.folder.glob("out/runs/*/record.json"))) or not list(self.folder.glob("out/runs/*/run")):
            self.assertLess(time.monotonic(), deadline, "no run came to its end")
            self.assertIsNone(process.poll(), "it ended before it was interrupted")
            time.sleep(0.01)
        return process, records

    def finish(self, records):
        before = {f: f.stat().st_mtime_ns for f in records}
        done = sweep(self.folder, "--json", "--resume", study=self.LONGER)
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads(done.stdout)
        self.assertEqual((summary["runs"], summary["passed"]), (6, 6))
        self.assertGreaterEqual(summary["there_already"], len(records))
        self.assertEqual(before, {f: f.stat().st_mtime_ns for f in records}, "a run that was done was done again")
        self.assertEqual(list(self.folder.glob("out/runs/*/run")), [])

    def test_after_kill_9_the_same_study_goes_on_and_nothing_is_lost_or_done_twice(self):
        process, records = self.start()
        process.kill()
        process.wait()
        self.finish(records)

    def test_ctrl_c_ends_with_130_a_table_of_what_is_there_and_goes_on_later(self):
        process, records = self.start()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=HANG_S), 130)
        states = [r["state"] for r in rows(self.folder)]
        self.assertEqual(len(states), 6)
        self.assertIn("open", states)
        self.assertIn("passed", states)
        self.assertEqual(list(self.folder.glob("out/runs/*/run")), [], "what was under way is thrown away")
        self.finish(records)


class Early(Folder):
    def test_a_run_that_dies_keeps_its_folder_is_said_and_is_tried_again(self):
        study = STUDY.replace("values: [5, 20]", "values: [5]").replace("values: [4, 5]", "values: [4]").replace(
            "report: ~", "hosts.spare: {links: [lan]}, processes.dies: {program: exec, host: spare, command: [/bin/sh, -c, exit 9], member: true}")
        done = sweep(self.folder, study=study)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("ended early, with code 4: process 'dies' died", done.stderr)
        [row] = rows(self.folder)
        self.assertEqual((row["state"], row["exit"]), ("ended_early", "4"))
        self.assertTrue((pathlib.Path(row["folder"]) / "manifest.json").is_file())
        self.assertIn("again: ", done.stderr)
        self.assertEqual(json.loads(sweep(self.folder, "--json", study=study).stdout)["there_already"], 0)


class Refusals(Folder):
    def test_two_sweeps_do_not_work_in_one_folder(self):
        (self.folder / "out").mkdir()
        with (self.folder / "out/study.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = sweep(self.folder)
        self.assertEqual(done.returncode, 3)
        self.assertIn("another sweep is at work in", done.stderr)

    def test_resume_wants_something_to_resume(self):
        done = sweep(self.folder, "--resume")
        self.assertEqual(done.returncode, 2)
        self.assertIn("there is nothing to resume in", done.stderr)

    def test_a_folder_that_cannot_be_made_is_an_error(self):
        (self.folder / "out").write_text("a file")
        done = sweep(self.folder)
        self.assertEqual(done.returncode, 3)
        self.assertIn("cannot write in", done.stderr)

    def test_no_jobs_are_refused(self):
        self.assertEqual(sweep(self.folder, "--jobs", "0").returncode, 2)

    def test_a_change_of_a_file_that_a_run_depends_on_changes_its_key(self):
        (self.folder / "agent.py").write_text("one")
        study = STUDY + "depends_on: [agent.py]\n"
        first = sweep(self.folder, "--dry-run", study=study).stdout
        self.assertEqual(first, sweep(self.folder, "--dry-run", study=study).stdout)
        (self.folder / "agent.py").write_text("two")
        self.assertNotEqual(first, sweep(self.folder, "--dry-run", study=study).stdout)

    def test_what_only_the_report_shows_changes_no_key(self):
        first = sweep(self.folder, "--dry-run").stdout
        self.assertEqual(first, sweep(self.folder, "--dry-run", study=STUDY.replace("report: ~", "report: ~, description: Other words")).stdout)
        self.assertNotEqual(first, sweep(self.folder, "--dry-run", study=STUDY.replace("report: ~", "seed: 5")).stdout)

    def test_repetitions_have_seeds_of_their_own(self):
        done = sweep(self.folder, "--dry-run", study=STUDY.replace("values: [5, 20]", "values: [5]").replace("values: [4, 5]", "values: [4]") + "repetitions: 3\n")
        keys = [line.split()[1] for line in done.stdout.splitlines() if "repetition" in line]
        self.assertEqual(len(set(keys)), 3, done.stdout + done.stderr)


class Python(Folder):
    def test_sweep_returns_the_table(self):
        (self.folder / "study.yaml").write_text(STUDY.replace("values: [5, 20]", "values: [20]"))
        table = gridspace.sweep(self.folder / "study.yaml", out=self.folder / "out", jobs=2)
        self.assertEqual([(r["load_kw"], r["requested_h"], r["state"]) for r in table], [(20.0, 4.0, "failed"), (20.0, 5.0, "failed")])
        self.assertEqual(len(table), 2)
        self.assertFalse(table.passed)
        self.assertEqual(table.column("requested_h"), [4.0, 5.0])
        self.assertAlmostEqual(table.open(1).expectations[0].value, table[0]["v_min"], places=12)
        with self.assertRaisesRegex(KeyError, "there is no column 'v_mni'"):
            table.column("v_mni")
        with self.assertRaises(KeyError):
            table.open(3)

    def test_the_launchers_errors_are_exceptions_with_its_text(self):
        (self.folder / "study.yaml").write_text(STUDY.replace("loads.L3", "loads.L9"))
        with self.assertRaisesRegex(gridspace.Error, "the network has no 'L9' in loads") as caught:
            gridspace.sweep(self.folder / "study.yaml", out=self.folder / "out")
        self.assertEqual(caught.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
