#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What is refused before anything starts, and that it is said in the words of whoever asked."""
import json
import struct
import unittest

from harness import CASE_1, SOURCE, USAGE, ScenarioTest, gridspace

NETWORK = SOURCE / "configs/networks/ev_microgrid.yaml"
STUDY = SOURCE / "configs/studies/ev_requested_times.yaml"
PROTECTION = SOURCE / "configs/scenarios/protection.yaml"


def empty_recording():
    """An MCAP file with everything but samples."""
    def record(op, body):
        return struct.pack("<BQ", op, len(body)) + body
    magic = b"\x89MCAP0\r\n"
    return magic + record(0x01, bytes(8)) + record(0x0F, bytes(4)) + record(0x02, bytes(20)) + magic


class Refusals(ScenarioTest):
    def refused(self, *words):
        code, out, err = gridspace(*words)
        self.assertEqual(code, USAGE, (words, out, err))
        return err

    def test_a_network_is_no_scenario_and_a_scenario_no_network(self):
        err = self.refused("run", NETWORK)
        self.assertIn("this is a network file, and a scenario is expected", err)
        self.assertIn("gridspace powerflow", err)
        self.assertIn("1 error.", err)
        err = self.refused("powerflow", CASE_1)
        self.assertIn("this is a scenario file, and a network is expected", err)
        self.assertIn("1 error.", err)
        err = self.refused("run", STUDY)
        self.assertIn("this is a study file, and a scenario is expected", err)
        self.assertIn("gridspace sweep", err)
        self.assertIn("1 error.", err)

    def test_a_number_that_cannot_be_is_named_with_what_was_expected(self):
        for words, expected in ((("compare", "a", "b", "--tolerance", "-1"), "'-1' is not a number from 0 on"),
                                (("compare", "a", "b", "--tolerance", "nan"), "'nan' is not a number from 0 on"),
                                (("simulate", NETWORK, "--every", "0"), "'0' is not a number above 0")):
            self.assertIn(expected, self.refused(*words))

    def test_a_step_that_the_network_decides_is_for_waveforms(self):
        self.assertIn("phasors have no step that would have to resolve", self.refused("validate", CASE_1, "--set", "simulation.step_s=auto"))
        self.assertIn("or auto", self.refused("validate", PROTECTION, "--set", "simulation.step_s=autp"))

    def test_a_step_that_is_too_long_for_what_rings_is_warned_of_at_its_place(self):
        banks = "{X: {bus: B1, q_kvar: 2, rated_kv: 0.208}, Y: {bus: B2, q_kvar: 2, rated_kv: 0.208}}"
        code, out, err = gridspace("validate", PROTECTION, "--set", f"simulation.network_changes={{shunt_capacitors: {banks}}}")
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"protection.yaml:11:\d+: warning: steps of 20.8 us are too long .* line 'TIE12', shunt capacitor 'X', shunt capacitor 'Y'")
        code, out, err = gridspace("validate", PROTECTION)
        self.assertNotIn("warning", err, "negative control")

    def test_a_run_that_is_not_there_is_called_that(self):
        missing = self.folder / "nolatest"
        self.assertIn(f"there is no '{missing}'", self.refused("export", missing, "--csv"))
        self.assertFalse(missing.exists(), "and it does not come to be by that")

    def test_two_runs_that_recorded_nothing_are_not_called_identical(self):
        for name in ("a", "b"):
            (self.folder / name).mkdir()
            (self.folder / name / "manifest.json").write_text(json.dumps({"clock": {"mode": "lockstep", "tick_s": "1"}}))
            (self.folder / name / "data.mcap").write_bytes(empty_recording())
        self.assertIn("neither run has recorded anything", self.refused("compare", self.folder / "a", self.folder / "b"))

    def test_raw_frames_without_namespaces_are_refused_also_by_a_dry_run(self):
        self.assertIn("raw frames", self.refused("run", PROTECTION, "--no-namespaces", "--dry-run"))

    def test_more_signals_than_fit_into_a_sample_are_found_before_the_run(self):
        loads = "".join(f"  X{i}: {{bus: B1, p_kw: 0.001}}\n" for i in range(520))
        network = self.write("network.yaml", f"extends: {NETWORK}\nloads:\n{loads}")
        err = self.refused("validate", self.write("scenario.yaml", f"extends: {CASE_1}\nsimulation: {{network: {network}}}\n"))
        self.assertIn("signals in group 'electrical', and 1024 fit", err)
        self.assertRegex(err, r"record\.signals, for example \[.*load\.\*: \d+")

    def test_patterns_that_match_no_signal_are_warned_of(self):
        wrong = self.write("scenario.yaml", f"extends: {CASE_1}\nrecord: {{signals: [EV1.soc_percent]}}\nfigures: ~\nexpect: ~\n")
        code, _, err = gridspace("validate", wrong)
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"none of its signals is one of record\.signals \(EV1\.soc_percent\)")


if __name__ == "__main__":
    unittest.main()
