#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Unmodified programs as members of lockstep runs: what they see and send is what arithmetic and the recording say, and the same each time."""
import os
import pathlib
import struct
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "scenario"))
from harness import CHILD_DIED, SOURCE, STALL, USAGE, ScenarioTest, gridspace
from pcapng_file import Capture, ethertype

os.environ["PATH"] = f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"  # not a script that looks for a Python
PROGRAMS = pathlib.Path(__file__).parent / "programs"
EPOCH_NS = 1_575_158_400_000_000_000
LOOK_NS = 100  # a look at the clock
QUANTA_HZ = 48000  # the grid of simulated time in case 2

BASE = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection_lockstep.yaml
name: base
simulation: {{duration_s: 0.1}}
events: ~
record: {{comtrade: ~}}
expect: ~
report: ~
processes: {{monitor: ~, relay2: ~, breaker2: ~}}
"""

ALL = """---
gridspace: 1
extends: base.yaml
name: all
hosts:
  h1: {links: [process_bus]}
  h2: {links: [process_bus]}
  h3: {links: [process_bus]}
  h4: {links: [process_bus]}
  h5: {links: [process_bus]}
  h6: {links: [process_bus]}
processes:
  sleeper: {program: exec, host: h1, time: simulated, command: [./absolute_sleeper, process_bus], sends: [smv]}
  threads: {program: exec, host: h2, time: simulated, command: [./thread_per_stream, process_bus], receives: [SMV21, SMV22], sends: [goose], latency_us: 500}
  loop: {program: exec, host: h3, time: simulated, command: [./event_loop, process_bus], receives: [smv], sends: [goose]}
  poller: {program: exec, host: h4, time: simulated, command: [./poller, process_bus], receives: [goose]}
  receiver: {program: exec, host: h6, time: simulated, command: [./receiver_thread, process_bus], receives: [goose]}
  listener: {program: exec, host: h5, time: simulated, command: [dumpcap, -q, -i, process_bus, -w, listened.pcapng], receives: [smv, goose]}
"""


def one(command, more=""):
    return f"""---
gridspace: 1
extends: base.yaml
name: one
hosts: {{h1: {{links: [process_bus]}}}}
processes:
  own: {{program: exec, host: h1, time: simulated, command: {command}{more}}}
