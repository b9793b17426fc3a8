#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case study 1 on two sites: the grid, its controller and three agents here, the agent of EV4 there. The sites are network namespaces
with a point-to-point cable between them, over which no multicast goes; DDS is on each site's loopback interface alone."""
import contextlib
import json
import os
import pathlib
import queue
import signal
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BIN, HANG_S, OK, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

INSIDE = "GRIDSPACE_TWO_SITES_INSIDE"
HERE, THERE = "10.9.0.1", "10.9.0.2"
DOMAIN_THERE = 9
EPOCH = "2019-12-01T09:00:00Z"
# Half an hour of case 1, slowly enough that a busy machine answers within the controller's patience.
SPEED, UNTIL_S = 120, 1800
SOC_AT_START = 30.0


class Lines:
    """A process whose JSON lines are read as they come."""

    def __init__(self, command):
        self.process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.seen, self.errors, self.queue = [], [], queue.Queue()
        self.readers = [threading.Thread(target=self._read, daemon=True), threading.Thread(target=self._errors, daemon=True)]
        for reader in self.readers:
            reader.start()

    def _read(self):
        for line in self.process.stdout:
            with contextlib.suppress(ValueError):
                self.queue.put(json.loads(line))
        self.queue.put(None)

    def _errors(self):
        self.errors += self.process.stderr.readlines()

    def wait_for(self, **wanted):
        """The next event that has all these members."""
        deadline = time.monotonic() + HANG_S
        while (left := deadline - time.monotonic()) > 0:
            with contextlib.suppress(queue.Empty):
                event = self.queue.get(timeout=left)
                if event is None:
                    break
                self.seen.append(event)
                if all(event.get(k) == v for k, v in wanted.items()):
                    return event
        raise AssertionError(f"{wanted} did not come; {self.seen} {''.join(self.errors)}")

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(HANG_S)
        for reader in self.readers:
            reader.join(HANG_S)
        while not self.queue.empty():
            if (event := self.queue.get()) is not None:
                self.seen.append(event)
        return code


