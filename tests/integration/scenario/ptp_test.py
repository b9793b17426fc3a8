# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""smpSynch behind a PTP clock: linuxptp's ptp4l on virtual cables, its grandmaster killed; what is on the wire as tshark sees it."""
import signal
import subprocess
import unittest

from harness import HANG_S, INTERRUPTED, SOURCE, ScenarioTest

SCENARIO = """---
gridspace: 1
extends: {source}/configs/scenarios/protection_ptp.yaml
name: ptp
simulation: {{duration_s: 300}}
processes: {{monitor: ~, mu21: {{ptp: {{within_us: 20000}}}}, mu22: {{ptp: {{within_us: 20000, {second}}}}}}}
clock: {{speed: 0.5, start_at: ~}}     # a busy machine keeps up
events: {{fault: ~, grandmaster_lost: ~, daemon_lost: {{at_s: {first}, kill: clock21}}, all_lost: {{at_s: {last}, kill: grandmaster}}}}
record: {{comtrade: ~}}
expect: ~
"""


class Ptp(ScenarioTest):
    def begin(self, second="holdover_s: 1", first=8, last=9):
        return self.start("run", scenario=self.write("ptp.yaml", SCENARIO.format(source=SOURCE, second=second, first=first, last=last)))

    def wait_for_clocks(self, run, **texts):
        """Until each of these merging units has said so of its clock, in whichever order."""
        missing = dict(texts)

        def complete(line):
            if line.get("event") == "clock" and missing.get(line["source"], "?") in line["text"]:
                del missing[line["source"]]
            return not missing

        run.wait_for(complete, f"the events {texts}")

    def stop(self, run):
        run.process.send_signal(signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())

    def synch_on_wire(self, run, app_id):
        """The values of smpSynch in the frames of a stream, each run of equal ones once."""
        said = subprocess.run(["tshark", "-r", run.folder / "bus.pcapng.gz", "-Y", f"sv.appid == {app_id}", "-T", "fields", "-e", "sv.smpSynch"],
                              capture_output=True, text=True, check=True, timeout=HANG_S)
        out = []
        for word in said.stdout.split():
            if out[-1:] != [int(word, 0)]:
                out.append(int(word, 0))
        return out

    def test_it_follows_the_grandmaster_and_is_lost_after_it(self):
        run = self.begin()
        self.wait_for_clocks(run, mu21="(class 6)", mu22="(class 6)")
        lost = "not synchronised any more: smpSynch is 0"
        self.wait_for_clocks(run, mu21=f"the PTP daemon does not answer, {lost}", mu22=lost)
        run.wait_for_time(run.latest_time(0) + 0.5)
        self.stop(run)
        for app_id in ("0x4021", "0x4022"):
            synch = self.synch_on_wire(run, app_id)
            self.assertEqual(synch[-2:], [2, 0], synch)
            self.assertEqual(set(synch), {0, 2})
        self.assertIn("from_synch", [e["text"] for e in run.events() if e["event"] == "block"][-1])

    def test_without_a_daemon_nothing_is_synchronised_and_the_relay_waits(self):
        run = self.begin("socket: nobody.ptp4l", 200, 201)
        self.wait_for_clocks(run, mu21="smpSynch is 2", mu22="the PTP daemon does not answer, not synchronised yet")
        run.wait_for_time(run.latest_time(0) + 1)
        self.stop(run)
        self.assertEqual(self.synch_on_wire(run, "0x4022"), [0])
        self.assertNotIn("unblock", [e["event"] for e in run.events() if e["source"] == "relay2"])


if __name__ == "__main__":
    unittest.main()
