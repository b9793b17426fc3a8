#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""scripts/unit_tests.py on programs that do what a GoogleTest program may do: pass, fail, skip, break, hang, and have no test."""
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

SCRIPT = pathlib.Path(os.environ["GRIDSPACE_SOURCE_DIR"]) / "scripts/unit_tests.py"
# Stands for a test program: writes the results that it was asked for, as GoogleTest does, and ends as it is told.
PROGRAM = textwrap.dedent("""\
    #!{python}
    import json, os, sys, time
    output = next(a.split(":", 1)[1] for a in sys.argv if a.startswith("--gtest_output=json:"))
    shard, shards = int(os.environ["GTEST_SHARD_INDEX"]), int(os.environ["GTEST_TOTAL_SHARDS"])
    tests = {tests!r}
    print("[ RUN      ] Suite." + (tests[-1][0] if tests else "Nothing"), flush=True)
    {body}
    entries = [dict(name=name, classname="Suite", status="RUN", result="SKIPPED" if how == "skip" else "COMPLETED", time="0.01s",
                    failures=[dict(failure="expected 1")] if how == "fail" else []) for name, how in tests[shard::shards]]
    json.dump(dict(testsuites=[dict(testsuite=entries)] if entries else []), open(output, "w"))
    sys.exit({code} or any(how == "fail" for _, how in tests))
    """)


class UnitTests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build = pathlib.Path(folder.name)
        (self.build / "tests").mkdir()
        (self.build / "unit_tests.txt").touch()

    def program(self, name, *tests, parts=1, how="beside", body="", code=0):
        file = self.build / "tests" / name
        file.write_text(PROGRAM.format(python=sys.executable, tests=list(tests), body=body, code=code))
        file.chmod(0o755)
        with (self.build / "unit_tests.txt").open("a") as names:
            names.write(f"{name} {parts} {how}\n")

    def run_script(self, *options):
        return subprocess.run([sys.executable, SCRIPT, self.build, *options], capture_output=True, text=True, timeout=60, check=False)

    def test_counts_what_passes_in_parts_beside_and_alone(self):
        self.program("unit_a", ("One", "pass"), ("Two", "pass"), ("Three", "pass"), parts=2)
        self.program("unit_b", ("Four", "pass"), how="alone")
        done = self.run_script("--times", self.build / "times.txt")
        self.assertEqual((done.returncode, done.stdout.splitlines()[-1]), (0, "4 tests, 0 failed, 0 skipped"), done.stdout)
        self.assertEqual(sorted(line.split()[1] for line in (self.build / "times.txt").read_text().splitlines()),
                         ["unit_a.Suite.One", "unit_a.Suite.Three", "unit_a.Suite.Two", "unit_b.Suite.Four"])

    def test_names_what_fails_and_why(self):
        self.program("unit_a", ("One", "pass"), ("Two", "fail"))
        done = self.run_script()
        self.assertEqual(done.returncode, 1)
        self.assertIn("unit_a.Suite.Two\nexpected 1", done.stdout)
        self.assertIn("2 tests, 1 failed", done.stdout)

    def test_a_skip_has_to_be_allowed(self):
        self.program("unit_a", ("One", "skip"))
        allowed = self.build / "allowed.txt"
        allowed.write_text("# why\nunit_a.Suite.One for a reason\n")
        self.assertEqual(self.run_script("--allowed-skips", allowed).returncode, 0)
        allowed.write_text("")
        done = self.run_script("--allowed-skips", allowed)
        self.assertEqual(done.returncode, 1)
        self.assertIn("not expected to be skipped: unit_a.Suite.One", done.stdout)

    def test_a_program_that_dies_in_a_test_is_that_test_s_failure(self):
        self.program("unit_a", ("One", "pass"), body="os.abort()")
        done = self.run_script()
        self.assertEqual(done.returncode, 1)
        self.assertIn("Suite.One\nended with -6", done.stdout)

    def test_what_complains_after_its_last_test_has_failed(self):
        self.program("unit_a", ("One", "pass"), code=23)  # as the sanitizers do
        done = self.run_script()
        self.assertEqual(done.returncode, 1)
        self.assertIn("ended with 23", done.stdout)

    def test_a_program_that_hangs_is_named_in_time(self):
        self.program("unit_a", ("One", "pass"), body="time.sleep(50)")
        done = self.run_script("--patience", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("Suite.One\nnot at its end after 1 s", done.stdout)

    def test_a_program_without_a_test_and_a_build_without_programs_fail(self):
        self.assertEqual(self.run_script().returncode, 1)
        self.program("unit_a")
        self.assertEqual(self.run_script().returncode, 1)


if __name__ == "__main__":
    unittest.main()
