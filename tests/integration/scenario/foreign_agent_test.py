# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The bus is open: an agent in C over CycloneDDS, built from our IDL only, is a full member of the lockstep clock."""
import os
import signal
import unittest

from harness import BASE, CHILD_DIED, SOURCE, ScenarioTest, processes_of_session

EXAMPLE = SOURCE / "examples/agents/c_ev_agent"
# What the grid and the controller do must not depend on who wrote the agent; its own signals are gridspace-ev's alone.
PHYSICS = ["--signals", "bus.*,ev.*,line.*,load.*,agent.mcca.*"]
SHORT = [*BASE, "--until", "4000s", "--set", "expect=~"]


class ForeignAgent(ScenarioTest):
    def build(self):
        return ["--set", f"processes.ev4.command=[{self.cmake_build(EXAMPLE)}/c_ev_agent, EV4, '24', '5']"]

    def test_results_are_those_of_our_own_agent(self):
        agent = self.build()
        ours = self.run_to_end("ours", SHORT)
        foreign = self.run_to_end("foreign", [*SHORT, *agent], EXAMPLE / "ev_charging_c.yaml")
        self.assert_identical(ours, foreign, *PHYSICS)
        # Negative control: another wish is another result.
        other = self.run_to_end("other", [*SHORT, agent[0], agent[1].replace("'5'", "'6'")], EXAMPLE / "ev_charging_c.yaml")
        self.assertNotEqual(self.compare(ours, other, *PHYSICS)[0], 0)

    def test_what_it_asks_is_ignored_when_it_is_no_number(self):
        agent = self.build()
        run = self.run_to_end("run", [*SHORT, agent[0], agent[1].replace("'24'", "'-inf'")], EXAMPLE / "ev_charging_c.yaml")
        said = [event for event in run.events() if event["event"] == "request_ignored"]
        self.assertEqual([(e["time_s"], e["source"], e["text"]) for e in said],
                         [(0.0, "mcca", "request of ev4 for EV4: current_a is -inf, ignored")], "once")

    def test_one_that_ends_by_itself_is_named_and_not_only_waited_for(self):
        command = f"{self.build()[1].split('[')[1].split(',')[0]} EV4 24 5; exit 0"
        run = self.start("run", [*SHORT, "--speed", "300", "--set", "clock.member_timeout_s=6", "--set", f"processes.ev4.command=[/bin/sh, -c, '{command}']"],
                         EXAMPLE / "ev_charging_c.yaml")
        run.wait_for_time(600)
        os.kill(next(pid for pid, name in processes_of_session(run.pid).items() if name == "c_ev_agent"), signal.SIGKILL)
        self.assertEqual(run.finish(), CHILD_DIED, run.stderr())
        self.assertEqual(run.summary()["cause"], "process 'ev4' ended before the run did, with exit code 0")

    def test_it_survives_its_own_restart_and_that_of_its_reader(self):
        events = ["--set", "events={x: {at_s: 1800, restart: ev4}, y: {at_s: 3000, restart: mcca}}"]
        agent = self.build()
        ours = self.run_to_end("ours", [*SHORT, *events])
        foreign = self.run_to_end("foreign", [*SHORT, *events, *agent], EXAMPLE / "ev_charging_c.yaml")
        self.assert_identical(ours, foreign, *PHYSICS)


if __name__ == "__main__":
    unittest.main()
