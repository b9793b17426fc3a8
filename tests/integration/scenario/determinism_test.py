# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The same scenario gives the same recording at any speed, beside anything; another scenario does not."""
import unittest

from harness import BASE, EXPECTATION, OK, ScenarioTest, busy_loops, gridspace

HOUR = [*BASE, "--until", "1h", "--set", "expect=~"]


class Determinism(ScenarioTest):
    def test_pace_load_and_isolation_do_not_change_a_sample(self):
        alone = self.run_to_end("alone", HOUR)
        paced = self.run_to_end("paced", [*HOUR, "--speed", "3000"])
        self.assert_identical(alone, paced)
        with busy_loops():
            loaded = self.run_to_end("loaded", HOUR)
        self.assert_identical(alone, loaded)
        loopback = self.run_to_end("loopback", [*HOUR, "--no-namespaces"])
        self.assert_identical(alone, loopback)

    def test_two_runs_side_by_side_are_each_identical_to_one_alone(self):
        alone = self.run_to_end("alone", HOUR)
        for isolation in ([], ["--no-namespaces"]):
            together = [self.start(f"{name}{len(isolation)}", [*HOUR, *isolation]) for name in ("left", "right")]
            for run in together:
                self.assertEqual(run.finish(), OK, run.stderr())
                self.assertEqual(run.left_over(), {})
                self.assert_identical(alone, run)

    def test_ticks_of_a_quarter_and_one_second_give_the_same_requests_decisions_and_states(self):
        second = self.run_to_end("second", HOUR)
        quarter = self.run_to_end("quarter", [*HOUR, "--set", "clock.tick_s=0.25"])
        self.assertIn("ticks differ", self.assert_identical(second, quarter))
        self.assertEqual(self.compare(second, quarter, "--signals", "bus.*,ev.*,agent.*")[0], OK)
        code, out, err = gridspace("compare", second.folder, second.folder / "data.mcap")  # a file alone does not say its tick
        self.assertEqual((code, out.split(":")[0]), (OK, "identical"), out + err)

    def test_another_parameter_is_seen_by_compare_and_within_its_tolerance_not(self):
        one = self.run_to_end("one", HOUR)
        other = self.run_to_end("other", [*HOUR, "--set", "processes.mcca.rules.curtail_factor=0.7501"])
        code, said = self.compare(one, other)
        self.assertEqual(code, EXPECTATION, said)
        self.assertRegex(said, r"first divergence at [0-9.]+ s: decisions of mcca")
        self.assertEqual(self.compare(one, other, "--signals", "bus.*.v_pu")[0], EXPECTATION)
        self.assertEqual(self.compare(one, other, "--signals", "bus.*.v_pu", "--tolerance", "0.01")[0], OK)

    def test_another_process_set_is_seen_by_compare(self):
        short = [*BASE, "--until", "900s", "--set", "expect=~"]
        four = self.run_to_end("four", short)
        three = self.run_to_end("three", [*short, "--set", "processes.ev4=~"])
        code, said = self.compare(four, three)
        self.assertEqual(code, EXPECTATION, said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
