# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A process that dies or stalls ends the run: soon, with its name, a readable recording, and nothing left behind."""
import json
import os
import signal
import time
import unittest

from harness import BASE, CHILD_DIED, PACED, STALL, ScenarioTest, gridspace

ENDS_WITHIN_S = 5  # promised, on a machine with nothing else to do ...
BUSY_MACHINE_S = 25  # ... which a test cannot know: this much more, and it hangs
MEMBER_TIMEOUT_S = 4  # longer than a busy machine leaves one of them alone


class Death(ScenarioTest):
    def kill_in_mid_run(self, victim, extra=()):
        run = self.start("run", [*PACED, *extra])
        run.wait_for_time(4500)
        os.kill(run.pid_of(victim), signal.SIGKILL)
        killed = time.monotonic()
        code = run.finish()
        self.assertLess(time.monotonic() - killed, ENDS_WITHIN_S + BUSY_MACHINE_S, "report included")
        self.assertEqual(code, CHILD_DIED, run.stderr())
        self.assertEqual(run.left_over(), {})
        return run

    def assert_says(self, run, victim):
        first = [line for line in run.stderr().splitlines() if not line.startswith("{")][0]
        self.assertIn("the run ended early", first)
        self.assertIn(f"'{victim}'", first)
        self.assertIn("signal 9", first)
        self.assertEqual(run.manifest()["exit"], CHILD_DIED)
        self.assertIn(f"'{victim}'", run.summary()["cause"])
        self.assertEqual(run.summary()["exit"], CHILD_DIED)
        told = [(e["source"], e["event"]) for e in run.events()]
        self.assertEqual(told[told.index((victim, "exit")) + 1], ("launcher", "run_failed"), "before the others end of it")

    def test_killing_the_simulator_ends_the_run_and_names_it(self):
        run = self.kill_in_mid_run("sim")
        self.assert_says(run, "sim")
        self.assert_recording_readable(run, at_least_s=3000)
        self.assert_recording_complete(run)

    def test_killing_an_ev_agent_ends_the_run_and_names_it(self):
        run = self.kill_in_mid_run("ev3")
        self.assert_says(run, "ev3")
        self.assert_recording_readable(run, at_least_s=3000)
        self.assert_recording_complete(run)

    def test_killing_the_mcca_ends_the_run_and_names_it(self):
        run = self.kill_in_mid_run("mcca")
        self.assert_says(run, "mcca")
        self.assert_recording_readable(run, at_least_s=3000)
        self.assert_recording_complete(run)

    def test_killing_the_recorder_ends_the_run_and_its_file_is_still_readable(self):
        run = self.kill_in_mid_run("recorder")
        self.assert_says(run, "recorder")
        self.assert_recording_readable(run, at_least_s=1000)

    def test_killing_the_supervisor_takes_everything_with_it(self):
        run = self.kill_in_mid_run("supervisor")
        self.assertIn("supervisor", run.stderr())
        self.assert_recording_readable(run, at_least_s=1000)

    def test_killing_the_supervisor_without_namespaces_takes_everything_with_it(self):
        run = self.kill_in_mid_run("supervisor", ["--no-namespaces"])
        self.assertIn("supervisor", run.stderr())

    def test_killing_a_member_without_namespaces_names_it(self):
        run = self.kill_in_mid_run("ev2", ["--no-namespaces"])
        self.assert_says(run, "ev2")

    def test_without_namespaces_what_a_program_has_started_ends_with_it(self):
        deaf = "(trap '' TERM; exec sleep 1000) & exec sleep 1000"  # its child does not hear that the run is over
        outsider = {"program": "exec", "host": "board1", "command": ["sh", "-c", deaf]}
        run = self.run_to_end("deaf", [*BASE, "--no-namespaces", "--until", "5min", "--set", "expect=~", "--set", f"processes.outsider={json.dumps(outsider)}"])
        self.assertEqual(run.left_over(), {})

    def kill_the_launcher(self, extra=()):
        run = self.start("run", [*PACED, *extra])
        run.wait_for_time(4500)
        os.kill(run.pid, signal.SIGKILL)
        self.assertEqual(run.finish(), -signal.SIGKILL)
        self.assertEqual(run.left_over(), {}, "the kernel ends what the launcher cannot")
        self.assert_recording_readable(run, at_least_s=1000)
        code, out, err = gridspace("report", run.folder)
        self.assertEqual(code, CHILD_DIED, out + err)

    def test_killing_the_launcher_leaves_nothing_behind(self):
        self.kill_the_launcher()

    def test_killing_the_launcher_without_namespaces_leaves_nothing_behind(self):
        self.kill_the_launcher(["--no-namespaces"])


class Stall(ScenarioTest):
    def stop_in_mid_run(self, victim):
        run = self.start("run", [*PACED, "--set", f"clock.member_timeout_s={MEMBER_TIMEOUT_S}"])
        run.wait_for_time(4500)
        os.kill(run.pid_of(victim), signal.SIGSTOP)
        code = run.finish()
        self.assertEqual(code, STALL, run.stderr())
        self.assertEqual(run.left_over(), {})
        self.assertIn(victim, run.summary()["cause"])
        self.assert_recording_readable(run, at_least_s=3000)
        return run

    def test_a_stopped_agent_is_named_after_member_timeout(self):
        cause = self.stop_in_mid_run("ev2").summary()["cause"]
        self.assertIn("'ev2' is stopped", cause)
        self.assertNotIn("mcca", cause, "it only waits for ev2")

    def test_a_stopped_mcca_is_named_after_member_timeout(self):
        self.stop_in_mid_run("mcca")

    def test_a_stopped_recorder_is_named_after_member_timeout(self):
        self.stop_in_mid_run("recorder")

    def test_a_stopped_simulator_is_named(self):
        self.stop_in_mid_run("sim")


if __name__ == "__main__":
    unittest.main(verbosity=2)
