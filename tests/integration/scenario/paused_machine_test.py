# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A machine that is paused (a virtual one that is moved, a laptop that sleeps) and goes on: nobody is taken for dead by who wakes up first."""
import os
import pathlib
import shutil
import signal
import time
import unittest

from harness import OK, PACED, SOURCE, ScenarioTest, processes_of_session

MEMBERS = ("ev1", "ev2", "ev3", "ev4", "mcca", "recorder")


def switches(pid):
    """How often it has gone to wait."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("voluntary_ctxt_switches")).split()[1])


class PausedMachine(ScenarioTest):
    def test_a_pause_longer_than_every_patience_ends_no_run(self):
        qos = self.folder / "qos"
        shutil.copytree(SOURCE / "qos", qos)
        for file in qos.glob("*.xml"):  # the leases of DDS shall not be what is tested
            file.write_text(file.read_text().replace("<leaseDuration><sec>10<", "<leaseDuration><sec>600<"))
        run = self.start("run", [*PACED, "--until", "14400s", "--set", "expect=~", "--set", "clock.member_timeout_s=5"],
                         prefix=("env", f"GRIDSPACE_QOS_DIR={qos}"))
        run.wait_for_time(1800)
        supervisor, simulator = run.pid_of("supervisor"), run.pid_of("sim")
        members = [run.pid_of(name) for name in MEMBERS]
        everybody = [supervisor, simulator, *members]
        for pid in everybody:
            os.kill(pid, signal.SIGSTOP)
        time.sleep(11)  # the pause: twice the patience with a member, which is that with the simulator
        for pid in (supervisor, simulator):  # the worst order: each has looked before the next one runs
            before = switches(pid)
            os.kill(pid, signal.SIGCONT)
            while switches(pid) < before + 2 and pid in processes_of_session(run.pid):
                time.sleep(0.01)
        for pid in members:
            os.kill(pid, signal.SIGCONT)
        self.assertEqual(run.finish(), OK, run.stderr())


if __name__ == "__main__":
    unittest.main()
