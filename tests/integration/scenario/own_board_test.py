# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A board that nobody starts for us (`run_on: external`): `gridspace-relay --config …` alone, on interfaces that are plugged into the
scenario's switches. The board is a network namespace that has what the README of its bundle asks for; needs root."""
import functools
import json
import os
import pathlib
import queue
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest

from harness import CHILD_DIED, HANG_S, INTERRUPTED, OK, SOURCE, STALL, ScenarioTest, gridspace

SHORT = SOURCE / "tests/scenarios/misbehaviour/base.yaml"
EXTERNAL = """---
gridspace: 1
extends: {base}
name: own_board
hosts: {{ied2: {{plugs: {{mgmt0: {{interface: to_board0}}, process_bus: {{interface: to_board1}}}}}}}}
processes: {{monitor: ~, relay2: {{run_on: external}}}}
"""
REAL_TIME = """---
gridspace: 1
extends: own_board.yaml
name: own_board_in_real_time
clock: {mode: realtime, speed: 0.25, start_at: ~}    # a quarter of real time: a busy machine keeps up
simulation: {duration_s: 5}
events: {fault: {at_s: 2.5}}
expect: {tl2_isolated: {within_ms: 2400}, trip_decided_ms: ~, smv_lost: ~}
"""


@unittest.skipUnless(os.geteuid() == 0, "needs root")
class OwnBoard(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.namespaces = []
        self.machine, self.board = self.namespace(), self.namespace()
        self.scenario = self.write("own_board.yaml", EXTERNAL.format(base=SHORT))
        self.real_time = self.write("real_time.yaml", REAL_TIME)
        self.devices = []
        self.addCleanup(self.end)

    def end(self):
        for process in self.devices + self.namespaces:
            process.kill()
            process.wait()

    def namespace(self):
        process = subprocess.Popen(["unshare", "-n", "-m", "sh", "-c", "echo; exec sleep 3600"], stdout=subprocess.PIPE)
        process.stdout.readline()  # it is in its namespaces
        process.stdout.close()
        self.namespaces.append(process)
        return process.pid

    def within(self, pid, command):
        subprocess.run(["nsenter", "-t", str(pid), "-n", "-m", "sh", "-ec", command], check=True, timeout=60)

    @functools.cache
    def bundle_of(name, text):
        """The bundle of the relay in that scenario, once for all tests."""
        folder = pathlib.Path(tempfile.mkdtemp())
        unittest.addModuleCleanup(shutil.rmtree, folder)
        (folder / "own_board.yaml").write_text(EXTERNAL.format(base=SHORT))
        (folder / name).write_text(text)
        code, _, err = gridspace("bundle", folder / name, "relay2", "--arch", "amd64", "--out", folder)
        if code != OK:
            raise AssertionError(err)
        return folder / "gridspace-relay2_amd64.tar.gz"

    def install(self, scenario):
        """The bundle, and the interfaces that its README lists, each with a cable to the launcher's machine."""
        archive = OwnBoard.bundle_of(scenario.name, scenario.read_text())
        self.within(self.board, f"mount -t tmpfs none /srv && tar -C /srv -xf {archive}")
        readme = tarfile.open(archive).extractfile("gridspace-relay2/README").read().decode()
        listed = [line.split() for line in readme.splitlines() if line.startswith("    ") and line.split()[1:2] and ":" in line.split()[1]]
        self.assertEqual([name for name, _, _ in listed], ["mgmt0", "process_bus"])
        for n, (name, mac, address) in enumerate(listed):
            self.within(self.machine, f"ip link add to_board{n} type veth peer name {name} netns {self.board}; ip link set to_board{n} up")
            self.within(self.board, f"sysctl -qw net.ipv6.conf.{name}.disable_ipv6=1; ip link set {name} address {mac} up" +
                        ("" if address == "-" else f"; ip addr add {address} dev {name}"))

    def switch_on(self):
        """Starts the relay, as its service would."""
        log = open(self.folder / "relay.log", "a")
        process = subprocess.Popen(["nsenter", "-t", str(self.board), "-n", "-m", "sh", "/srv/gridspace-relay2/start"],
                                   stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        log.close()
        self.devices.append(process)
        return process

    def run_with_board(self, name, scenario, arguments=()):
        return self.start(name, arguments, scenario, ["nsenter", "-t", str(self.machine), "-n"])

    def log(self):
        return (self.folder / "relay.log").read_text()

    def test_it_may_be_there_first_and_decides_what_a_native_relay_decides(self):
        self.install(self.scenario)
        relay = self.switch_on()
        native = self.run_to_end("native", scenario=SHORT)
        self.assertIsNone(relay.poll(), self.log())  # it has waited all that time
        run = self.run_with_board("board", self.scenario)
        self.assertEqual(run.finish(), OK, run.stderr() + self.log())
        self.assertIn("relay2: is to be started by somebody else", run.stderr())
        self.assertEqual(relay.wait(60), OK, self.log())
        self.assert_identical(native, run)

    def start_late(self, *arguments):
        """A run in which everybody but the relay has been started, and then the relay."""
        run = self.run_with_board("board", self.scenario, arguments)
        run.wait_for(lambda line: "somebody else" in line.get("note", ""), "the start of the others")
        relay = self.switch_on()
        run.wait_for_time(0.02)
        return run, relay

    def test_the_simulation_waits_for_a_board_that_comes_late_and_stops_for_a_while(self):
        self.install(self.scenario)
        native = self.run_to_end("native", scenario=SHORT)
        run, relay = self.start_late()
        os.kill(relay.pid, signal.SIGSTOP)
        time.sleep(1)  # of whatever length: the results are those of a relay that never stopped
        os.kill(relay.pid, signal.SIGCONT)
        self.assertEqual(run.finish(), OK, run.stderr() + self.log())
        self.assert_identical(native, run)

    def test_the_simulation_is_as_fast_as_the_board(self):
        self.install(self.scenario)
        run, relay = self.start_late("--set", "simulation.duration_s=100")
        os.kill(relay.pid, signal.SIGSTOP)
        last = self.time_when_quiet(run)
        os.kill(relay.pid, signal.SIGCONT)
        run.wait_for_time(last + 0.05)  # it had stood still for want of the relay, and for nothing else
        run.process.send_signal(signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())

    def time_when_quiet(self, run):
        """The simulated time at which nothing has moved for two seconds."""
        last, deadline = 0.0, time.monotonic() + HANG_S
        while time.monotonic() < deadline:
            try:
                line = run.lines.get(timeout=2)
            except queue.Empty:
                return last
            self.assertIsNotNone(line, run.stderr())
            last = max(last, line.get("time_s", 0.0))
        self.fail(f"the simulation goes on without its relay, it is at {last} s")

    def test_the_dashboard_shows_it_as_expected_until_it_joins(self):
        self.install(self.scenario)
        self.within(self.machine, "ip link set lo up")
        monitor = [f"processes.monitor.{setting}" for setting in ("program=gridspace-monitor", "host=simulator", "listen=127.0.0.1:0")]
        run = self.run_with_board("board", self.scenario, [word for s in (*monitor, "simulation.duration_s=100") for word in ("--set", s)])
        url = run.wait_for(lambda line: "monitor: http" in line.get("note", ""), "the dashboard")["note"].split()[1]
        self.assertEqual(self.wait_for_state(url, lambda states: states.get("mu21") == "alive")["relay2"], "expected")
        self.switch_on()
        self.wait_for_state(url, lambda states: states.get("relay2") == "alive")
        run.process.send_signal(signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())

    def wait_for_state(self, url, condition):
        """The states of the processes, when the monitor says that they are so."""
        ask = "import sys,urllib.request as u; print(u.urlopen(sys.argv[1] + '/api/v1/run', timeout=5).read().decode())"
        deadline = time.monotonic() + HANG_S
        while time.monotonic() < deadline:
            said = subprocess.run(["nsenter", "-t", str(self.machine), "-n", sys.executable, "-c", ask, url], capture_output=True, text=True)
            if said.returncode == 0:
                states = {p["name"]: p["state"] for p in json.loads(said.stdout)["processes"]}
                if condition(states):
                    return states
            time.sleep(0.1)
        self.fail(f"the monitor does not say so: {said.stdout}{said.stderr}")

    def test_a_board_that_dies_in_lockstep_is_named(self):
        self.install(self.scenario)
        run = self.run_with_board("board", self.scenario, ["--set", "clock.member_timeout_s=6", "--set", "simulation.duration_s=100"])
        relay = self.switch_on()
        run.wait_for_time(0.02)
        relay.kill()
        self.assertEqual(run.finish(), STALL, run.stderr())
        # Killed between two of its acknowledgements, it has reached the simulator and not the breaker, which then says so.
        self.assertRegex(run.stderr(), r"waited 6 s for (relay2|breaker2 \(.* by relay2\))")

    def test_in_real_time_it_comes_late_is_started_again_and_still_trips(self):
        self.install(self.real_time)
        run = self.run_with_board("real_time", self.real_time)
        run.wait_for_time(0.2)
        first = self.switch_on()
        run.wait_for_time(1.0)
        self.assertIsNone(first.poll(), self.log())
        first.kill()
        first.wait()
        second = self.switch_on()
        self.assertEqual(run.finish(), OK, run.stderr() + self.log())
        self.assertEqual(second.wait(60), OK, self.log())  # the run is over, and it has heard that

    def test_in_real_time_nobody_waits_for_it(self):
        run = self.start("nobody", ["--set", "hosts.ied2.plugs=~", "--until", "200ms", "--set", "expect=~"], self.real_time)
        self.assertEqual(run.finish(), OK, run.stderr())

    def test_a_board_whose_simulator_dies_ends_with_what_has_happened(self):
        self.install(self.scenario)
        relay = self.switch_on()
        run = self.run_with_board("board", self.scenario, ["--set", "simulation.duration_s=100"])
        run.wait_for_time(0.02)
        os.kill(run.pid_of("sim"), signal.SIGKILL)
        self.assertEqual(run.finish(), CHILD_DIED, run.stderr())
        self.assertEqual(relay.wait(120), STALL, self.log())
        self.assertIn("the simulator 'sim' is silent", self.log())

    def wait_for_log(self, text, relay):
        deadline = time.monotonic() + HANG_S
        while text not in self.log():
            self.assertIsNone(relay.poll(), self.log())
            self.assertLess(time.monotonic(), deadline, self.log())
            time.sleep(0.05)

    def test_its_interface_may_come_late_and_one_that_is_down_is_named(self):
        self.install(self.scenario)
        self.within(self.board, "ip link set process_bus down; ip link set process_bus name late0")
        relay = self.switch_on()
        self.wait_for_log("waits for the interface 'process_bus'", relay)
        self.within(self.board, "ip link set late0 name process_bus")
        self.wait_for_log("the interface 'process_bus' is down or has no carrier", relay)
        self.within(self.board, "ip link set process_bus up")
        run = self.run_with_board("board", self.scenario)
        self.assertEqual(run.finish(), OK, run.stderr() + self.log())
        self.assertEqual(relay.wait(60), OK, self.log())

    def test_what_makes_no_sense_is_refused(self):
        for setting, what in (("processes.relay2.run_on=native", "on which 'relay2' is to be started"),
                              ("hosts.ied2.plugs.process_buss.interface=eth9", "host 'ied2' is not on a link 'process_buss'"),
                              ("events.again.kill=relay2", "which somebody else has started")):
            code, _, err = gridspace("validate", self.scenario, "--set", setting, "--set", "events.again.at_s=0.1")
            self.assertEqual(code, 2, err)
            self.assertIn(what, err)
        code, _, err = gridspace("run", self.scenario, "--out", self.folder / "no_interface")
        self.assertEqual(code, 3, err)
        self.assertIn("'to_board0' cannot be plugged into 'mgmt0' for host 'ied2'", err)


if __name__ == "__main__":
    unittest.main()