"""


def on_grid(ns):
    """The first instant of simulated time that is not before it, to the nanosecond."""
    quanta = ns * QUANTA_HZ // 10**9
    while round(quanta * 10**9 / QUANTA_HZ) < ns:
        quanta += 1
    return round(quanta * 10**9 / QUANTA_HZ)


def numbers(octets):
    return struct.unpack("<3q", octets[-24:])


class Member(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.write("base.yaml", BASE)

    def compile(self, *names):
        for name in names:
            subprocess.run(["cc", "-O1", "-w", "-pthread", PROGRAMS / f"{name}.c", "-o", self.folder / name], check=True)

    def logged(self, run, process):
        return (run.folder / "logs" / f"{process}.log").read_text().splitlines()

    def said(self, run, event):
        return {e["source"]: e["text"] for e in run.events() if e["event"] == event}

    def test_programs_of_all_kinds_live_by_the_ledger_and_two_runs_of_them_are_identical(self):
        self.compile("absolute_sleeper", "thread_per_stream", "event_loop", "poller", "receiver_thread")
        scenario = self.write("all.yaml", ALL)
        run, again = (self.run_to_end(name, scenario=scenario) for name in ("first", "second"))
        self.assert_identical(run, again)
        for file in ("processes/listened.pcapng", "logs/poller.log", "logs/receiver.log"):
            self.assertEqual((run.folder / file).read_bytes(), (again.folder / file).read_bytes(), file)
        frames = {}
        packets = sorted(Capture(run.folder / "bus.pcapng.gz").packets, key=lambda p: (p.time_ns, p.octets))
        for packet in packets:
            frames.setdefault(packet.octets[4:6], []).append((packet.time_ns - EPOCH_NS, packet.octets))
        samples = frames[b"\x00\x21"]

        with self.subTest("who sleeps to absolute deadlines wakes at them, and its frame leaves at the next instant of the grid"):
            sent = frames[b"\x01\x01"]
            self.assertEqual(len(sent), 479)
            for k, (time_ns, octets) in enumerate(sent, 1):
                woken_ns = k * 10**9 // 4800
                self.assertEqual(numbers(octets), (k, EPOCH_NS + woken_ns, 0))
                self.assertEqual(time_ns, on_grid(woken_ns + LOOK_NS))

        with self.subTest("threads that wait for each other answer at the stamp of the sample, and latency_us later it is on the wire"):
            answers = frames[b"\x01\x02"]
            self.assertEqual([numbers(octets)[0] for _, octets in answers], list(range(0, 480, 10)))
            for (time_ns, octets), (sample_ns, _) in zip(answers, samples[::10]):
                self.assertEqual(numbers(octets)[1], EPOCH_NS + sample_ns)
                self.assertEqual(time_ns, on_grid(sample_ns + LOOK_NS + 500_000))

        with self.subTest("a timer of 10 ms in an event loop, and what has come between its rings"):
            told = [numbers(octets) for _, octets in frames[b"\x01\x03"]]
            self.assertEqual([number for number, _, _ in told], list(range(1, 10)))
            late_ns = told[0][1] - 10_000_000  # looks of the loader, before the timer was set
            self.assertLess(late_ns, 20_000)
            heard = [p.time_ns - EPOCH_NS for p in packets if ethertype(p.octets) == b"\x88\xba"]
            for number, clock_ns, count in told:
                self.assertEqual(clock_ns, number * 10_000_000 + late_ns)
                self.assertEqual(count, sum((number - 1) * 10_000_000 + late_ns < ns <= number * 10_000_000 + late_ns for ns in heard))

        with self.subTest("who polls for a millisecond sees frames at their times and milliseconds without any"):
            coming = [ns for ns in sorted(p.time_ns - EPOCH_NS for p in packets if ethertype(p.octets) == b"\x88\xb8")]
            lines = [line for line in self.logged(run, "poller") if "held" not in line and "answered" not in line]
            now_ns = 0
            self.assertGreater(sum(line.startswith("nothing until") for line in lines), 40)
            for line in lines:
                if coming and coming[0] <= now_ns + 1_000_000:
                    at_ns = coming.pop(0)
                    now_ns = max(now_ns, at_ns)
                    self.assertIn(f" at {EPOCH_NS + at_ns}, {now_ns - at_ns} later", line)
                else:
                    now_ns += 1_000_000
                    self.assertEqual(line, f"nothing until {now_ns}")
                now_ns += LOOK_NS
            self.assertEqual([ns for ns in coming if ns < 99_000_000], [])

        with self.subTest("a thread that receives with a timeout of the socket, beside a loop that sleeps"):
            coming = [ns for ns in sorted(p.time_ns - EPOCH_NS for p in packets if ethertype(p.octets) == b"\x88\xb8")]
            now_ns, seen = 0, set()
            for line in [line for line in self.logged(run, "receiver") if "rounds" in line]:
                what, us, _, rounds, _ = line.split()
                seen.add(what)
                came = coming and coming[0] <= now_ns + 1_500_000
                now_ns = max(now_ns, coming.pop(0)) if came else now_ns + 1_500_000
                self.assertEqual((what, int(us)), ("frame" if came else "nothing", (EPOCH_NS + now_ns) // 1000))
                self.assertAlmostEqual(int(rounds), now_ns / 1e6, delta=1)
                now_ns += LOOK_NS
            self.assertEqual(seen, {"frame", "nothing"})
            self.assertEqual([ns for ns in coming if ns < 98_000_000], [])

        with self.subTest("a listener's file has the frames and times of ours"):
            listened = Capture(run.folder / "processes/listened.pcapng").packets
            self.assertEqual(sorted((p.time_ns, p.octets) for p in listened), [(p.time_ns, p.octets) for p in packets])

        with self.subTest("the report says how many calls of which kinds were held"):
            self.assertRegex(self.said(run, "held_calls")["sleeper"], r"480 clock_nanosleep.* 479 sendto")

    def test_the_python_relay_trips_in_the_place_of_ours(self):
        relay = SOURCE / "examples/agents/python_iec61850/relay_in_lockstep.yaml"
        settings = ("simulation.duration_s=0.2", "events.fault.at_s=0.1", "processes.monitor=~")
        run, again = (self.run_to_end(name, [part for s in settings for part in ("--set", s)], scenario=relay) for name in ("first", "second"))
        self.assert_identical(run, again)
        self.assertTrue(any(line.startswith("trip at sample") for line in self.logged(run, "python_relay")))

    def test_a_crash_ends_the_run_with_its_cause(self):
        for script, how in (("kill -SEGV $$", "was killed by signal 11 (Segmentation fault)"), ("exit 7", "ended with exit code 7")):
            run = self.run_to_end(how[:5], scenario=self.write("one.yaml", one(f"[sh, -c, 'sleep 0.05; {script}']")), code=CHILD_DIED)
            self.assertIn(f"'sh' {how} at 0.05", run.stderr())
            self.assertIn("own: ", run.manifest()["cause"])
        run = self.run_to_end("no_program", scenario=self.write("one.yaml", one("[no_such_program]")), code=3)
        self.assertIn("cannot start 'no_such_program'", run.stderr())

    def test_who_ends_by_himself_with_0_ends_nothing(self):
        run = self.run_to_end("ended", scenario=self.write("one.yaml", one("[sleep, '0.05']")))
        self.assertRegex(self.said(run, "ended")["own"], r"'sleep' ended with exit code 0 at 0\.0500\d+ s")

    def test_its_random_numbers_come_from_the_seed_of_the_scenario(self):
        scenario = self.write("one.yaml", one("[python3, -c, 'import os; print(os.urandom(8).hex(), flush=True)']"))
        said = [self.logged(self.run_to_end(name, ["--seed", seed], scenario=scenario), "own")[0] for name, seed in (("a", "7"), ("b", "7"), ("c", "8"))]
        self.assertRegex(said[0], "^[0-9a-f]{16}$")
        self.assertEqual(said[0], said[1])
        self.assertNotEqual(said[0], said[2])

    def test_a_loop_without_calls_is_ended_by_a_deadline_that_names_it(self):
        self.compile("endless_loop")
        patience = ["--set", "clock.member_timeout_s=4"]
        run = self.run_to_end("endless", patience, scenario=self.write("one.yaml", one("[./endless_loop]")), code=STALL)
        self.assertRegex(run.stderr(), r"own: endless_loop \(\d+\) has computed for \d+ s without a call .* at 0\.05\d+ s of simulated time; its last was clock_nanosleep")

    def test_what_cannot_be_is_refused_and_told(self):
        script = self.folder / "refused.py"
        script.write_text("""
