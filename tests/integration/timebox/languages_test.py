# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs in Go, Rust and Java in simulated time: each wait of their libraries ends when arithmetic says, and runs repeat."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

GRIDSPACE = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
PROGRAMS = pathlib.Path(__file__).parent / "programs"


class Languages(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace-languages-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def compile(self, *command):
        if shutil.which(command[0]) is None:
            self.assertNotIn("GRIDSPACE_TEST_ALL", os.environ, f"{command[0]} is missing")
            self.skipTest(f"{command[0]} is missing")
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=300,
                              env=os.environ | {"GOCACHE": str(self.folder / "go"), "GO111MODULE": "off"})
        self.assertEqual(done.returncode, 0, done.stderr)

    def box(self, seed, *command):
        done = subprocess.run([GRIDSPACE, "timebox", "-q", "--seed", seed, "--", *command], cwd=self.folder, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout.splitlines()

    def assert_said(self, expected, *command):
        first, again, other = self.box("7", *command), self.box("7", *command), self.box("8", *command)
        self.assertEqual(first[:-1], expected)
        self.assertEqual(first, again)
        self.assertEqual(first[:-1], other[:-1])
        self.assertRegex(first[-1], "^random ")
        self.assertNotEqual(first[-1], other[-1])

    def test_go(self):
        self.compile("go", "build", "-o", "clocks", str(PROGRAMS / "clocks.go"))
        self.assert_said(["today 2019-12-01T00:00:00", "slept 10 ms", "ticked 30 ms", "nobody came 100 ms", "goroutine 3 110 ms", "goroutine 2 120 ms", "goroutine 1 130 ms",
                          "mutex 230 ms", "socket timed out: true 400 ms", "child: signal: killed 600 ms", "computed 19999999900000000 600 ms"], "./clocks")

    def test_rust(self):
        self.compile("rustc", "-O", "-o", "clocks", str(PROGRAMS / "clocks.rs"))
        self.assert_said(["today 1575158400", "slept 10 ms", "nobody came 30 ms", "thread 3 40 ms", "thread 2 50 ms", "thread 1 60 ms", "condition 160 ms", "timed out: true 190 ms",
                          "parked 205 ms", "socket timed out 305 ms"], "./clocks")

    def test_java(self):
        self.compile("javac", "-d", ".", str(PROGRAMS / "Clocks.java"))
        self.assert_said(["today 2019-12-01T00:00:00Z", "slept 10 ms", "parked 30 ms", "monitor timed out 60 ms", "null", "nobody came 100 ms", "ticked 150 ms",
                          "thread 3 160 ms", "thread 2 170 ms", "thread 1 180 ms", "1", "false", "child waited for 380 ms"], "java", "Clocks")


if __name__ == "__main__":
    unittest.main()
