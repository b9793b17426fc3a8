# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run of many hosts starts whatever the kernel's table of neighbours holds, and without asking everybody for everything."""
import os
import pathlib
import sys
import time
import unittest

from harness import ScenarioTest, processes_of_session
from many_hosts import write_case

HOSTS = 40  # nearly twice as many as gc_thresh3 = 1024, which is usual, let start by ARP
LISTENER = pathlib.Path(__file__).with_name("arp_listener.py")


def datagrams_sent(run):
    """UDP datagrams that left the hosts of a run."""
    by_network = {}
    for pid, name in processes_of_session(run.pid).items():
        if name in ("gridspace", "gridspace-run"):
            continue
        keys, values = [line.split()[1:] for line in pathlib.Path(f"/proc/{pid}/net/snmp").read_text().splitlines()
                        if line.startswith("Udp:")]
        by_network[os.readlink(f"/proc/{pid}/ns/net")] = int(dict(zip(keys, values))["OutDatagrams"])
    return sum(by_network.values())


class ManyHosts(ScenarioTest):
    def test_forty_hosts_start_with_a_small_table_of_neighbours_and_few_datagrams_and_without_arp(self):
        scenario = write_case(self.folder, HOSTS, duration_s=8)
        listen = f"processes.listener={{program: exec, host: h0, command: [{sys.executable}, {LISTENER}]}}"
        run = self.start("run", ["--speed", "4", "--set", listen], scenario)
        began = time.monotonic()
        run.wait_for(lambda line: "are ready" in line.get("note", ""), "ready")
        seconds, sent = time.monotonic() - began, datagrams_sent(run)
        self.assertEqual(run.finish(), 0, run.stderr())
        self.assertEqual(run.left_over(), {})
        self.assertEqual((run.folder / "logs/listener.log").read_text(), "listening\n", "no ARP")
        # 28,000 to 30,000 in 3 to 4 s beside a load of 20; when discovery's heartbeats went to all of them 41,000 in 6 s and 212,000 in 32 s.
        # By multicast each of n answers each discovery to all n: 1,600,000 in 70 s.
        self.assertLess(sent, 700 * (HOSTS + 3) + 2000 * seconds)


if __name__ == "__main__":
    unittest.main()
