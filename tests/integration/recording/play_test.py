#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What `gridspace play` puts back onto the bus and the wire is what was recorded; `gridspace info` says what that is."""
import contextlib
import gzip
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
import mcap_file  # noqa: E402
from harness import BASE, BIN, HANG_S, OK, PACED, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

INSIDE = "GRIDSPACE_PLAY_TEST_INSIDE"
SHORT = [*BASE, "--until", "1800s", "--set", "expect=~", "--set", "processes.recorder.compress=false"]
TYPES = {"bus_measurements": "BusMeasurement", "requests": "ChargingRequest", "decisions": "ChargingDecision", "signals": "SignalFrame",
         "signal_catalog": "SignalCatalog"}
PROCESSES = ["ev1", "ev2", "ev3", "ev4", "mcca"]
DOMAIN = 3


def frames_of(capture):
    """Octets of the packets of a pcapng file, in its order."""
    data, at, out = gzip.decompress(capture.read_bytes()), 0, []
    while at + 12 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind == 6:
            length = struct.unpack_from("<I", data, at + 20)[0]
            out.append(data[at + 28: at + 28 + length])
        at += size
    return out


class Play(ScenarioTest):
    def setUp(self):
        super().setUp()
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        self.recorders = []

    def tearDown(self):
        for recorder in self.recorders:
            if recorder.poll() is None:
                recorder.kill()
            recorder.communicate()
        super().tearDown()

    def recorder(self, name, topics=TYPES, qos=SOURCE / "qos"):
        """A recorder that is no part of any run, and its file."""
        file = self.folder / f"{name}.mcap"
        config = self.write(f"{name}.yaml", json.dumps({
            "process": "again", "program": "gridspace-recorder",
            "bus": {"qos": str(qos / "recorder.xml"), "management": {"domain": DOMAIN, "addresses": ["127.0.0.1"]},
                    "clock": {"mode": "realtime", "quantum_s": 1, "tick_s": 1, "epoch": "2019-12-01T09:00:00Z", "simulator": "sim", "members": PROCESSES,
                              "start_timeout_s": 0}},
            "settings": {"file": str(file), "compress": False, "topics": {t: {"type": TYPES[t]} for t in topics}}}))
        process = subprocess.Popen([BIN / "gridspace-recorder", "--config", config], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.recorders.append(process)
        return process, file

    def play(self, run, *arguments, code=OK):
        done = subprocess.run([BIN / "gridspace", "play", run, "--domain", str(DOMAIN), "--address", "127.0.0.1", "--json", *map(str, arguments)],
                              capture_output=True, text=True, timeout=HANG_S)
        self.assertEqual(done.returncode, code, done.stderr)
        return (json.loads(done.stdout) if code == OK else None), done.stderr

    def play_and_record(self, name, run, *arguments, topics=TYPES):
        process, file = self.recorder(name, topics)
        totals, said = self.play(run, "--wait", "--topics", ",".join(["simulation_clock", *topics]), *arguments)
        _, err = process.communicate(timeout=HANG_S)  # it ends with the last clock sample
        self.assertEqual(process.returncode, OK, err)
        return totals, mcap_file.by_topic(file), said

    def test_a_recording_played_and_recorded_again_is_the_same_sample_by_sample(self):
        run = self.run_to_end("run", SHORT)
        first = {key: list_ for key, list_ in mcap_file.by_topic(run.folder / "data.mcap").items() if key[0] != "clock_ack"}
        totals, again, _ = self.play_and_record("again", run.folder, "--rate", 0)
        self.assertEqual(set(first), set(again))
        for key, list_ in first.items():
            self.assertEqual(len(list_), len(again[key]), key)
            self.assertEqual(list_, again[key], key)
        self.assertEqual(totals["samples"], sum(map(len, first.values())))
        self.assertEqual((totals["refused"], totals["behind"], totals["complete"]), (0, 0, True))

        # The negative control: a part of it is not the same.
        part, fewer, _ = self.play_and_record("part", run.folder, "--rate", 0, "--start", "600s", topics=["bus_measurements"])
        self.assertEqual(set(fewer), {("bus_measurements", "sim"), ("simulation_clock", "sim")})
        whole = first["bus_measurements", "sim"]
        got = fewer["bus_measurements", "sim"]
        self.assertEqual(got, whole[-len(got):])
        self.assertEqual(len(got), 4 * 1201)  # of four buses, from 600 s to 1800 s
        self.assertLess(part["samples"], totals["samples"])

    def test_a_reader_that_stalls_is_waited_for_and_loses_nothing(self):
        run = self.run_to_end("run", SHORT)
        first = mcap_file.by_topic(run.folder / "data.mcap")
        qos = self.folder / "qos"
        qos.mkdir()
        text = (SOURCE / "qos/recorder.xml").read_text()
        self.assertIn("<leaseDuration><sec>10<", text)
        (qos / "recorder.xml").write_text(text.replace("<leaseDuration><sec>10<", "<leaseDuration><sec>600<"))  # it is not given up
        process, file = self.recorder("stalled", ["requests", "bus_measurements"], qos)
        player = subprocess.Popen([BIN / "gridspace", "play", run.folder, "--domain", str(DOMAIN), "--address", "127.0.0.1", "--json", "--wait", "--rate", "0",
                                   "--topics", "simulation_clock,requests,bus_measurements,decisions"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.recorders.append(player)
        self.read_until(player.stderr, "waiting for readers of decisions\n")
        process.send_signal(signal.SIGSTOP)
        other, _ = self.recorder("other", ["decisions"])
        self.read_until(player.stderr, "waits for them while they are there: ")
        process.send_signal(signal.SIGCONT)
        out, err = player.communicate(timeout=HANG_S)
        self.assertEqual(player.returncode, OK, err)
        self.assertGreater(json.loads(out)["behind"], 0)
        for recorder in (process, other):
            _, err = recorder.communicate(timeout=HANG_S)
            self.assertEqual(recorder.returncode, OK, err)
        again = mcap_file.by_topic(file)
        for topic in ("requests", "bus_measurements"):
            for key in (k for k in first if k[0] == topic):
                self.assertEqual(again[key], first[key], key)

    def read_until(self, stream, words):
        """CTest ends it when that never comes."""
        said = ""
        while words not in said:
            line = stream.readline()
            self.assertTrue(line, f"no '{words}' in: {said}")
            said += line

    def test_info_says_what_there_is(self):
        run = self.run_to_end("run", SHORT)
        code, out, err = gridspace("info", run.folder, "--json")
        self.assertEqual(code, OK, err)
        info = json.loads(out)
        self.assertEqual({t["name"]: t["samples"] for t in info["recording"]["topics"]}, {t["name"]: t["samples"] for t in run.summary()["topics"]})
        measured = next(t for t in info["recording"]["topics"] if t["name"] == "bus_measurements")
        self.assertAlmostEqual(measured["rate_hz"], (4 * 1801 - 1) / 1800, places=9)
        self.assertEqual((measured["first_s"], measured["last_s"], measured["processes"]), (0, 1800, ["sim"]))
        manifest = run.manifest()
        self.assertEqual(info["scenario_sha256"], manifest["files"]["scenario"]["sha256"])
        self.assertEqual((info["verdict"], info["exit"], info["simulated_s"]), ("passed", 0, 1800))
        self.assertEqual(info["octets"], sum(f.stat().st_size for f in run.folder.rglob("*") if f.is_file() and not f.is_symlink()))
        self.assertIsNone(info["capture"])
        code, text, err = gridspace("info", run.folder)
        self.assertEqual(code, OK, err)
        for word in ("passed", "bus_measurements", "ev_charging", "data.mcap"):
            self.assertIn(word, text)
        # Negative controls: an expectation that fails, a folder that is none.
        failed = self.run_to_end("failed", [*BASE, "--until", "600s", "--set", "expect=~", "--set", "expect={wrong: {always: bus.B1.v_pu > 2}}"], code=1)
        verdict = json.loads(gridspace("info", failed.folder, "--json")[1])
        self.assertIn("failed", verdict["verdict"])
        self.assertEqual(verdict["expectations"]["failures"], ["wrong"])
        code, _, err = gridspace("info", self.folder)
        self.assertEqual(code, USAGE)
        self.assertIn("is not the folder of a run", err)

    def test_a_run_that_was_killed_is_shown_and_played_as_far_as_it_goes(self):
        run = self.start("run", [*PACED, "--set", "expect=~", "--set", "clock.mode=realtime", "--set", "processes.recorder.compress=false"])
        run.wait_for_time(3600 * 4)  # real time flushes every second
        victims = [run.pid_of(name) for name in ("supervisor", "launcher", "recorder")]
        for how in (signal.SIGSTOP, signal.SIGKILL):  # stopped first: none of them sees another one die
            for victim in victims:
                with contextlib.suppress(ProcessLookupError):  # the recorder may have died with its supervisor
                    os.kill(victim, how)
        run.finish()
        info = json.loads(gridspace("info", run.folder, "--json")[1])
        self.assertFalse(info["recording"]["complete"])
        self.assertIn("not finished", info["verdict"])
        self.assertGreater(info["recording"]["samples"], 1000)
        totals, said = self.play(run.folder, "--rate", 0)
        self.assertEqual(totals["samples"], info["recording"]["samples"])
        self.assertFalse(totals["complete"])
        self.assertIn("incomplete", said)
        # Cut anywhere, even in the first record.
        whole = (run.folder / "data.mcap").read_bytes()
        for size in (len(whole) // 2, 9):
            file = self.folder / f"cut{size}.mcap"
            file.write_bytes(whole[:size])
            code = OK if size > 100 else USAGE
            totals, said = self.play(file, "--rate", 0, code=code)
            self.assertIn("incomplete" if code == OK else "holds no sample", said)

    def test_wrong_arguments_are_named(self):
        run = self.run_to_end("run", [*BASE, "--until", "600s", "--set", "expect=~"])
        for arguments, expected in ((["--topics", "nothing"], "holds no sample"), (["--start", "2h"], "nothing was recorded between"),
                                    (["--until", "soon"], "is not a time"), (["--frames", "lo"], "has no frames"), (["--rate", "-1"], "--rate"),
                                    (["--only", "x"], "--frames")):
            _, said = self.play(run.folder, *arguments, code=USAGE)
            self.assertIn(expected, said, arguments)
        self.assertIn("there is no", gridspace("play", self.folder / "nowhere.mcap")[2])

    def test_a_run_goes_into_the_dashboard_alone(self):
        run = self.run_to_end("run", [*BASE, "--until", "600s", "--set", "expect=~"])
        process = subprocess.Popen([BIN / "gridspace", "play", run.folder, "--dashboard"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.recorders.append(process)
        self.assertRegex(process.stdout.readline(), r"^http://127\.0\.0\.1:\d+")
        process.send_signal(signal.SIGTERM)
        process.wait(HANG_S)

    def test_recorded_frames_go_back_onto_a_virtual_cable_and_nowhere_else(self):
        run = self.run_to_end("frames", ["--until", "0.2s", "--set", "expect=~"], SOURCE / "configs/scenarios/gateway_four_ways.yaml")
        recorded = [f for f in frames_of(run.folder / "bus.pcapng.gz") if f[12:14] in (b"\x88\xb8", b"\x88\xba") or f[16:18] in (b"\x88\xb8", b"\x88\xba")]
        self.assertGreater(len(recorded), 20)
        subprocess.run("ip link add out type veth peer name in && ip link set out up && ip link set in up && ip link add real type bridge && "
                       "ip link set real up", shell=True, check=True)
        self.addCleanup(subprocess.run, "ip link del out; ip link del real", shell=True)
        heard, listener = [], socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
        listener.bind(("in", 0))
        listener.settimeout(HANG_S)
        try:
            listener.setsockopt(socket.SOL_SOCKET, 33, 1 << 22)  # SO_RCVBUFFORCE: beyond what net.core.rmem_max allows
        except PermissionError:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        listener.setsockopt(263, 8, 1)  # PACKET_AUXDATA: the kernel takes the VLAN tag out of the frame

        def listen():
            while len(heard) < len(recorded):
                frame, auxiliary, _, _ = listener.recvmsg(2048, 64)
                for _, kind, content in auxiliary:
                    status, _, _, _, _, tci, tpid = struct.unpack("=IIIHHHH", content[:20])
                    if kind == 8 and status & 0x10:  # TP_STATUS_VLAN_VALID
                        frame = frame[:12] + struct.pack("!HH", tpid or 0x8100, tci) + frame[12:]
                if b"\x88\xb8" in frame[12:18] or b"\x88\xba" in frame[12:18]:
                    heard.append(frame)

        thread = threading.Thread(target=listen)
        thread.start()
        totals, _ = self.play(run.folder, "--frames", "out", "--no-samples", "--rate", 1)
        thread.join(HANG_S)
        listener.close()
        self.assertEqual(totals["frames"], {"sent": len(recorded), "not_sent": 0})
        self.assertEqual([f.ljust(60, b"\0") for f in heard], [f.ljust(60, b"\0") for f in recorded])
        _, said = self.play(run.folder, "--frames", "real", "--no-samples", code=USAGE)
        self.assertIn("not a virtual cable", said)
        totals, _ = self.play(run.folder, "--frames", "real", "--no-samples", "--rate", 0, "--allow-attacks-on", "real")
        self.assertEqual(totals["frames"]["sent"], len(recorded))


if __name__ == "__main__":
    if os.environ.get(INSIDE) is None:
        kind = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
        os.execvpe("unshare", [*kind, sys.executable, *sys.argv], {**os.environ, INSIDE: "1"})
    unittest.main(verbosity=2)
