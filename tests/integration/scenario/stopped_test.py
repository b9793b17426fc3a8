# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A process that is stopped (SIGSTOP) is named itself, whoever notices first; one that ends as it should is not called killed."""
import json
import os
import pathlib
import shutil
import signal
import time
import unittest

from harness import BIN, CASE_1, OK, PACED, SOURCE, STALL, ScenarioTest
from many_hosts import write_case

LEASE_S = 4  # instead of 10


class Stopped(ScenarioTest):
    def stop_in_mid_run(self, victim, *extra):
        run = self.start("run", [*PACED, "--set", "clock.member_timeout_s=2", *extra])
        run.wait_for_time(1000)
        os.kill(run.pid_of(victim), signal.SIGSTOP)
        self.assertEqual(run.finish(), STALL, run.stderr())
        self.assertEqual(run.left_over(), {})
        self.assertRegex(run.summary()["cause"], f"^process '{victim}' is stopped|^the simulator '{victim}' stands still")

    def test_the_simulator_is_named(self):
        self.stop_in_mid_run("sim")

    def test_an_agent_is_named(self):
        self.stop_in_mid_run("ev3")

    def test_the_controller_is_named(self):
        self.stop_in_mid_run("mcca")

    def test_the_recorder_is_named(self):
        self.stop_in_mid_run("recorder")

    def test_a_simulator_that_nobody_hears_for_a_while_before_the_start_is_waited_for(self):
        qos = self.folder / "qos"
        shutil.copytree(SOURCE / "qos", qos)
        for file in qos.glob("*.xml"):
            file.write_text(file.read_text().replace("<leaseDuration><sec>10<", f"<leaseDuration><sec>{LEASE_S}<"))
        late = self.folder / "late_agent"
        late.write_text(f'#!/bin/sh\n[ "$1" = --describe ] || while [ ! -e {self.folder}/go ]; do sleep 0.1; done\nexec {BIN}/gridspace-ev "$@"\n')
        late.chmod(0o755)
        scenario = self.write("own.yaml", json.dumps({"extends": str(CASE_1), "processes": {"ev1": {"program": {"path": str(late)}}}}))
        run = self.start("run", ["--until", "60s", "--set", "expect=~"], scenario, prefix=("env", f"GRIDSPACE_QOS_DIR={qos}"))
        logs = run.folder / "logs"
        deadline = time.monotonic() + 60
        while not all((logs / f"{name}.log").exists() and "waits for" in (logs / f"{name}.log").read_text() for name in ("sim", "mcca", "recorder")):
            self.assertLess(time.monotonic(), deadline, "all but one are waiting")
            time.sleep(0.1)
        simulator = run.pid_of("sim")
        os.kill(simulator, signal.SIGSTOP)
        time.sleep(1.5 * LEASE_S)  # its lease has run out
        os.kill(simulator, signal.SIGCONT)
        (self.folder / "go").touch()
        self.assertEqual(run.finish(), OK, run.stderr())

    def stop_the_recorder_before_the_end(self, name, timeout_s):
        run = self.start(name, ["--set", f"clock={{mode: realtime, speed: 600, member_timeout_s: {timeout_s}}}", "--set", "expect=~", "--until", "40min"])
        run.wait_for_time(1800)
        recorder, simulator = run.pid_of("recorder"), run.pid_of("sim")
        os.kill(recorder, signal.SIGSTOP)
        return run, recorder, pathlib.Path(f"/proc/{simulator}")

    def test_in_real_time_the_simulator_stays_until_a_recorder_that_is_behind_has_heard_the_end(self):
        run, recorder, simulator = self.stop_the_recorder_before_the_end("run", 60)
        time.sleep(5)  # the end is after one, and those who only listen are waited for two
        self.assertTrue(simulator.exists())
        os.kill(recorder, signal.SIGCONT)
        self.assertEqual(run.finish(), OK, run.stderr())
        run, recorder, simulator = self.stop_the_recorder_before_the_end("impatient", 1)
        deadline = time.monotonic() + 60
        while simulator.exists():
            self.assertLess(time.monotonic(), deadline, "a control: it leaves without the recorder")
            time.sleep(0.1)
        os.kill(recorder, signal.SIGCONT)
        run.finish()

    def test_a_program_that_is_told_to_end_and_does_is_not_called_killed(self):
        run = self.run_to_end("run", ["--set", "processes.own={program: exec, host: h0, command: [sleep, '1000']}"],
                              write_case(self.folder, 1, duration_s=1))
        own = run.manifest()["processes"]["own"]
        self.assertEqual((own["exit"], own["end"]), (0, "ended when asked"))


if __name__ == "__main__":
    unittest.main()