class TwoSites(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.running = []
        self.there = subprocess.Popen(["unshare", "--net", "sleep", "infinity"])
        own = os.readlink("/proc/self/ns/net")
        deadline = time.monotonic() + HANG_S
        while os.readlink(f"/proc/{self.there.pid}/ns/net") == own and time.monotonic() < deadline:
            time.sleep(0.01)
        self.ip("link set lo up")
        self.ip("link add here type veth peer name there")
        self.ip(f"link set there netns {self.there.pid}")
        for name, address, run in (("here", HERE, self.ip), ("there", THERE, self.ip_there)):
            run(f"link set {name} multicast off")
            run(f"addr add {address}/30 dev {name}")
            run(f"link set {name} up")
        self.ip_there("link set lo up")

    def tearDown(self):
        for one in self.running:
            if one.process.poll() is None:
                one.process.kill()
            one.process.wait()
            for reader in one.readers:
                reader.join(HANG_S)
            one.process.stdout.close()
            one.process.stderr.close()
        self.there.kill()
        self.there.wait()
        subprocess.run(["ip", "link", "del", "here"], check=False, capture_output=True)
        super().tearDown()

    def ip(self, words):
        subprocess.run(["ip", *words.split()], check=True)

    def ip_there(self, words):
        subprocess.run([*self.on_the_other_site(), "ip", *words.split()], check=True)

    def on_the_other_site(self):
        return ["nsenter", "-t", str(self.there.pid), "-n"]

    def launch(self, command):
        out = Lines(command)
        self.running.append(out)
        return out

    def json_file(self, name, content):
        return self.write(name, json.dumps(content))

    def scenario(self, router_config, until_requests=False, **changes):
        """Case 1 in which a router stands in for the agent of EV4; begun, if wanted, when that agent's requests have come through it:
        in real time the run would not wait for an agent that it does not know."""
        ev4 = {"program": "exec", "qos": None, "ev": None, "requested_h": None, "command": [str(BIN / "gridspace"), "router", "--json", str(router_config)],
               "reads": {"bus_measurements": {"type": "BusMeasurement"}}, "writes": {"requests": {"type": "ChargingRequest"}}}
        if until_requests:
            ev4["ready"] = {"says": '"topic":"requests"', "within_s": HANG_S / 2}
        return self.json_file("split.yaml", {
            "extends": str(SOURCE / "configs/scenarios/ev_charging.yaml"), "name": "ev_charging_split",
            "clock": {"mode": "realtime", "speed": SPEED, "start_timeout_s": 120},
            "processes": {"ev4": ev4, "monitor": None, "mcca": {"request_timeout_s": 600}}, "expect": None, **changes})

    def tls(self, name):
        """The files of a site, as docs/how_to/connect_two_sites.md makes them."""
        def openssl(*words):
            subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)
        ca, ca_key, cert, key, request = (self.folder / n for n in ("ca.pem", "ca.key", f"{name}.pem", f"{name}.key", f"{name}.csr"))
        new_key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes")
        if not ca.exists():
            openssl("req", "-x509", *new_key, "-days", 2, "-subj", "/CN=ca", "-keyout", ca_key, "-out", ca)
        openssl("req", *new_key, "-subj", f"/CN={name}", "-keyout", key, "-out", request)
        openssl("x509", "-req", "-days", 2, "-in", request, "-CA", ca, "-CAkey", ca_key, "-CAcreateserial", "-out", cert)
        return {"certificate": str(cert), "private_key": str(key), "authority": str(ca)}

    def listening(self):
        return {"listen": 7411, "tls": self.tls("here")}

    def connecting(self):
        return {"connect": f"{HERE}:7411", "tls": self.tls("there")}

    def router_here(self, wan, topics=("requests",)):
        carried = {"simulation_clock": {"from": ["management"], "to": ["wan"]}, "bus_measurements": {"from": ["data"], "to": ["wan"]}}
        carried.update({topic: {"from": ["wan"], "to": ["data"]} for topic in topics})
        return self.json_file("here.yaml", {"router": "ev4", "ends": {"management": {"run": "management"}, "data": {"run": "data"}, "wan": wan}, "topics": carried})

    def router_there(self, wan=None):
        wan = wan or self.connecting()
        return self.json_file("there.yaml", {
            "router": "sim", "ends": {"site": {"domain": DOMAIN_THERE, "addresses": ["127.0.0.1"]}, "wan": wan},
            "topics": {"simulation_clock": {"from": ["wan"]}, "bus_measurements": {"from": ["wan"]}, "requests": {"from": ["site"]}}})

    def agent(self, bus, clock_from="sim"):
        """gridspace-ev of EV4, alone on the other site; it hears the clock from a process, or router, of that name."""
        clock = {"mode": "realtime", "quantum_s": 1, "tick_s": 1, "epoch": EPOCH, "simulator": clock_from, "start_timeout_s": 0}
        config = self.json_file("agent.yaml", {
            "process": "car4", "program": "gridspace-ev", "bus": {"qos": str(SOURCE / "qos/ev_agent.xml"), "clock": clock, **bus},
            "settings": {"ev": "EV4", "bus": "B4", "capacity_kwh": 24, "requested_h": 5, "period_s": 360, "soc_target_percent": 80,
                         "rated_current_a": 15, "battery_v": 360, "time_base": "remaining", "min_remaining_h": 0.1}})
        return self.launch([*self.on_the_other_site(), BIN / "gridspace-ev", "--config", config])

    def run_here(self, scenario):
        return self.start("run", ["--no-namespaces", "--until", str(UNTIL_S)], scenario)

    def soc_of_ev4(self, run):
        code, out, err = gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, OK, err)
        for file in (run.folder / "csv").glob("signals*.csv"):
            head, *rows = file.read_text().splitlines()
            names = head.split(",")
            column = next((i for i, name in enumerate(names) if name.startswith("ev.EV4.soc") or name.startswith("ev_EV4_soc")), None)
            if column is not None:
                return [float(row.split(",")[column]) for row in rows if row.split(",")[column]]
        raise AssertionError(f"no state of charge of EV4 in {out}")

    def whole(self):
        """What the whole of case 1 does in lockstep, on one site."""
        return self.run_to_end("whole", ["--set", "processes.monitor=~", "--set", "expect=~", "--until", str(UNTIL_S)])

    def assert_charged_as_in_one_piece(self, run):
        expected, got = self.soc_of_ev4(self.whole())[-1], self.soc_of_ev4(run)[-1]
        self.assertGreater(expected, SOC_AT_START + 3)
        # The run begins when the other site's writer is there, and the first request comes up to two seconds later; and a process may
        # not be scheduled for three: ten simulated minutes.
        self.assertAlmostEqual(got, expected, delta=2.2)

    def test_a_scenario_split_over_two_sites_charges_as_in_one_piece(self):
        there = self.launch([*self.on_the_other_site(), BIN / "gridspace", "router", "--json", self.router_there()])
        agent = self.agent({"management": {"domain": DOMAIN_THERE, "addresses": ["127.0.0.1"]}})
        run = self.run_here(self.scenario(self.router_here(self.listening())))
        self.assertEqual(run.finish(), OK, run.stderr())
        self.assertEqual(agent.process.wait(HANG_S), OK, "".join(agent.errors))  # the last clock sample has reached it
        self.assertEqual(there.end(), OK, there.errors)
        self.assert_charged_as_in_one_piece(run)
        totals = {e["topic"]: e for e in there.seen if e["event"] == "total"}
        self.assertEqual(set(totals), {"simulation_clock", "bus_measurements", "requests"})
        for total in totals.values():
            self.assertGreaterEqual(total["samples"], 4, total)  # a request each six minutes
            self.assertEqual((total["refused"], total["dropped"]), (0, 0), total)

    def test_what_is_not_allowed_does_not_pass_and_the_car_stays_empty(self):
        """The negative control: the same two sites, but requests are on no list here."""
        there = self.launch([*self.on_the_other_site(), BIN / "gridspace", "router", "--json", self.router_there()])
        agent = self.agent({"management": {"domain": DOMAIN_THERE, "addresses": ["127.0.0.1"]}})
        scenario = self.scenario(self.router_here(self.listening(), topics=()))
        content = json.loads(scenario.read_text())
        content["processes"]["ev4"]["writes"] = {}  # or the run would wait for its writer
        scenario.write_text(json.dumps(content))
        run = self.run_here(scenario)
        self.assertEqual(run.finish(), OK, run.stderr())
        agent.process.wait(HANG_S)
        self.assertEqual(there.end(), OK, there.errors)
        self.assertEqual(set(self.soc_of_ev4(run)), {SOC_AT_START})
        totals = {e["topic"]: e["samples"] for e in there.seen if e["event"] == "total"}
        self.assertGreater(totals["bus_measurements"], 8)

    def test_a_site_that_dies_is_named_and_taken_up_again_and_so_is_a_cut_cable(self):
        here = self.launch([BIN / "gridspace", "router", "--json", self.json_file("a.yaml", {
            "router": "site_a", "ends": {"site": {"domain": 5, "addresses": ["127.0.0.1"]}, "wan": self.listening()}, "topics": {"x": {}}})])
        command = [*self.on_the_other_site(), BIN / "gridspace", "router", "--json", self.json_file("b.yaml", {
            "router": "site_b", "ends": {"site": {"domain": 5, "addresses": ["127.0.0.1"]}, "wan": self.connecting()}, "topics": {"x": {}}})]
        there = self.launch(command)
        here.wait_for(event="connected", end="wan", site="site_b")
        there.wait_for(event="connected", end="wan", site="site_a")
        there.process.kill()
        here.wait_for(event="lost", end="wan", site="site_b")
        there = self.launch(command)
        here.wait_for(event="connected", end="wan", site="site_b")
        there.wait_for(event="connected", end="wan", site="site_a")
        self.ip("link set here down")
        here.wait_for(event="lost", site="site_b")
        there.wait_for(event="lost", site="site_a")
        self.ip("link set here up")
        here.wait_for(event="connected", site="site_b")
        there.wait_for(event="connected", site="site_a")
        self.assertEqual(there.end(), OK)
        here.wait_for(event="left", site="site_b")
        self.assertEqual(here.end(), OK)

    def profile(self, name):
        """A profile of qos/ with the addresses of these sites."""
        text = (SOURCE / "qos" / name).read_text()
        self.assertIn("7411" if name.startswith("tcp") else "192.0.2.7", text)
        return self.write(name, text.replace("192.0.2.7", HERE))

    def test_an_agent_joins_over_tcp_without_a_router_of_its_own(self):
        """qos/tcp_server.xml and tcp_client.xml."""
        agent = self.agent({"qos": str(self.profile("tcp_client.xml")), "management": {"domain": 0}}, clock_from="ev4")
        run = self.run_here(self.scenario(self.router_here({"qos": str(self.profile("tcp_server.xml"))}), until_requests=True))
        self.assertEqual(run.finish(), OK, run.stderr())
        agent.process.wait(HANG_S)
        self.assert_charged_as_in_one_piece(run)

    def test_an_agent_joins_through_a_discovery_server(self):
        """qos/discovery_server.xml and discovery_client.xml: UDP without multicast."""
        agent = self.agent({"qos": str(self.profile("discovery_client.xml")), "management": {"domain": 0}}, clock_from="ev4")
        run = self.run_here(self.scenario(self.router_here({"qos": str(self.profile("discovery_server.xml")), "addresses": [HERE]}), until_requests=True))
        self.assertEqual(run.finish(), OK, run.stderr())
        agent.process.wait(HANG_S)
        self.assert_charged_as_in_one_piece(run)

    def test_mistakes_are_said_with_their_place(self):
        code, _, err = gridspace("router", self.write("wrong.yaml", "router: r\nends:\n  a: {domain: 1}\n  b: {lisen: 7411}\ntopics: {x: {from: [c]}}\n"))
        self.assertEqual(code, USAGE)
        self.assertIn("wrong.yaml:4:7", err)
        self.assertIn("did you mean 'listen'", err)
        self.assertIn("there is no end 'c'", err)
    def test_the_shipped_example_is_valid(self):
        example = SOURCE / "examples/two_sites"
        for name in ("here.yaml", "there.yaml"):
            code, out, err = gridspace("router", "--check", example / name)
            self.assertEqual((code, err), (OK, ""))
            self.assertIn("valid", out)
        self.assertEqual(gridspace("validate", example / "ev_charging_split.yaml")[0], OK)
        done = subprocess.run([BIN / "gridspace-ev", "--check", "--config", example / "agent.yaml"], capture_output=True, text=True, timeout=HANG_S)
        self.assertEqual(done.returncode, OK, done.stderr)


if __name__ == "__main__":
    if os.environ.get(INSIDE) is None:
        kind = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
        os.execvpe("unshare", [*kind, sys.executable, *sys.argv], {**os.environ, INSIDE: "1"})
    unittest.main()
