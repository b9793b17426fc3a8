#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A router whose ends are in different network namespaces, between which there is no cable at all: topics of another make of DDS, named as
ROS 2 names them, and a run that a monitor outside of its namespaces looks at. Needs root, or a user namespace."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "scenario"))
sys.path.insert(0, str(HERE.parent / "monitor"))
from harness import BASE, BIN, ENVIRONMENT, HANG_S, OK, SOURCE, ScenarioTest, gridspace  # noqa: E402

INSIDE = "GRIDSPACE_NAMESPACES_TEST_INSIDE"
DOMAIN_OUTSIDE = 61


class Spoken:
    """A program whose lines are kept as they come."""

    def __init__(self, command):
        self.process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines, self.changed = [], threading.Condition()
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            with self.changed:
                self.lines.append(line.rstrip("\n"))
                self.changed.notify_all()

    def wait_for(self, condition, what):
        """Until `condition` holds for all that it has said so far; the lines."""
        with self.changed:
            if not self.changed.wait_for(lambda: condition(self.lines), HANG_S):
                raise AssertionError(f"waited {HANG_S} s for {what}; it said {self.lines[-20:]}")
            return list(self.lines)

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(HANG_S)
        self.reader.join(HANG_S)
        self.process.stdout.close()
        return code


class Namespaces(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.running = []
        self.addCleanup(lambda: [one.end() for one in reversed(self.running)])

    def launch(self, *command):
        self.running.append(Spoken(command))
        return self.running[-1]

    def other_namespace(self):
        """The process identifier of somebody in a network namespace with a loopback interface and nothing else."""
        there = subprocess.Popen(["unshare", "--net", "sleep", "infinity"])
        self.addCleanup(there.wait)
        self.addCleanup(there.kill)
        own, deadline = os.readlink("/proc/self/ns/net"), time.monotonic() + HANG_S
        while os.readlink(f"/proc/{there.pid}/ns/net") == own and time.monotonic() < deadline:
            time.sleep(0.01)
        subprocess.run(["nsenter", "-t", str(there.pid), "-n", "ip", "link", "set", "lo", "up", "multicast", "on"], check=True)
        return there.pid

    def router(self, content):
        return self.launch(BIN / "gridspace", "router", "--json", self.write("router.yaml", json.dumps(content)))

    def totals(self, router):
        self.assertEqual(router.end(), OK, router.lines)
        self.running.remove(router)
        events = [json.loads(line) for line in router.lines if line.startswith("{")]
        return {e["topic"]: e for e in events if e["event"] == "total"}

    def test_topics_of_another_dds_named_as_in_ros_2_pass_between_namespaces_without_a_cable(self):
        programs = self.folder / "programs"
        programs.mkdir()
        for command in (["idlc", "-l", "c", "-t", "-o", programs, HERE / "ros_style.idl"],
                        ["gcc", "-Wall", "-Wextra", "-I", programs, "-o", programs / "ros_style", HERE / "ros_style.c", programs / "ros_style.c", "-lddsc"]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        there = self.other_namespace()
        inside = ["nsenter", "-t", there, "-n"]
        router = self.router({
            "router": "bridge",
            "ends": {"here": {"domain": 0, "addresses": ["127.0.0.1"]},
                     "there": {"domain": 0, "addresses": ["127.0.0.1"], "network_namespace": f"/proc/{there}/ns/net"}},
            "topics": {"chatter": {"topic": "rt/robot/chatter", "from": ["here"], "depth": 1000}, "answer": {"topic": "rt/answer", "depth": 1000}}})
        listener = self.launch(*inside, programs / "ros_style", "listen", 0, "rt/robot/chatter", "rt/secret")
        back = self.launch(programs / "ros_style", "listen", 0, "rt/answer")
        self.launch(programs / "ros_style", "talk", 0, "rt/robot/chatter", "rt/secret")
        self.launch(*inside, programs / "ros_style", "talk", 0, "rt/answer", "rt/robot/chatter_of_there")
        for program, topic in ((listener, "rt/robot/chatter"), (back, "rt/answer")):
            heard = program.wait_for(lambda lines: len(lines) >= 50, f"50 samples of {topic}")
            first = int(heard[0].split()[1])
            self.assertEqual(heard, [f"{topic} {first + i}" for i in range(len(heard))])  # in order, and none is missing: nor did a secret come
        totals = self.totals(router)
        self.assertEqual(set(totals), {"rt/robot/chatter", "rt/answer"})
        for total in totals.values():
            self.assertGreaterEqual(total["samples"], 50)
            self.assertEqual((total["refused"], total["dropped"]), (0, 0), total)

    def test_a_monitor_outside_looks_at_a_run_inside_its_namespaces(self):
        import client
        run = self.start("run", [*BASE, "--speed", "60"])
        run.wait_for(lambda line: line.get("note", "").startswith("all "), "everybody to be ready")
        simulator = run.pid_of("sim")
        self.assertNotEqual(os.readlink(f"/proc/{simulator}/ns/net"), os.readlink("/proc/self/ns/net"))
        environment = dict(word.split("=", 1) for word in pathlib.Path(f"/proc/{simulator}/environ").read_text().split("\0") if "=" in word)
        router = self.router({
            "router": "window",
            "ends": {"run": {"domain": int(environment["GRIDSPACE_MANAGEMENT_DOMAIN"]), "addresses": [environment["GRIDSPACE_MANAGEMENT_ADDRESS"]],
                             "network_namespace": f"/proc/{simulator}/ns/net"},
                     "outside": {"domain": DOMAIN_OUTSIDE, "addresses": ["127.0.0.1"]}},
            "topics": {"simulation_clock": {"from": ["run"]}, "signals": {"from": ["run"]}, "signal_catalog": {"from": ["run"]}}})
        monitor = self.launch(BIN / "gridspace-monitor", "--config", self.write("monitor.yaml", json.dumps({
            "process": "monitor", "program": "gridspace-monitor",
            "bus": {"qos": str(SOURCE / "qos/monitor.xml"), "management": {"domain": DOMAIN_OUTSIDE, "addresses": ["127.0.0.1"]}},
            "settings": {"listen": "127.0.0.1:0"}})))
        said = monitor.wait_for(lambda lines: any("http://" in line for line in lines), "the monitor's address")
        outside = client.Monitor(next(word for line in said for word in line.split() if word.startswith("http://")))
        first = outside.until("/api/v1/run", lambda r: r["time_s"] > 0, "simulated time outside")["time_s"]
        outside.until("/api/v1/run", lambda r: r["time_s"] > first, "time to pass")
        outside.until("/api/v1/signals", lambda s: "bus.B1.v_pu" in [e["name"] for e in s["signals"]], "signals outside")
        topics = {t["name"] for t in outside.json("/api/v1/topics")["topics"] if t["samples"]}
        self.assertNotIn("clock_ack", topics)  # the negative control: it is on no list
        run.process.send_signal(signal.SIGINT)
        run.finish()
        self.assertGreater(self.totals(router)["simulation_clock"]["samples"], 0)

    def test_a_namespace_that_is_none_is_named(self):
        config = {"router": "r", "ends": {"a": {"domain": 1}, "b": {"domain": 1, "network_namespace": "/dev/null"}}, "topics": {"x": {}}}
        code, _, err = gridspace("router", self.write("router.yaml", json.dumps(config)))
        self.assertEqual(code, ENVIRONMENT)
        self.assertIn("/dev/null", err)


if __name__ == "__main__":
    if os.environ.get(INSIDE) is None:
        kind = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
        script = f'ip link set lo up multicast on && exec "{sys.executable}" "$@"'
        os.execvpe("unshare", [*kind, "sh", "-c", script, "sh", *sys.argv], {**os.environ, INSIDE: "1"})
    unittest.main()
