# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The length of a tick changes nothing but how long a run takes, however the processes dawdle; too long a tick is refused."""
import json
import unittest

from harness import BIN, OK, SOURCE, USAGE, ScenarioTest, gridspace

SHORT = ["--until", "0.2s", "--set", "events.fault.at_s=0.1", "--set", "processes.monitor=~", "--set", "expect=~", "--set", "record.comtrade=~"]
CASE_2 = SOURCE / "configs/scenarios/protection_lockstep.yaml"
PRELOAD = BIN.parent / "tests/librandom_delays.so"


class TickLength(ScenarioTest):
    def dawdling(self, delay_us):
        self.assertTrue(PRELOAD.exists())
        return ["env", f"LD_PRELOAD={PRELOAD}", f"GRIDSPACE_TEST_DELAY_US={delay_us}"]

    def of_ticks(self, name, samples, prefix=()):
        return self.run_to_end(name, [*SHORT, "--set", f"clock.tick_samples={samples}"], CASE_2, OK, prefix)

    def test_auto_takes_the_loop_and_the_recording_is_that_of_every_other_tick(self):
        short = self.of_ticks("ticks_of_4", 4)
        auto = self.of_ticks("auto", "auto")
        self.assertEqual(auto.manifest()["clock"]["tick_s"], "1/600")  # eight samples: two hops of the loop
        self.assertIn("ticks differ", self.assert_identical(short, auto))
        opened = [e for e in auto.events() if e["event"] == "command" and e["text"] == "open"]
        self.assertEqual(len(opened), 1, "the fault must have been cleared, or nothing was compared")

    def test_processes_that_dawdle_at_random_change_no_bit(self):
        prompt = self.of_ticks("prompt", "auto")
        for samples in ("auto", 4):
            late = self.of_ticks(f"late_{samples}", samples, self.dawdling(800))
            self.assert_identical(prompt, late)

    def test_a_second_publisher_of_the_simulators_samples_is_as_early_with_every_tick(self):
        attack = SOURCE / "configs/scenarios/attack_line_currents.yaml"
        arguments = ["--until", "0.41", "--set", "processes.monitor=~", "--set", "expect=~", "--set", "record.comtrade=~"]
        runs = [self.run_to_end(f"ticks_of_{n}", [*arguments, "--set", f"clock.tick_samples={n}"], attack, OK) for n in (4, 8)]
        self.assert_identical(*runs)
        code, out, err = gridspace("wire", "stats", runs[0].folder / "bus.pcapng.gz", "--json")
        self.assertEqual(code, OK, err)
        twice, = [s["duplicates"] for s in json.loads(out)["streams"] if s["id"] == "GS_TL2_MU21"]
        self.assertGreaterEqual(twice, 40, "each sample from 0.4 s on has left the merging unit twice")

    def test_an_attack_that_waits_for_another_stream_begins_at_the_same_frame_with_every_tick(self):
        attacks = SOURCE / "tests/scenarios/attacks"
        beside = {"place": "second_publisher", "message": "{kind: masquerade_normal, interval_ms: 1}"}
        for name, changes, prefix in (("in_a_cable", {}, ()), ("beside", beside, ()), ("in_a_cable_late", {}, self.dawdling(800))):
            sets = [word for key, value in changes.items() for word in ("--set", f"attacks.forged.{key}={value}")]
            sets += ["--set", "hosts.evil.links=[process_bus]"] if changes else []
            arguments = ["--until", "0.15s", "--set", "processes.monitor=~", "--set", "expect=~", "--set", "simulation.sampling.samples_per_message=1", *sets]
            runs = [self.run_to_end(f"{name}_{n}", [*arguments, "--set", f"clock.tick_samples={n}"], attacks / "goose_grayhole_at_fault.yaml", OK, prefix)
                    for n in (1, "auto")]
            self.assert_identical(*runs)
            begins = [e["time_s"] for e in runs[0].events() if e["event"] == "forged.begins"]
            self.assertEqual(len(begins), 1, name)
            self.assertTrue(0.1 < begins[0] < 0.105, begins)  # the fault is at 0.1 s

    def test_over_dds_alone_the_recording_is_the_same_to_the_last_acknowledgement(self):
        with_memory = self.of_ticks("with", "auto")
        for name, prefix in (("without", ()), ("without_and_late", self.dawdling(800))):
            over_dds = self.run_to_end(name, [*SHORT, "--set", "clock.shared_memory=false"], CASE_2, OK, prefix)
            self.assertNotIn("left out", self.assert_identical(with_memory, over_dds))

    def test_a_tick_longer_than_the_loop_is_refused_hop_by_hop(self):
        code, _, err = gridspace("validate", CASE_2, "--set", "clock.tick_samples=10")
        self.assertEqual(code, USAGE)
        self.assertIn("process 'breaker2' acts on the simulator 2011.2 us after its input (relay2 900 us, then breaker2 1111.2 us), and a tick is 2083.33", err)


if __name__ == "__main__":
    unittest.main(verbosity=2)
