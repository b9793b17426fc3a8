#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""UDP and TCP between unmodified programs of different hosts in lockstep: times are what arithmetic says, streams are whole, runs repeat."""
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "scenario"))
from harness import BIN, SOURCE, USAGE, ScenarioTest, gridspace

PROGRAMS = pathlib.Path(__file__).parent / "programs"
PRELOAD = BIN.parent / "tests/librandom_delays.so"
QUANTA_HZ = 48000  # the grid of simulated time in case 2
LOOK_NS = 100  # a look at the clock

BASE = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection_lockstep.yaml
name: base
simulation: {{duration_s: 0.2}}
clock: {{tick_samples: 1}}
events: ~
record: {{comtrade: ~}}
expect: ~
report: ~
links: {{lan: {{ipv4: 10.30.0.0/24}}}}
hosts:
  h1: {{links: [lan]}}
  h2: {{links: [lan]}}
  h3: {{links: [lan]}}
processes: {{recorder: {{capture: [lan]}}, monitor: ~, relay2: ~, breaker2: ~}}
"""


def process(name, host, command, latency_us=250, more=""):
    return f"  {name}: {{program: exec, host: {host}, time: simulated, command: {command}, sends: [ip], latency_us: {latency_us}{more}}}\n"


def scenario(*processes, more=""):
    return f"---\ngridspace: 1\nextends: base.yaml\nname: ip\n{more}processes:\n" + "".join(processes)


def impairments(there_us, back_us, loss_percent=0):
    return f"""impairments:
  there: {{place: {{between: [h2, lan]}}, direction: from_host, delay_us: {there_us}, loss_percent: {loss_percent}}}
  back: {{place: {{between: [h2, lan]}}, direction: to_host, delay_us: {back_us}}}
