# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The processes of a run keep no privilege that they have no use for, also when root has started it."""
import contextlib
import pathlib
import unittest

from harness import BASE, SHORT_CASE_2, ScenarioTest, processes_of_session

NET_RAW, SYS_PTRACE, SYS_ADMIN = 1 << 13, 1 << 19, 1 << 21


def privileges(run):
    """{process of the scenario: (capabilities, no_new_privs, seccomp mode)} of what `gridspace run` has started."""
    out = {}
    for pid in processes_of_session(run.pid):
        with contextlib.suppress(OSError):
            status = dict(line.split(":\t", 1) for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines())
            environment = pathlib.Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
            for name in (word[18:].decode() for word in environment if word.startswith(b"GRIDSPACE_PROCESS=")):
                held = int(status["CapEff"], 16) | int(status["CapPrm"], 16) | int(status["CapBnd"], 16)
                out[name] = (held, int(status["NoNewPrivs"]), int(status["Seccomp"]))
    return out


class LeastPrivilege(ScenarioTest):
    def test_agents_hold_no_capability_and_make_no_call_that_nobody_needs(self):
        run = self.start("run", [*BASE, "--speed", "3600", "--until", "9000s", "--set", "expect=~", "--set",
                                 "processes.own={program: exec, host: board1, command: [sleep, '1000']}"])
        run.wait_for_time(100)
        found = privileges(run)
        self.assertEqual(found.pop("own"), (NET_RAW, 1, 0), "a user's program: raw frames on its links, and its own calls")
        self.assertEqual(set(found), {"sim", "ev1", "ev2", "ev3", "ev4", "mcca", "recorder"})
        self.assertEqual(set(found.values()), {(0, 1, 2)}, found)
        self.assertEqual(run.finish(), 0, run.stderr())

    def test_threads_of_the_waveforms_are_under_the_same_list(self):
        run = self.start("run", ["--speed", "0.05", "--set", "simulation.threads=3"], self.write("short.yaml", SHORT_CASE_2))
        run.wait_for_time(0.01)
        modes = {}
        for pid in processes_of_session(run.pid):
            with contextlib.suppress(OSError):
                if b"GRIDSPACE_PROCESS=sim" in pathlib.Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
                    for status in pathlib.Path(f"/proc/{pid}/task").glob("*/status"):
                        modes[status] = dict(line.split(":\t", 1) for line in status.read_text().splitlines())["Seccomp"]
        self.assertGreaterEqual(len(modes), 3)
        self.assertEqual(set(modes.values()), {"2"}, modes)
        self.assertEqual(run.finish(), 0, run.stderr())

    def test_only_who_exchanges_raw_frames_may_open_raw_sockets(self):
        run = self.start("run", ["--speed", "0.05"], self.write("short.yaml", SHORT_CASE_2))
        run.wait_for_time(0.01)
        found = privileges(run)
        self.assertEqual({(new, calls) for _, new, calls in found.values()}, {(1, 2)}, found)
        self.assertEqual(found["sim"][0], 0)
        self.assertEqual(found.pop("recorder")[0] & ~(NET_RAW | SYS_PTRACE | SYS_ADMIN), 0, "it listens at the switches")
        self.assertEqual({held for held, *_ in found.values()}, {0, NET_RAW}, found)
        self.assertEqual(run.finish(), 0, run.stderr())


if __name__ == "__main__":
    unittest.main()
