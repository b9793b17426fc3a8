#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""DDS programs that know nothing of lockstep: one takes part in case 1 by way of the door, two talk to each other over a link; runs repeat."""
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "scenario"))
from harness import BASE, OK, SOURCE, USAGE, ScenarioTest, busy_loops, gridspace

EXAMPLE = SOURCE / "examples/agents/dds_charger"
SCENARIO = EXAMPLE / "ev_charging_dds.yaml"
SHORT = [*BASE, "--until", "2400s", "--set", "expect=~"]
AMPERES, PACK_V, PACK_KWH, START_PERCENT = 8, 360, 24, 30
ALLOWED = 0.75  # curtail_factor: below full_above_pu
LAG_S = 1  # of the charger
PERIOD_S = 360

PING_PONG = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection_lockstep.yaml
name: ping_pong
simulation: {{duration_s: 1.5}}
clock: {{tick_samples: 1}}
events: ~
record: {{comtrade: ~}}
expect: ~
report: ~
links: {{lan: {{ipv4: 10.30.0.0/24}}}}
hosts: {{h1: {{links: [lan]}}, h2: {{links: [lan]}}}}
processes:
  recorder: {{capture: [lan]}}
  monitor: ~
  relay2: ~
  breaker2: ~
  ping: {{program: exec, host: h1, time: simulated, command: [env, "CYCLONEDDS_URI=<General><Interfaces><NetworkInterface address='10.30.0.1'/></Interfaces></General>", ddsperf, -D, '1.2', ping], sends: [ip], latency_us: 250}}
  pong: {{program: exec, host: h2, time: simulated, command: [env, "CYCLONEDDS_URI=<General><Interfaces><NetworkInterface address='10.30.0.2'/></Interfaces></General>", ddsperf, -D, '1.2', pong], sends: [ip], latency_us: 250}}
