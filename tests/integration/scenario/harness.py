# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs the real `gridspace` and looks at what it starts. Standard library only.

Every run has a session of its own, so that whatever it leaves behind is found by its session id and no other run of the
machine is seen. Waits are for something to happen, with a deadline that only a hang reaches.
"""
import contextlib
import json
import os
import pathlib
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
CASE_1 = SOURCE / "configs/scenarios/ev_charging.yaml"



def short_case_2(scenario="protection_lockstep", duration_s=0.1, events="{fault: {at_s: 0.04}}"):
    """A piece of case 2 without what a test does not need: for a file that others extend."""
    return f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/{scenario}.yaml
name: short
simulation: {{duration_s: {duration_s}}}
processes: {{monitor: ~}}
events: {events}
record: {{comtrade: ~}}
expect: ~
"""


SHORT_CASE_2 = short_case_2()
HANG_S = 240  # nothing that works takes that long, even beside ten other jobs

OK, EXPECTATION, USAGE, ENVIRONMENT, CHILD_DIED, STALL, INTERRUPTED = 0, 1, 2, 3, 4, 5, 130

# Case 1 without what a test does not need: no dashboard. `PACED`: slow enough to be caught in the middle.
BASE = ["--set", "processes.monitor=~"]
PACED = BASE + ["--speed", "3600"]