"""


def quantum_at_or_after(ns):
    return -(-ns * QUANTA_HZ // 10**9)


def ns_of(quanta):
    return round(quanta * 10**9 / QUANTA_HZ)


class Ip(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.write("base.yaml", BASE)

    def compile(self, name, *libraries):
        subprocess.run(["cc", "-O1", "-w", PROGRAMS / f"{name}.c", "-o", self.folder / name, *libraries], check=True)

    def logged(self, run, name):
        # What is said before the simulation's first time ("waits for sim") depends on how busy the machine is.
        return [line for line in (run.folder / "logs" / f"{name}.log").read_text().splitlines() if not line.startswith("           - ")]

    def run_thrice(self, file, *arguments, logs=()):
        runs = [self.run_to_end(name, list(arguments), scenario=file) for name in ("first", "second", "third")]
        for other in runs[1:]:
            self.assert_identical(runs[0], other)
            for name in logs:
                self.assertEqual(self.logged(runs[0], name), self.logged(other, name), name)
        return runs[0]

    def said(self, run, event):
        return {e["source"]: e["text"] for e in run.events() if e["event"] == event}

    def tshark(self, run, *arguments):
        return subprocess.run(["tshark", "-r", run.folder / "bus.pcapng.gz", *arguments], capture_output=True, text=True, check=True).stdout.splitlines()

    def assert_sound_frames(self, run, at_least):
        self.assertGreaterEqual(len(self.tshark(run, "-Y", "ip", "-o", "tcp.check_checksum:TRUE", "-o", "udp.check_checksum:TRUE", "-o", "ip.check_checksum:TRUE")), at_least)
        wrong = "_ws.malformed or tcp.checksum.status == 0 or udp.checksum.status == 0 or ip.checksum.status == 0"
        checks = [part for layer in ("tcp", "udp", "ip") for part in ("-o", f"{layer}.check_checksum:TRUE")]
        self.assertEqual(self.tshark(run, *checks, "-Y", wrong), [])
        self.assertEqual(self.tshark(run, "-Y", "arp"), [], "nobody asks")

    def echoes(self, run):
        lines = [line.split() for line in self.logged(run, "client") if line.startswith(("echo", "Resource", "wrong"))]
        self.assertEqual([line[0] for line in lines], ["echo"] * len(lines))
        return [(int(begun), int(ended)) for _, _, begun, ended in lines]

    def test_an_echo_of_udp_takes_the_latencies_and_the_delays_of_its_cables(self):
        self.compile("ip_ends")
        for server_us, client_us, there_us, back_us in ((250, 250, 0, 0), (500, 250, 1000, 500), (250, 750, 2000, 500)):
            cables = impairments(there_us, back_us) if there_us else ""
            file = self.write("udp.yaml", scenario(process("server", "h1", "[./ip_ends, udp_echo]", server_us), process("client", "h2", "[./ip_ends, udp_ask, 10.30.0.1, '9']", client_us), more=cables))
            run = self.run_to_end(f"udp{server_us}{client_us}{there_us}", scenario=file)
            echoes = self.echoes(run)
            self.assertEqual(len(echoes), 9)
            for begun, ended in echoes:
                on_wire = quantum_at_or_after(begun + LOOK_NS + client_us * 1000)
                self.assertEqual(ended, ns_of(on_wire + (there_us + server_us + back_us) * QUANTA_HZ // 10**6), (begun, ended))
            self.assert_sound_frames(run, 18)

    def test_times_do_not_depend_on_the_length_of_a_tick(self):
        self.compile("ip_ends")
        file = self.write("udp.yaml", scenario(process("server", "h1", "[./ip_ends, udp_echo]", 2000), process("client", "h2", "[./ip_ends, udp_ask, 10.30.0.1, '9']", 900)))
        said = [self.echoes(self.run_to_end(f"ticks{samples}", ["--set", f"clock.tick_samples={samples}"], scenario=file)) for samples in ("1", "4", "auto")]
        self.assertEqual(len(said[0]), 9)
        self.assertEqual(said[0], said[1])
        self.assertEqual(said[0], said[2])

    def test_a_connection_takes_its_handshake_and_its_stream_is_whole_three_times_the_same(self):
        self.compile("ip_ends")
        file = self.write("tcp.yaml", scenario(process("server", "h1", "[./ip_ends, tcp_echo]"), process("client", "h2", "[./ip_ends, tcp_ask, 10.30.0.1, '7', '100000']")))
        run = self.run_thrice(file, logs=("client", "server"))
        connected, whole = self.logged(run, "client")[:2]
        begun, ended = map(int, connected.split()[1:])
        self.assertEqual(ended, ns_of(quantum_at_or_after(begun + LOOK_NS + 250_000) + 12))
        self.assertRegex(whole, r"^whole 100000 wrong 0 end 0 ")
        self.assertRegex("\n".join(self.logged(run, "server")), "(?m)^closed after 100000 at ")
        self.assert_sound_frames(run, 100000 // 1460 * 2)
        self.assertEqual(self.tshark(run, "-Y", "tcp.analysis.retransmission"), [])

    def test_members_that_dawdle_change_no_bit_by_shared_memory_and_by_dds(self):
        self.assertTrue(PRELOAD.exists())
        self.compile("ip_ends")
        file = self.write("tcp.yaml", scenario(process("server", "h1", "[./ip_ends, tcp_echo]"), process("client", "h2", "[./ip_ends, tcp_ask, 10.30.0.1, '7', '30000']"),
                                               more="simulation: {duration_s: 0.1}\n" + impairments(100, 100)))
        dawdling = ["env", f"LD_PRELOAD={PRELOAD}", "GRIDSPACE_TEST_DELAY_US=800"]
        for memory in ("true", "false"):
            arguments = ["--set", f"clock.shared_memory={memory}"]
            prompt = self.run_to_end(f"prompt_{memory}", arguments, scenario=file)
            late = self.run_to_end(f"late_{memory}", arguments, scenario=file, prefix=dawdling)
            self.assert_identical(prompt, late)
            self.assertRegex(self.logged(prompt, "client")[1], r"^whole 30000 wrong 0 end 0 ")

    def test_who_ends_without_a_word_is_taken_leave_of_by_his_host(self):
        self.compile("ip_ends")
        file = self.write("leave.yaml", scenario(process("server", "h1", "[./ip_ends, tcp_echo]"), process("client", "h2", "[./ip_ends, tcp_leave, 10.30.0.1]")))
        run = self.run_to_end("leave", scenario=file)
        left = int(next(line for line in self.logged(run, "client") if line.startswith("left")).split()[-1])
        closed = next(line for line in self.logged(run, "server") if line.startswith("closed after 3")).split()[-1]
        self.assertEqual(int(closed), ns_of(quantum_at_or_after(left + LOOK_NS + 250_000)))
        self.assertRegex(self.said(run, "ended")["client"], rf"at {(left + LOOK_NS) / 1e9:.6f} s")

    def test_what_a_cable_loses_is_sent_again(self):
        self.compile("ip_ends")
        file = self.write("lossy.yaml", scenario(process("server", "h1", "[./ip_ends, tcp_echo]"), process("client", "h2", "[./ip_ends, tcp_ask, 10.30.0.1, '7', '60000']"),
                                                 more="simulation: {duration_s: 6}\n" + impairments(500, 500, 3)))
        run, again = (self.run_to_end(name, scenario=file) for name in ("first", "second"))
        self.assert_identical(run, again)
        self.assertRegex(self.logged(run, "client")[1], r"^whole 60000 wrong 0 end 0 ")
        self.assertNotEqual(self.tshark(run, "-Y", "tcp.analysis.retransmission or tcp.analysis.fast_retransmission"), [])

    def test_sockets_do_what_the_manuals_say(self):
        self.compile("ip_ends")
        habits = PROGRAMS / "socket_habits.py"
        file = self.write("habits.yaml", scenario(process("server", "h1", "[./ip_ends, tcp_echo]"), process("client", "h2", f"[python3, {habits}, 10.30.0.2, 10.30.0.1, 10.30.0.3, 239.1.2.3]"),
                                                  more="simulation: {duration_s: 1}\n"))
        run = self.run_to_end("habits", ["--set", "clock.member_timeout_s=30"], scenario=file)
        lines = [line for line in self.logged(run, "client") if re.match("ok|failed|done", line)]
        self.assertEqual([line for line in lines if line.startswith("failed")], [])
        self.assertEqual((len(lines), lines[-1]), (18, "done"))
        told = [e["text"] for e in run.events() if e["event"] == "refused"]
        for what in ("a socket of IPv6", "a raw socket of IP", "option 23 of TCP"):
            self.assertTrue(any(text.startswith(what) for text in told), told)
        self.assertEqual([e for e in run.events() if e["event"] == "not_simulated"], [])

    @unittest.skipUnless(shutil.which("mosquitto") and shutil.which("mosquitto_pub"), "Debian's mosquitto is not there")
    def test_debians_mqtt_broker_and_clients_repeat(self):
        run = self.run_thrice(SOURCE / "examples/agents/mqtt/mqtt_in_lockstep.yaml", "--set", "simulation.duration_s=1.5", logs=("reader", "broker"))
        lines = [line.split() for line in self.logged(run, "reader") if "feeder/power" in line]
        self.assertEqual(len(lines), 10)
        delays = [round((float(heard) - float(said)) * 1e6) for heard, _, said in lines]
        for delay_us in delays[2:]:  # the first wait for the connection
            self.assertAlmostEqual(delay_us, 2000 + 250 + 250, delta=60)
        self.assertGreaterEqual(len(self.tshark(run, "-Y", "mqtt.msgtype == 3")), 20)
        self.assert_sound_frames(run, 60)

    @unittest.skipUnless(pathlib.Path("/usr/include/modbus/modbus.h").exists(), "libmodbus is not there")
    def test_modbus_answers_after_two_latencies(self):
        self.compile("modbus_ends", "-lmodbus")
        file = self.write("modbus.yaml", scenario(process("server", "h1", "[./modbus_ends, serve]"), process("client", "h2", "[./modbus_ends, ask, 10.30.0.1, '3']")))
        run = self.run_thrice(file, logs=("client",))
        lines = [line for line in self.logged(run, "client") if "back" in line]
        self.assertEqual(len(lines), 3)
        for i, line in enumerate(lines):
            self.assertRegex(line, rf"^1 1 1 back {100 + i} at ")
            self.assertLess(abs(int(line.split()[-1]) - 3 * 2 * 250_000), 3 * 2 * 20_834)
        self.assertEqual(len(self.tshark(run, "-Y", "modbus")), 18)
        self.assert_sound_frames(run, 18)

    def test_validate_says_what_ip_in_simulated_time_needs(self):
        def mistakes(*processes, more=""):
            code, out, err = gridspace("validate", self.write("one.yaml", scenario(*processes, more=more)))
            return code, out + err

        code, said = mistakes(process("own", "h1", "[sleep, '1']", 100))
        self.assertEqual(code, USAGE, said)
        self.assertRegex(said, r"process 'own' speaks IP in simulated time, its `latency_us` is 100, and a tick is 208\.\d+ us")
        code, said = mistakes(process("own", "mu21", "[sleep, '1']", more=", link: process_bus"))
        self.assertEqual(code, USAGE, said)
        self.assertIn("process 'own' speaks IP on 'process_bus', which has no addresses", said)
        code, said = mistakes(process("own", "h1", "[sleep, '1']"), process("other", "h1", "[sleep, '1']"))
        self.assertEqual(code, USAGE, said)
        self.assertRegex(said, "'o.*' waits for frames of 'o.*' on 'lan', and both are on the host 'h1'")


if __name__ == "__main__":
    unittest.main()