"""


class Dds(ScenarioTest):
    def build_charger(self):
        self.charger = self.cmake_build(EXAMPLE) / "charger"

    def command(self, amperes=AMPERES, until_percent=45):
        return ["--set", f"processes.ev4.command=[{self.charger}, EV4, '{amperes}', '{until_percent}', '{PERIOD_S}']"]

    def column(self, run, signal):
        """[(time, value)] of a recorded signal."""
        code, out, err = gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, OK, err)
        for table in map(pathlib.Path, out.split()):
            header, *rows = table.read_text().splitlines()
            if signal in header.split(","):
                at = header.split(",").index(signal)
                cells = [row.split(",") for row in rows]
                return [(float(c[0]), float(c[at])) for c in cells if c[at]]
        self.fail(f"no '{signal}' in {out}")

    def logged(self, run, name):
        return (run.folder / "logs" / f"{name}.log").read_text().splitlines()

    def asked(self, run):
        """[(time, percent, amperes)] as the program itself says."""
        lines = [re.match(r"(\S+) s: (\S+) %, asks for (\S+) A", line) for line in self.logged(run, "ev4")]
        return [tuple(map(float, m.groups())) for m in lines if m]

    def test_a_program_that_knows_nothing_of_lockstep_charges_a_vehicle_of_case_1_the_same_each_time(self):
        self.build_charger()
        run, again = (self.run_to_end(name, [*SHORT, *self.command()], SCENARIO) for name in ("first", "second"))
        with busy_loops():
            loaded = self.run_to_end("loaded", [*SHORT, *self.command()], SCENARIO)
        for other in (again, loaded):
            self.assert_identical(run, other)
            self.assertEqual(self.asked(run), self.asked(other))

        with self.subTest("it asks by its own clock, from the first measurement that it has got"):
            asked = self.asked(run)
            self.assertEqual(len(asked), 7)
            first_s = asked[0][0]
            self.assertLess(first_s, 5)
            for k, (time_s, _, amperes) in enumerate(asked):
                self.assertAlmostEqual(time_s, first_s + k * PERIOD_S, delta=1e-3)
                self.assertEqual(amperes, AMPERES)

        with self.subTest("the vehicle is charged with three quarters of that, as the controller's rules say: I x U x t"):
            reference = self.column(run, "ev.EV4.reference_a")
            begins_s = next(t for t, value in reference if value > 0)
            self.assertLess(begins_s - asked[0][0], 5, "a request and a decision take a second of the grid each")
            self.assertEqual({value for t, value in reference if t >= begins_s}, {ALLOWED * AMPERES})
            end_s, percent = self.column(run, "ev.EV4.soc_percent")[-1]
            gained = ALLOWED * AMPERES * PACK_V / (PACK_KWH * 1000) * 100 * (end_s - begins_s - LAG_S) / 3600
            self.assertAlmostEqual(percent, START_PERCENT + gained, delta=0.003)
            self.assertGreater(percent, START_PERCENT + 5)

        with self.subTest("negative control: without what it says the vehicle is not charged, and another wish is another run"):
            silent = self.run_to_end("silent", [*SHORT, "--set", "processes.ev4.command=[sleep, '9999']"], SCENARIO)
            self.assertEqual({value for _, value in self.column(silent, "ev.EV4.current_a")}, {0.0})
            self.assertEqual({round(value, 6) for _, value in self.column(silent, "ev.EV4.soc_percent")}, {START_PERCENT})
            other = self.run_to_end("other", [*SHORT, *self.command(amperes=7)], SCENARIO)
            self.assertNotEqual(self.compare(run, other)[0], OK)

    def test_what_it_wrote_is_counted_in_its_ledger_and_told(self):
        self.build_charger()
        run = self.run_to_end("run", [*BASE, "--until", "400s", "--set", "expect=~", *self.command()], SCENARIO)
        told = {e["source"]: e["text"] for e in run.events() if e["event"] == "topics"}
        given, taken = map(int, re.match(r"(\d+) samples given to the program, (\d+) taken from it$", told["ev4"]).groups())
        self.assertEqual(taken, 2)
        self.assertEqual(given, 4 * 401, "every bus at every step and at the start")
        samples = {t["name"]: t["samples"] for t in run.summary()["topics"]}
        self.assertEqual(samples["requests"], 3 * 2 + taken)

    def test_a_type_that_is_not_the_scenarios_is_named(self):
        self.build_charger()
        generated = self.folder / "build/ev_charging.c"
        text = generated.read_text()
        self.assertIn('"ChargingRequest"', text)
        generated.write_text(text.replace('"ChargingRequest"', '"OtherRequest"'))
        subprocess.run(["cmake", "--build", self.folder / "build"], capture_output=True, check=True)
        run = self.run_to_end("run", [*BASE, "--until", "20s", "--set", "expect=~", *self.command()], SCENARIO)
        self.assertEqual(len(self.asked(run)), 1)
        self.assertRegex({e["source"]: e["text"] for e in run.events() if e["event"] == "topics"}["ev4"], ", 0 taken from it$")
        self.assertRegex("\n".join(self.logged(run, "ev4")), "the program writes 'requests' as OtherRequest with a key, and the scenario says ChargingRequest with a key")

    def test_validate_says_what_is_wrong_with_topics(self):
        def mistakes(*changes):
            code, out, err = gridspace("validate", SCENARIO, *[word for change in changes for word in ("--set", change)])
            return code, out + err

        self.assertEqual(mistakes()[0], OK, mistakes()[1])
        code, said = mistakes("processes.ev4.reads={bus_measurment: {type: BusMeasurement}}")
        self.assertEqual(code, USAGE, said)
        self.assertIn("process 'ev4' reads the topic 'bus_measurment', which nobody writes", said)
        self.assertIn("bus_measurements", said)
        code, said = mistakes("processes.ev4.reads={bus_measurements: {type: BatteryMeasurement}}")
        self.assertEqual(code, USAGE, said)
        self.assertIn("reads 'bus_measurements' as BatteryMeasurement", said)
        code, said = mistakes("processes.ev4.writes={requests: {type: ChargingRequst}}")
        self.assertEqual(code, USAGE, said)
        self.assertIn("ChargingRequest", said)
        code, said = mistakes("processes.ev4.sends=[ip]")
        self.assertEqual(code, USAGE, said)
        self.assertIn("exchanges topics and IP at once", said)
        code, said = mistakes("processes.ev4.reads={decisions: {type: ChargingDecision}}")
        self.assertEqual(code, USAGE, said)
        self.assertRegex(said, "circle: (ev4 -> mcca -> ev4|mcca -> ev4 -> mcca)")

    @unittest.skipUnless(shutil.which("ddsperf"), "Debian's cyclonedds-tools are not there")
    def test_two_dds_programs_of_different_hosts_repeat_with_a_seed_and_differ_with_another(self):
        scenario = self.write("ping_pong.yaml", PING_PONG)
        run, again = (self.run_to_end(name, scenario=scenario) for name in ("first", "second"))
        with busy_loops():
            loaded = self.run_to_end("loaded", ["--set", "clock.member_timeout_s=60"], scenario=scenario)
        for other in (again, loaded):
            self.assert_identical(run, other)
        rtps = subprocess.run(["tshark", "-r", run.folder / "bus.pcapng.gz", "-Y", "rtps.sm.id == 0x15"], capture_output=True, text=True, check=True)
        self.assertGreater(len(rtps.stdout.splitlines()), 500, "they do talk")
        seeded = self.run_to_end("seeded", ["--set", "seed=2"], scenario=scenario)
        self.assertNotEqual((run.folder / "bus.pcapng.gz").read_bytes(), (seeded.folder / "bus.pcapng.gz").read_bytes())
        self.assertNotEqual(self.compare(run, seeded)[0], OK, "their GUIDs come from the seed")


if __name__ == "__main__":
    unittest.main()