@contextlib.contextmanager
def busy_loops():
    """Two for each processor."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 2))]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def gridspace(*arguments, timeout=HANG_S, **kwargs):
    """Runs a verb to its end: (exit code, stdout, stderr)."""
    done = subprocess.run([BIN / "gridspace", *map(str, arguments)], capture_output=True, text=True, timeout=timeout, **kwargs)
    return done.returncode, done.stdout, done.stderr


def processes_of_session(session):
    """{pid: command name} of everything alive in a session, zombies apart."""
    out = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            name, _, rest = (entry / "stat").read_text().partition(" (")[2].rpartition(")")
            state, _, _, sid = rest.split()[:4]
        except (OSError, ValueError):
            continue  # it ended meanwhile
        if int(sid) == session and state != "Z":
            out[int(entry.name)] = name
    return out


class Run:
    """A `gridspace run` that is under way."""

    def __init__(self, folder, scenario, arguments, prefix=()):
        self.folder = pathlib.Path(folder)
        command = [*prefix, str(BIN / "gridspace"), "run", str(scenario), "--json", "--out", str(folder), *map(str, arguments)]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True, start_new_session=True)
        self.lines, self.errors, self.printed = queue.Queue(), [], []
        self.readers = [threading.Thread(target=self._read_errors), threading.Thread(target=self._read_output)]
        for reader in self.readers:
            reader.start()

    def _read_errors(self):
        for line in self.process.stderr:
            self.errors.append(line)
            with contextlib.suppress(ValueError):
                self.lines.put(json.loads(line))
        self.lines.put(None)

    def _read_output(self):
        self.printed.append(self.process.stdout.read())

    @property
    def pid(self):
        return self.process.pid

    def wait_for(self, condition, what):
        """Reads progress lines until one of them satisfies `condition`."""
        deadline = time.monotonic() + HANG_S
        while (left := deadline - time.monotonic()) > 0:
            try:
                line = self.lines.get(timeout=left)
            except queue.Empty:
                break
            if line is None:
                raise AssertionError(f"the run ended before {what}:\n{self.stderr()}")
            if condition(line):
                return line
        raise AssertionError(f"waited {HANG_S} s for {what}:\n{self.stderr()}")

    def wait_for_time(self, time_s):
        return self.wait_for(lambda line: line.get("time_s", -1) >= time_s and "speed" in line, f"t = {time_s} s")

    def latest_time(self, at_least_s):
        """The simulated time that it has told of last: who was not scheduled for a while has a queue of old lines to read."""
        latest_s = self.wait_for_time(at_least_s)["time_s"]
        with contextlib.suppress(queue.Empty):
            while (line := self.lines.get_nowait()) is not None:
                latest_s = max(latest_s, line.get("time_s", 0))
            self.lines.put(None)
        return latest_s

    def pid_of(self, name):
        """The process `name` of the scenario, "supervisor", or "launcher"."""
        if name == "launcher":
            return self.pid
        for pid, command in processes_of_session(self.pid).items():
            if name == "supervisor":
                if command == "gridspace-run":
                    return pid
                continue
            with contextlib.suppress(OSError):
                environment = pathlib.Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
                if f"GRIDSPACE_PROCESS={name}".encode() in environment:
                    return pid
        raise AssertionError(f"no process '{name}' in {processes_of_session(self.pid)}:\n{self.stderr()}")

    def finish(self, timeout=HANG_S):
        """Its exit code, when it has ended and said everything."""
        code = self.process.wait(timeout)
        for reader in self.readers:
            reader.join(timeout)
        self.process.stdout.close()
        self.process.stderr.close()
        return code

    def left_over(self):
        """What stays alive after the end; the kernel takes a moment to bury what it has killed, and on a busy machine longer."""
        deadline = time.monotonic() + 30
        while (alive := processes_of_session(self.pid)) and time.monotonic() < deadline:
            time.sleep(0.02)
        return alive

    def end_by_force(self):
        for pid in processes_of_session(self.pid):
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)

    def stderr(self):
        return "".join(self.errors)

    def summary(self):
        return json.loads((self.folder / "report/summary.json").read_text())

    def manifest(self):
        return json.loads((self.folder / "manifest.json").read_text())

    def events(self):
        return [json.loads(line) for line in (self.folder / "events.ndjson").read_text().splitlines()]


class ScenarioTest(unittest.TestCase):
    """A test with a folder of its own, which is kept when it fails."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix=f"gridspace-{self._testMethodName[:40]}-"))
        self.folder.chmod(0o755)
        self.runs = []

    def tearDown(self):
        for run in self.runs:
            run.end_by_force()
        result = self._outcome.result
        failed = any(test is self for test, _ in result.failures + result.errors)
        if failed:
            print(f"kept: {self.folder}")
        else:
            shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, name, arguments=(), scenario=CASE_1, prefix=(), folder=None):
        run = Run(folder or self.folder / name, scenario, arguments, prefix)
        self.runs.append(run)
        return run

    def run_to_end(self, name, arguments=(), scenario=CASE_1, code=OK, prefix=()):
        run = self.start(name, arguments, scenario, prefix)
        ended = run.finish()
        self.assertEqual(ended, code, run.stderr())
        self.assertEqual(run.left_over(), {}, "left behind")
        return run

    def cmake_build(self, source):
        """Builds an example with CMake: its build folder."""
        folder = self.folder / "build"
        for command in (["cmake", "-S", source, "-B", folder], ["cmake", "--build", folder]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=90)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return folder

    def write(self, name, text):
        file = self.folder / name
        file.write_text(text)
        return file

    def compare(self, a, b, *arguments):
        """(exit code, what it says)"""
        code, out, err = gridspace("compare", a.folder, b.folder, *arguments)
        return code, out + err

    def assert_identical(self, a, b, *arguments):
        code, said = self.compare(a, b, *arguments)
        self.assertEqual(code, OK, said)
        self.assertIn("identical", said)
        return said

    def assert_recording_complete(self, run, why=""):
        """It ends as MCAP says, behind its index: without that, others' readers refuse it."""
        self.assertTrue((run.folder / "data.mcap").read_bytes()[8:].endswith(b"\x89MCAP0\r\n"), why)

    def assert_recording_readable(self, run, at_least_s=0.0):
        """`export --csv` makes tables of whatever was recorded, up to about the moment of the failure."""
        code, out, err = gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, OK, err)
        tables = [pathlib.Path(line) for line in out.splitlines()]
        self.assertTrue(tables, err)
        last = 0.0
        for table in tables:
            rows = table.read_text().splitlines()
            width = rows[0].count(",")
            with contextlib.suppress(ValueError):
                last = max(last, float(rows[-1].split(",")[0]))
            self.assertGreater(width, 0, table)
        self.assertGreaterEqual(last, at_least_s, tables)
        return tables
