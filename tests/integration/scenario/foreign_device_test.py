# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Devices that are not ours in place of ours, and real interfaces, in real time. No expectation here is about how fast."""
import sys
import unittest

from harness import ENVIRONMENT, OK, SOURCE, USAGE, ScenarioTest, gridspace

EXAMPLES = SOURCE / "examples/agents/python_iec61850"
LEAN = ["--set", "processes.monitor=~"]

ON_A_REAL_INTERFACE = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection.yaml
name: real_interface
simulation: {{duration_s: 1}}
processes: {{monitor: ~, mu22: ~, relay2: ~, breaker2: ~, mu21: {{interface: outside}}}}
events: ~
record: {{comtrade: ~}}
expect: ~
"""

ATTACK_ON_A_REAL_INTERFACE = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection.yaml
name: real_attack
simulation: {{duration_s: 1}}
hosts: {{evil: {{links: []}}}}
processes: {{monitor: ~, attacker: {{program: gridspace-attacker, host: evil, interface: outside}}}}
attacks:
  trip: {{by: attacker, place: second_publisher, target: {{stream: TRIP2, channels: [status]}}, window: {{from_s: 0.2, until_s: 0.3}}, message: {{kind: masquerade_trip}}}}
events: ~
record: {{comtrade: ~}}
expect: ~
"""

# Counts frames of sampled values at the other end of the cable until 100 have come; the run is the words behind.
LISTEN = """
import socket, subprocess, sys
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x88ba))
port.bind(("beyond", 0x88ba))
port.settimeout(120)
run = subprocess.Popen(sys.argv[1:])
apps = {}
try:
    while sum(apps.values()) < 100:
        frame = port.recv(2048)
        apps[frame[14:16].hex()] = apps.get(frame[14:16].hex(), 0) + 1
finally:
    code = run.wait()
    print("heard", apps, flush=True)
sys.exit(code)
"""


OPENED = '"source":"breaker2","event":"command","text":"open"'


class ForeignDevice(ScenarioTest):
    def events_of(self, scenario, *arguments):
        """What happened. The exit code is not looked at: on a busy machine Python is late, and the recorder may miss something."""
        run = self.start("run", [*LEAN, *arguments], scenario=EXAMPLES / scenario)
        run.finish()
        self.assertEqual(run.left_over(), {})
        return run, (run.folder / "events.ndjson").read_text()

    def test_a_relay_written_in_python_protects_the_line(self):
        # Slower than real time: nobody waits for the relay, and it is to trip before the end even when it is not scheduled for some seconds.
        run, events = self.events_of("foreign_relay.yaml", "--set", "clock.speed=0.4", "--set", "clock.start_at=~")
        self.assertIn("trip at sample", (run.folder / "logs/python_relay.log").read_text(), run.stderr())
        self.assertIn(OPENED, events, run.stderr())
        self.assertLess(events.index('"text":"fault"'), events.index(OPENED))

    def test_without_that_relay_nobody_opens_the_breakers(self):
        run, events = self.events_of("foreign_relay.yaml", "--set", "processes.python_relay=~", "--until", "2s")
        self.assertIn('"text":"fault"', events, run.stderr())
        self.assertNotIn(OPENED, events)

    def test_merging_units_written_in_python_make_our_relay_trip(self):
        run, events = self.events_of("foreign_merging_units.yaml")
        self.assertIn(OPENED, events, run.stderr())


class RealInterface(ScenarioTest):
    def test_a_merging_unit_sends_on_an_interface_of_the_machine(self):
        """Root of a user namespace of its own, where a cable stands for the machine's interface."""
        cable = "ip link add outside type veth peer name beyond && ip link set beyond up && exec \"$@\""
        prefix = ["unshare", "-rn", "sh", "-c", cable, "sh", sys.executable, "-c", LISTEN]
        run = self.run_to_end("run", scenario=self.write("real.yaml", ON_A_REAL_INTERFACE), prefix=prefix)
        self.assertIn("heard {'4021': 100}", "".join(run.printed))

    def test_an_interface_that_is_not_there_is_named(self):
        prefix = ["unshare", "-rn"]
        run = self.run_to_end("run", scenario=self.write("real.yaml", ON_A_REAL_INTERFACE), prefix=prefix, code=ENVIRONMENT)
        self.assertIn("outside", run.stderr())

    def test_an_attacker_stays_off_a_real_interface_unless_that_is_meant(self):
        file = self.write("attack.yaml", ATTACK_ON_A_REAL_INTERFACE)
        for arguments in ([], ["--allow-attacks-on", "another0"]):
            code, _, said = gridspace("run", file, "--out", self.folder / "run", *arguments)
            self.assertEqual(code, USAGE, said)
            self.assertIn("'outside', which is not a virtual cable", said)
            self.assertIn("--allow-attacks-on outside", said)
            self.assertFalse((self.folder / "run").exists(), "nothing was started")
        code, _, said = gridspace("run", file, "--dry-run", "--allow-attacks-on", "outside")
        self.assertEqual(code, OK, said)

    def test_lockstep_refuses_a_real_interface(self):
        run = self.start("run", ["--set", "clock.mode=lockstep", "--set", "clock.speed=max", "--set", "clock.start_at=~"],
                         scenario=self.write("real.yaml", ON_A_REAL_INTERFACE))
        self.assertEqual(run.finish(), USAGE)
        self.assertIn("nobody can wait for a real network", run.stderr())


if __name__ == "__main__":
    unittest.main(verbosity=2)