import socket, time
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
port.bind(("process_bus", 0x88b8))
for attempt in (lambda: port.send(b"\\xff" * 12 + b"\\x08\\x06" + bytes(46)), lambda: port.setsockopt(socket.SOL_SOCKET, 37, 1), lambda: port.bind(("lo", 3))):
    try: attempt()
    except OSError as e: print(e.errno, flush=True)
time.sleep(100)
""")
        run = self.run_to_end("refused", scenario=self.write("one.yaml", one(f"[python3, {script}]", ", sends: [goose]")))
        self.assertEqual(self.logged(run, "own")[:3], ["1", "92", "19"])
        told = [e["text"] for e in run.events() if e["event"] == "refused"]
        self.assertTrue(any(text.startswith("a frame of ethertype 0x0806, which its `sends:` does not declare") for text in told), told)
        self.assertTrue(any(text.startswith("SO_TIMESTAMPING") for text in told), told)

    @unittest.skipUnless(os.geteuid() == 0, "an ordinary user has no rights to begin with")
    def test_what_the_box_needs_for_its_process_numbers_the_program_cannot_gain(self):
        run = self.run_to_end("rights", scenario=self.write("one.yaml", one("[sh, -c, 'echo $$; grep Cap /proc/self/status; cat /proc/self/personality; sleep 1']")))
        number, *rights = self.logged(run, "own")
        self.assertEqual(number, "2")
        held = {line.split()[0]: int(line.split()[1], 16) for line in rights if line.startswith("Cap")}
        self.assertEqual({name for name, bits in held.items() if bits & (1 << 21 | 1 << 8)}, set())
        self.assertEqual(len(held), 5)
        self.assertIn("00040000", rights, "its addresses are not randomised")

    def test_validate_knows_what_follows_from_simulated_time(self):
        def mistakes(more, *arguments):
            code, out, err = gridspace("validate", self.write("one.yaml", one("[sleep, '1']", more)), *arguments)
            return code, out + err

        code, said = mistakes(", receives: [smv]", "--set", "clock.mode=realtime", "--set", "clock.speed=1")
        self.assertEqual(code, 0, said)
        self.assertIn("warning: process 'own' lives in real time, as all do here", said)
        for more, wanted in ((", member: true", "and says that it follows the lockstep protocol"), (", sends: [ip], reads: {TL_11: {type: LineCurrents}}", "and exchanges topics and IP at once"),
                             (", sends: [SMV23]", "sends 'SMV23', which is no stream and no kind of frame"), (", run_on: qemu-user", "and on 'qemu-user'")):
            code, said = mistakes(more)
            self.assertEqual(code, USAGE, said)
            self.assertRegex(said, rf"one\.yaml:\d+:\d+: error: process 'own' .*{wanted}")
        code, out, err = gridspace("validate", self.write("one.yaml", one("[sleep, '1']", ", receives: [smv]").replace("host: h1", "host: mu21")))
        self.assertEqual(code, USAGE)
        self.assertIn("process 'own' waits for frames of 'mu21' on 'process_bus', and both are on the host 'mu21'", out + err)
        code, out, err = gridspace("validate", self.write("one.yaml", one("[sleep, '1']", ", sends: [smv]").replace("time: simulated, ", "")))
        self.assertEqual(code, USAGE)
        self.assertIn("process 'own' has `sends`, and lives in real time", out + err)


if __name__ == "__main__":
    unittest.main()
