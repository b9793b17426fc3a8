#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace wire ...` over a virtual cable, in a namespace of its own."""
import contextlib
import json
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import tempfile
import time
import unittest

import own_namespace
from foreign_frames import asdu, sv

GRIDSPACE = os.environ.get("GRIDSPACE_BIN_DIR", "build/release/bin") + "/gridspace"


def wire(*arguments, **options):
    return subprocess.run([GRIDSPACE, "wire", *arguments], capture_output=True, text=True, timeout=60, **options)


def start(*arguments):
    return subprocess.Popen([GRIDSPACE, "wire", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def listeners():
    """How many packet sockets of this namespace are bound to a protocol."""
    return sum(line.split()[3] != "0000" for line in pathlib.Path("/proc/net/packet").read_text().splitlines()[1:])


def lines(text):
    return [json.loads(line) for line in text.splitlines()]


def messages(text):
    """What a GOOSE subscriber says of messages: on a busy machine one may also expire."""
    return [line for line in lines(text) if line["event"] != "expired"]


class WireTools(unittest.TestCase):
    def setUp(self):
        own_namespace.cable("left", "right")
        self.folder = pathlib.Path(tempfile.mkdtemp())

    def tearDown(self):
        subprocess.run(["ip", "link", "del", "left"], check=True)
        shutil.rmtree(self.folder)

    def while_publishing(self, publisher, *subscriber):
        """The subscriber's result, while the publisher (endless) runs: it has sent something before the subscriber is started."""
        with socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3)) as ear:  # ETH_P_ALL
            ear.bind(("right", 0))
            ear.settimeout(60)
            running = start(*publisher)
            try:
                while not any(ethertype in ear.recv(2048)[12:18] for ethertype in (b"\x88\xba", b"\x88\xb8")):
                    pass
                ear.close()
                return wire(*subscriber)
            finally:
                running.terminate()
                out, err = running.communicate(timeout=60)
                self.assertEqual(running.returncode, 0, err)
                self.sent = json.loads(out)

    def table_when(self, seen, publisher, *subscriber):
        """The subscriber's last line, as soon as `seen` holds for it. A process that is not scheduled for most of its window
        sees too little of what is sent, or nothing: another window is opened then. What it says of losses must hold in each."""
        for _ in range(20):
            done = self.while_publishing(publisher, *subscriber)
            self.assertEqual(done.returncode, 0, done.stderr)
            table = (lines(done.stdout) or [{"streams": []}])[-1]
            if table.get("dropped") == 0 and self.sent.get("worst_late_us", 0) < 50_000:
                self.assertEqual([(s["lost"], s["restarts"], s["duplicates"]) for s in table["streams"]], [(0, 0, 0)] * len(table["streams"]), table)
            if seen(table):
                break
        return table

    def test_samples_are_decoded_by_name(self):
        keys = ["app_id=0x4021", "sv_id=MU21", "vlan_id=100", "vlan_priority=6", "samples_per_frame=2", "clock_identity=17", "conf_rev=7",
                "send_smp_rate=true", "send_refr_tm=true", 'gm_identity="001122FFFE334455"', "data_set_name=MU/LLN0$d",
                "data_set={Ia: int32, q: quality, t: boolean}", "simulated=true"]
        done = self.while_publishing(["sv-pub", "left", "--amplitude", "1000", "--source", "02:00:00:00:00:77", *keys],
                                     "sv-sub", "right", "--frames", "--count", "20", *keys)
        self.assertEqual(done.returncode, 0, done.stderr)
        samples = lines(done.stdout)
        self.assertEqual(len(samples), 40)
        for a, b in zip(samples, samples[1:]):
            self.assertEqual(b["smp_cnt"], (a["smp_cnt"] + 1) % 4800)
        one = samples[0]
        self.assertEqual(one["vlan"], {"id": 100, "priority": 6})
        self.assertEqual((one["sv_id"], one["app_id"], one["conf_rev"], one["smp_synch"], one["simulated"]), ("MU21", 0x4021, 7, 17, True))
        self.assertEqual((one["smp_rate"], one["smp_mod"], one["gm_identity"], one["dat_set"]), (4800, 1, "001122FFFE334455", "MU/LLN0$d"))
        self.assertEqual(one["source"], "02:00:00:00:00:77")
        self.assertEqual(set(one["values"]), {"Ia", "q", "t"})
        self.assertGreater(max(abs(s["values"]["Ia"]) for s in samples), 300)

    def test_every_sample_of_a_frame_carries_its_own_time(self):
        keys = ["samples_per_frame=8", "send_refr_tm=true"]
        done = self.while_publishing(["sv-pub", "left", *keys], "sv-sub", "right", "--frames", "--count", "40", *keys)
        self.assertEqual(done.returncode, 0, done.stderr)
        samples = lines(done.stdout)
        self.assertEqual(len(samples), 320)
        for a, b in zip(samples, samples[1:]):
            self.assertAlmostEqual(b["refr_tm_ns"] - a["refr_tm_ns"], 1e9 / 4800, delta=200)  # 2^-24 s is 60 ns
        for s in samples:  # smpCnt 0 is at the second
            self.assertAlmostEqual(s["refr_tm_ns"] % 10**9, s["smp_cnt"] * 1e9 / 4800, delta=200)

    def test_currents_and_voltages_of_9_2_le_are_balanced(self):
        done = self.while_publishing(["sv-pub", "left", "--amplitude", "1000", "data_set=9-2LE"], "sv-sub", "right", "--frames", "--count", "20", "data_set=9-2LE")
        self.assertEqual(done.returncode, 0, done.stderr)
        for values in (s["values"] for s in lines(done.stdout)):
            for quantity in "IV":
                self.assertAlmostEqual(sum(values[quantity + phase] for phase in "abc"), values[quantity + "n"], delta=2)
            self.assertEqual([values["I" + phase] for phase in "abcn"], [values["V" + phase] for phase in "abcn"])

    def test_a_subscriber_takes_only_what_has_the_keys_that_were_named(self):
        other = ["sv-pub", "left", "app_id=0x4777", "mac=01:0C:CD:04:00:77", "sv_id=OTHER", "data_set=9-2LE"]
        for keys, taken in [(["app_id=0x4001"], False), (["mac=01:0C:CD:04:00:99"], False), (["sv_id=WANTED"], False),
                            (["app_id=0x4777", "mac=01:0C:CD:04:00:77", "sv_id=OTHER"], True), ([], True)]:
            for how in ([], ["--frames"]):
                how += ["--count", "5"] if taken else ["--duration", "0.3"]
                done = self.while_publishing(other, "sv-sub", "right", *how, *keys, "data_set=9-2LE")
                self.assertEqual(done.returncode, 0, done.stderr)
                seen = lines(done.stdout)
                names = {s["sv_id"] for s in seen} if "--frames" in how else {s["sv_id"] for line in seen for s in line["streams"]}
                self.assertEqual(names, {"OTHER"} if taken else set(), keys)
        message = ["goose-pub", "left", "control_block=IED/LLN0$GO$g", "app_id=0x8777", "mac=01:0C:CD:01:00:77", "data_set_name=IED/LLN0$d", "max_time_ms=20"]
        for keys, event in [(["app_id=0x8002"], "identity_mismatch"), (["mac=01:0C:CD:01:00:02"], "identity_mismatch"),
                            (["data_set_name=IED/LLN0$x"], "identity_mismatch"), (message[3:6], "first"), ([], "first")]:
            done = self.while_publishing(message, "goose-sub", "right", "--count", "1", "control_block=IED/LLN0$GO$g", *keys)
            self.assertEqual([(e["event"], e["accepted"]) for e in messages(done.stdout)], [(event, event == "first")], keys)

    def test_a_slow_stream_has_its_rate_and_loses_nothing(self):
        publisher = ["sv-pub", "left", "rate_hz=80", "sv_id=MU"]
        for verb in (["list", "right", "--json", "--once", "--duration", "2.5"], ["sv-sub", "right", "--duration", "2.5"]):
            # The rate is that of the window: it says nothing when the publisher was late in it.
            table = self.table_when(lambda t: t["streams"] and t["dropped"] == 0 and self.sent["worst_late_us"] < 50_000, publisher, *verb)
            stream, = table["streams"]
            self.assertEqual((stream["lost"], stream["restarts"], stream["duplicates"]), (0, 0, 0), stream)
            self.assertAlmostEqual(stream["rate_hz"], 80, delta=4)

    def test_a_smp_rate_that_does_not_fit_is_refused(self):
        refused = wire("sv-pub", "left", "rate_hz=65536", "send_smp_rate=true", "--duration", "1")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("smpRate cannot say 65536 samples a second", refused.stderr)

    def test_the_table_shows_streams_and_their_state(self):
        table = self.table_when(lambda t: t["dropped"] == 0 and [s["state"] for s in t["streams"]] == ["alive"] * 2,
                                ["sv-pub", "left", "--streams", "2", "sv_id=MU"], "list", "right", "--json", "--once", "--duration", "1")
        self.assertEqual([s["id"] for s in table["streams"]], ["MU", "MU_2"])
        self.assertEqual([s["state"] for s in table["streams"]], ["alive", "alive"])
        self.assertEqual([s["lost"] for s in table["streams"]], [0, 0])
        human = wire("list", "right", "--once", "--duration", "0.1")
        self.assertIn("link up", human.stdout)

    def test_a_change_of_state_is_seen_once_and_the_end_is_said(self):
        keys = ["control_block=IED/LLN0$GO$g", "min_time_ms=2", "max_time_ms=20", "live_min_ms=5000", "data_set={trip: boolean, pos: {stVal: position, q: quality}}"]
        before = listeners()
        subscriber = start("goose-sub", "right", "--duration", "60", *keys)
        while listeners() == before:  # it listens before anything is sent
            self.assertIsNone(subscriber.poll(), "the subscriber ended")
            time.sleep(0.001)
        done = wire("goose-pub", "left", "--duration", "1", "--toggle", "0.6", "--value", "pos.stVal=closed", "--value", "pos.q=0x0800", *keys)
        self.assertEqual(done.returncode, 0, done.stderr)
        events = []
        for line in subscriber.stdout:
            events.append(json.loads(line))
            if events[-1]["event"] == "expired":
                break
        subscriber.terminate()
        out, err = subscriber.communicate(timeout=60)
        self.assertEqual((subscriber.returncode, out), (0, ""), err)
        changes = json.loads(done.stdout)["states"] - 1  # one, unless the publisher was late for its end
        self.assertGreaterEqual(changes, 1)
        self.assertEqual([e["event"] for e in events if e["event"] in ("state_change", "expired")], ["state_change"] * changes + ["expired"])
        self.assertEqual(events[0]["event"], "first")
        self.assertEqual(events[0]["values"], "false, {closed, 0x0800}")
        self.assertEqual(events[-2]["values"], f"{'true' if changes % 2 else 'false'}, {{closed, 0x0800}}")

    def test_every_line_of_input_is_a_state_of_its_own(self):
        keys = ["control_block=IED/LLN0$GO$g", "data_set={b: boolean}"]
        subscriber = start("goose-sub", "right", "--duration", "20", "--count", "4", *keys)
        # What was sent before the subscriber was there is not seen: the pulse is repeated until it is.
        publisher = subprocess.Popen([GRIDSPACE, "wire", "goose-pub", "left", *keys, "min_time_ms=10000", "max_time_ms=10000", "--interactive"],
                                     stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        pulses = 0
        while subscriber.poll() is None:
            publisher.stdin.write("b=true\nb=true\nb=false\n")
            publisher.stdin.flush()
            pulses += 1
            with contextlib.suppress(subprocess.TimeoutExpired):
                subscriber.wait(timeout=0.2)
        publisher.terminate()
        summary = json.loads(publisher.communicate(timeout=20)[0])
        messages = lines(subscriber.communicate(timeout=20)[0])
        self.assertEqual(summary["st_num"], 1 + 2 * pulses, "the second b=true changes nothing")
        for m in messages:  # odd states are those after a pulse
            self.assertEqual((m["values"], m["sq_num"]), ("false" if m["st_num"] % 2 == 1 else "true", 0))
            self.assertEqual(m["t_quality"], "synchronised, 10 bits")
        self.assertEqual([m["st_num"] - messages[0]["st_num"] for m in messages], [0, 1, 2, 3])

    def test_what_a_subscriber_prints_can_be_published(self):
        keys = ["control_block=IED/LLN0$GO$g", "data_set={os: {type: octet_string, length: 5}, t: timestamp, bs: {type: bit_string, length: 4}}"]
        values = ["0102ff0405", "1575158400.250000000", "0011"]
        said = [argument for name, value in zip(("os", "t", "bs"), values) for argument in ("--value", f"{name}={value}")]
        done = self.while_publishing(["goose-pub", "left", "max_time_ms=20", *said, *keys], "goose-sub", "right", "--count", "1", *keys)
        self.assertEqual(lines(done.stdout)[0]["values"], ", ".join(values))

    def test_a_clock_that_is_not_synchronised_is_so_in_the_times_too(self):
        for synch, quality in (("none", "not synchronised, 10 bits"), ("global", "synchronised, 10 bits")):
            done = self.while_publishing(["sv-pub", "left", f"synch={synch}", "send_refr_tm=true"], "sv-sub", "right", "--frames", "--count", "1")
            self.assertEqual(lines(done.stdout)[0]["refr_tm_quality"], quality)

    def test_who_could_send_nothing_says_so_at_the_end(self):
        subprocess.run(["ip", "link", "set", "left", "down"], check=True)
        for tool in ("sv-pub", "goose-pub"):
            done = wire(tool, "left", "--duration", "0.2")
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertEqual(json.loads(done.stdout)["sent"], 0)
            self.assertIn("no frame was sent on 'left'", done.stderr)

    def test_a_subscriber_with_a_file_checks_the_data_set_too(self):
        file = self.folder / "streams.yaml"
        file.write_text('streams:\n  G: {kind: goose, mac: "01:0C:CD:01:00:01", control_block: IED/LLN0$GO$g, data_set_name: IED/LLN0$Own,\n'
                        '      max_time_ms: 20, data_set: {trip: boolean}}\n')
        for data_set, event, accepted in [("IED/LLN0$Own", "first", True), ("IED/LLN0$Other", "identity_mismatch", False)]:
            done = self.while_publishing(["goose-pub", "left", "control_block=IED/LLN0$GO$g", f"data_set_name={data_set}", "max_time_ms=20", "data_set={trip: boolean}"],
                                         "goose-sub", "right", "--file", str(file), "--stream", "G", "--count", "1")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual([(e["event"], e["accepted"], e["dat_set"]) for e in messages(done.stdout)], [(event, accepted, data_set)])

    def test_a_capture_is_replayed_and_judged(self):
        capture = self.folder / "c.pcapng"
        shutil.copy(pathlib.Path(os.environ["GRIDSPACE_SOURCE_DIR"]) / "tests/fuzz/corpus/pcapng/one_section", capture)
        subscriber = start("sv-sub", "right", "--frames", "--duration", "2")
        replayed = wire("replay", str(capture), "left", "--loop", "3", "--speed", "0")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertEqual(json.loads(replayed.stdout)["sent"], 6)
        subscriber.communicate(timeout=30)
        stats = wire("stats", str(capture), "--json")
        self.assertEqual(stats.returncode, 0, stats.stderr)
        stream = json.loads(stats.stdout)["streams"][0]
        self.assertEqual((stream["id"], stream["frames"], stream["delay_ms"]), ("TL11MU01", 2, None))
        self.assertIn("not measurable", wire("stats", str(capture)).stdout)

    def pcap(self, frames, link_type=1, kept=65535):
        """A classic capture of (seconds, frame), written here."""
        file = self.folder / "own.pcap"
        out = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, kept, link_type)
        for seconds, frame in frames:
            out += struct.pack("<IIII", int(seconds), round(seconds % 1 * 1e6), min(len(frame), kept), len(frame)) + frame[:kept]
        file.write_bytes(out)
        return str(file)

    @staticmethod
    def samples(count, skip=lambda k: False):
        return [(k / 4800, sv([asdu("MU", k % 4800, bytes(12)), asdu("OTHER", k % 4800, bytes(4))])) for k in range(count) if not skip(k)]

    def statistics(self, file):
        done = wire("stats", file, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_every_stream_of_a_frame_is_judged_and_what_is_lost_at_the_wrap_is_lost(self):
        judged = self.statistics(self.pcap(self.samples(9600, lambda k: k % 100 == 0)))
        for stream in judged["streams"]:
            self.assertEqual((stream["frames"], stream["lost"], stream["restarts"], stream["wrap"]), (9504, 95, 0, 4800), stream["id"])
            self.assertEqual(stream["interval_ms"]["count"], 9503, stream["id"])
        self.assertEqual([stream["id"] for stream in judged["streams"]], ["MU", "OTHER"])

    def test_a_publisher_that_begins_anew_is_told_from_a_counter_that_turns_over(self):
        judged = self.statistics(self.pcap([(k / 4800, sv([asdu("MU", k % 777, bytes(12))])) for k in range(1000)]))
        self.assertEqual((judged["streams"][0]["restarts"], judged["streams"][0]["wrap"]), (1, None))

    def test_frames_that_a_capture_holds_in_part_are_not_sent(self):
        cut = self.pcap(self.samples(10), kept=40)
        self.assertEqual((self.statistics(cut)["cut"], self.statistics(cut)["undecodable"]), (10, 10))
        refused = wire("replay", cut, "left")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("cut by the capture", refused.stderr)
        mixed = self.pcap([(0, b"short"), (0, bytes(12) + b"\x08\x00" + bytes(46)), *self.samples(3)])
        self.assertEqual(json.loads(wire("replay", mixed, "left").stdout) | {"worst_late_us": 0},
                         {"sent": 3, "not_sent": 0, "left_out": 2, "worst_late_us": 0})

    def test_a_replay_says_what_it_could_not_do(self):
        whole = self.pcap(self.samples(10))
        done = wire("replay", whole, "left", "--only", "zz")
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no interface 'zz'", done.stderr)
        self.assertIn("there are: pcap", done.stderr)
        cut = self.folder / "cut.pcap"
        cut.write_bytes(pathlib.Path(whole).read_bytes()[:-5])
        done = wire("replay", str(cut), "left", "--speed", "0")
        self.assertEqual((done.returncode, json.loads(done.stdout)["sent"]), (0, 9))
        self.assertIn("ends in the middle of a frame", done.stderr)
        jumbo = (0, sv([asdu("MU", 0, bytes(3000))]))
        for frames, code, text in [([jumbo, jumbo], 3, "no frame was sent on 'left'"), ([jumbo, *self.samples(3)], 0, "1 frame was not sent on 'left'")]:
            done = wire("replay", self.pcap(frames), "left", "--speed", "0")
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(text, done.stderr)
            self.assertIn("Message too long", done.stderr)

    def test_a_capture_of_another_link_type_is_no_ethernet(self):
        file = self.pcap(self.samples(10), link_type=101)
        judged = self.statistics(file)
        self.assertEqual((judged["no_ethernet"], judged["streams"]), (10, []))
        refused = wire("replay", file, "left")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("its link type is not Ethernet", refused.stderr)

    def test_many_streams_carry_into_the_address_above(self):
        table = self.table_when(lambda t: len(t["streams"]) >= 32, ["sv-pub", "left", "--streams", "32", "mac=01:0C:CD:04:00:F0", "app_id=0x4000", "rate_hz=100"],
                                "list", "right", "--json", "--once", "--duration", "0.5")
        places = {s["app_id"]: s["destination"] for s in table["streams"]}
        self.assertEqual(sorted(places), list(range(0x4000, 0x4020)))
        self.assertEqual((places[0x400F], places[0x4010], places[0x401F]), ("01:0C:CD:04:00:FF", "01:0C:CD:04:01:00", "01:0C:CD:04:01:0F"))

    def test_a_replay_on_a_real_interface_is_refused(self):
        subprocess.run("ip link add bridge7 type bridge && ip link set bridge7 up", shell=True, check=True)
        try:
            capture = pathlib.Path(os.environ["GRIDSPACE_SOURCE_DIR"]) / "tests/fuzz/corpus/pcapng/one_section"
            refused = wire("replay", str(capture), "bridge7")
            self.assertEqual(refused.returncode, 2)
            self.assertIn("--allow-attacks-on bridge7", refused.stderr)
            self.assertEqual(wire("replay", str(capture), "bridge7", "--allow-attacks-on", "bridge7", "--speed", "0").returncode, 0)
        finally:
            subprocess.run(["ip", "link", "del", "bridge7"], check=True)

    def test_streams_that_scl_cannot_say_are_told_at_their_lines_and_the_others_can_be_chosen(self):
        file, cid = self.folder / "two.yaml", self.folder / "two.cid"
        file.write_text('streams:\n  BAD: {kind: goose, mac: "01:0C:CD:01:00:01", app_id: 1, control_block: IED/LLN0$GO$a-b, data_set: {x: boolean}}\n'
                        '  GOOD: {kind: goose, mac: "01:0C:CD:01:00:02", app_id: 2, control_block: IED/LLN0$GO$a_b, data_set: {x: boolean}}\n')
        export = lambda *more: subprocess.run([GRIDSPACE, "scl", "export", str(file), "--out", str(cid), *more], capture_output=True, text=True, timeout=60)
        refused = export()
        self.assertEqual(refused.returncode, 2)
        for words in ("two.yaml:2:3: error: stream 'BAD'", "'IED/LLN0$GO$a-b'", "1 of 2 streams", "--stream GOOD"):
            self.assertIn(words, refused.stderr)
        self.assertFalse(cid.exists())
        self.assertEqual(export("--stream", "GOOD").returncode, 0)
        again = subprocess.run([GRIDSPACE, "scl", "import", str(cid), "--streams-only"], capture_output=True, text=True, timeout=60)
        self.assertIn("control_block: IED/LLN0$GO$a_b", again.stdout)
        self.assertEqual(export("--stream", "GOD").returncode, 2)

    def test_mistakes_are_explained(self):
        for arguments, code, text in [
            (["list", "nosuch0"], 3, "there is no network interface 'nosuch0'"),
            (["sv-pub", "left", "sv_idd=x"], 2, "did you mean"),
            (["sv-pub", "left", "mac=01:02"], 2, "is not an Ethernet address"),
            (["sv-pub", "left", "data_set={a: flaot32}"], 2, "float32"),
            (["goose-pub", "left", "--value", "statu=true"], 2, "assigns nothing"),
            (["goose-pub", "left", "--value", "status=7"], 2, "true or false"),
            (["goose-pub", "left", "data_set={n: int32}", "--toggle", "1", "--duration", "1"], 2, "no Boolean to toggle"),
            (["goose-pub", "left", "data_set={os: {type: octet_string, length: 2}}", "--value", "os=abc"], 2, "two hexadecimal digits"),
            (["stats", "/nonexistent"], 2, "cannot read"),
            (["replay", "/etc/hostname", "left"], 2, "is not a capture"),
            (["sv-pub", "left", "--source", "x", "--duration", "1"], 2, "is not an Ethernet address"),
            (["sv-pub", "left", "--streams", "64", "app_id=0xFFF0"], 2, "the APPID of stream 17 would be 0x10000"),
            (["sv-pub", "left", "data_set={}"], 2, "the data set is empty"),
            (["goose-pub", "left", "data_set={n: int64}", "--value", "n=-9223372036854775809"], 2, "is no value of 'n'"),
            (["stats", "/"], 2, "is a folder"),
            (["replay", "/", "left"], 2, "is a folder"),
        ]:
            done = wire(*arguments)
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
            self.assertIn(text, done.stderr, arguments)


if __name__ == "__main__":
    own_namespace.main()
