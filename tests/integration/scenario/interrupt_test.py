# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C is clean at every moment: exit code 130, a folder that can be read, nothing left behind."""
import fcntl
import os
import signal
import subprocess
import termios
import time
import unittest

from harness import BASE, BIN, CASE_1, HANG_S, INTERRUPTED, OK, PACED, ScenarioTest


class Interrupt(ScenarioTest):
    def interrupt(self, run, signal_number=signal.SIGINT):
        os.kill(run.pid, signal_number)
        code = run.finish()
        self.assertEqual(run.left_over(), {}, run.stderr())
        self.assertEqual(code, INTERRUPTED, run.stderr())
        return run

    def test_while_running_the_recording_is_closed_and_the_report_written(self):
        run = self.start("run", PACED)
        run.wait_for_time(6000)
        self.interrupt(run)
        self.assertEqual(run.manifest()["exit"], INTERRUPTED)
        self.assertEqual(run.summary()["exit"], INTERRUPTED)
        self.assertGreater(run.summary()["simulated_s"], 5000)
        self.assertIn(("launcher", "run_stopped"), [(e["source"], e["event"]) for e in run.events()])
        self.assert_recording_readable(run, at_least_s=5000)
        self.assert_recording_complete(run)
        self.assertTrue((run.folder / "report/index.html").exists())

    def test_sigterm_is_as_good_as_ctrl_c(self):
        run = self.start("run", PACED)
        run.wait_for_time(3000)
        self.interrupt(run, signal.SIGTERM)

    def test_a_terminal_that_is_closed_stops_it_in_order(self):
        ours, terminal = os.openpty()
        folder = self.folder / "run"
        process = subprocess.Popen([BIN / "gridspace", "run", CASE_1, *PACED, "--out", folder], stdin=terminal, stdout=terminal, stderr=terminal,
                                   start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(terminal)
        said = b""
        while b"are ready" not in said:
            said += os.read(ours, 4096)
        os.close(ours)
        self.assertEqual(process.wait(HANG_S), INTERRUPTED, said)
        self.assertTrue((folder / "report/index.html").exists())

    def test_nohup_runs_on_when_the_terminal_is_gone(self):
        run = self.start("run", [*PACED, "--until", "1800s", "--set", "expect=~"], prefix=["nohup"])
        run.wait_for(lambda line: "ready" in str(line.get("note")), "readiness")
        os.kill(run.pid, signal.SIGHUP)
        self.assertEqual(run.finish(), OK, run.stderr())

    def test_sigint_is_heard_where_a_script_has_its_background_ignore_it(self):
        run = self.start("run", PACED, prefix=["sh", "-c", 'trap "" INT; exec "$@"', "sh"])
        run.wait_for_time(1000)
        self.interrupt(run)

    def wait_in_the_report(self, name):
        """A run that is over and writes its report: it waits for somebody to read its JUnit pipe."""
        pipe = self.folder / f"{name}.xml"
        os.mkfifo(pipe)
        run = self.start(name, [*BASE, "--until", "60s", "--set", "expect=~", "--junit", pipe])
        deadline = time.monotonic() + HANG_S
        while not (run.folder / "report/index.html").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        return run, pipe

    def test_while_the_report_is_written_the_first_is_noted_and_the_second_ends_it(self):
        run, pipe = self.wait_in_the_report("once")
        os.kill(run.pid, signal.SIGINT)
        self.assertIn("testsuite", pipe.read_text())
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())
        self.assertEqual(run.summary()["exit"], OK, "the run itself had come to its end")
        run, _ = self.wait_in_the_report("twice")
        os.kill(run.pid, signal.SIGINT)
        os.kill(run.pid, signal.SIGTERM)
        self.assertEqual(run.finish(), INTERRUPTED)

    def test_as_soon_as_the_run_folder_is_announced(self):
        run = self.start("run", PACED)
        run.wait_for(lambda line: "run folder" in str(line.get("note")), "the run folder")
        self.interrupt(run)

    def test_as_soon_as_everybody_is_ready(self):
        run = self.start("run", PACED)
        run.wait_for(lambda line: "ready" in str(line.get("note")), "readiness")
        self.interrupt(run)

    def test_without_namespaces(self):
        run = self.start("run", [*PACED, "--no-namespaces"])
        run.wait_for_time(3000)
        self.interrupt(run)

    def test_twice_stops_at_once(self):
        run = self.start("run", PACED)
        run.wait_for_time(3000)
        os.kill(run.pid, signal.SIGINT)
        os.kill(run.pid, signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED)
        self.assertEqual(run.left_over(), {})

    def test_a_paced_run_that_waits_for_its_next_tick_stops_at_once(self):
        run = self.start("run", [*BASE, "--set", "clock.speed=1", "--set", "clock.tick_s=60",
                                 "--set", "processes.mcca.latency_us=60000000"])
        run.wait_for(lambda line: "ready" in str(line.get("note")), "readiness")
        asked = time.monotonic()
        self.interrupt(run)
        self.assertLess(time.monotonic() - asked, 20, "not only at the next tick, a minute later")

    def test_at_many_moments_of_starting_up_and_shutting_down(self):
        """The moment is swept, not waited for: whatever state is met, the end is clean."""
        short = [*BASE, "--until", "1800s", "--set", "expect=~"]
        codes = []
        for step in range(24):
            run = self.start(f"run{step}", short)
            try:
                run.process.wait(0.05 * step)  # up to 1.2 s: the whole life of so short a run
            except Exception:
                os.kill(run.pid, signal.SIGINT)
            code = run.finish(HANG_S)
            self.assertEqual(run.left_over(), {}, f"{0.05 * step} s: {run.stderr()}")
            # Before main() has blocked it, the signal has its own way; after the last tick the run is simply over.
            self.assertIn(code, [INTERRUPTED, OK, -signal.SIGINT], f"{0.05 * step} s: {run.stderr()}")
            if (run.folder / "data.mcap").exists():
                self.assert_recording_complete(run, f"{0.05 * step} s: {run.stderr()}")
            codes.append(code)
        self.assertIn(INTERRUPTED, codes)


if __name__ == "__main__":
    unittest.main(verbosity=2)
