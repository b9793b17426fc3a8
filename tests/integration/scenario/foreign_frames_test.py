# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames that nobody of a lockstep run has announced change nothing in it, and are counted by link and source."""
import re
import unittest

from harness import SHORT_CASE_2, ScenarioTest
from pcapng_file import Capture

HEARD = """
def wait_for_the_run():
    ears = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
    ears.bind(("process_bus", 0))
    while True:
        frame, where = ears.recvfrom(64)
        if where[2] != socket.PACKET_OUTGOING and frame[12:14] in (b"\\x88\\xba", b"\\x88\\xb8", b"\\x81\\x00"):
            return
"""

# Sampled values, GOOSE and others, plain and tagged, as fast as they go: half of them before the start, the rest when the run sends.
STRANGER = "import itertools, random, socket, sys, time" + HEARD + """
source, most = bytes.fromhex(sys.argv[1]), int(sys.argv[2])
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
port.bind(("process_bus", 0))
noise = random.Random(1)
for n in range(most):
    if n == most // 2:
        wait_for_the_run()
    kind = (b"\\x88\\xb8", b"\\x88\\xba", b"\\x88\\xb5", b"\\x81\\x00\\x80\\x05\\x88\\xba")[n % 4]
    destination = bytes.fromhex("010ccd040021" if n % 3 else "ffffffffffff")
    try:
        port.send(destination + source + kind + noise.randbytes(noise.choice((46, 100, 1400))))
    except OSError:
        pass  # the queue is full, or the link is not up yet
time.sleep(3600)
"""

# The same ethertypes and group address as the streams of the run, without a pause, as soon as the run sends.
FLOODER = "import socket, sys, time" + HEARD + """
source, most = bytes.fromhex(sys.argv[1]), int(sys.argv[2])
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
port.bind(("process_bus", 0))
frames = [bytes.fromhex("010ccd040021") + source + kind + bytes([n]) * 50 for n in range(256) for kind in (b"\\x88\\xba", b"\\x88\\xb8")]
wait_for_the_run()
for n in range(most):
    try:
        port.send(frames[n % len(frames)])
    except OSError:
        pass  # the queue is full
time.sleep(3600)
"""

# What it hears, once more: from its own address, or as it was.
COPIER = """
import socket, sys
source, keep = bytes.fromhex(sys.argv[1]), sys.argv[2] == "1"
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
port.bind(("process_bus", 0))
print("listening", flush=True)
while True:
    frame, where = port.recvfrom(2048)
    if where[2] == socket.PACKET_OUTGOING or frame[12:14] not in (b"\\x88\\xba", b"\\x88\\xb8", b"\\x81\\x00"):
        continue
    try:
        port.send(frame if keep else frame[:6] + source + frame[12:])
    except OSError:
        pass
"""

SCENARIO = """---
gridspace: 1
extends: base.yaml
name: strangers
hosts: {{evil: {{links: [process_bus]}}}}
processes:
  stranger:
    program: exec
    host: evil
    command: [python3, {script}, "{source}", "{frames}"]
    {ready}
"""
FOREIGN = "020000000099"


def frames_of(run):
    """(time, octets) of the capture, wherever they were seen; without the VLAN tag, which the kernel takes off the copier's frames."""
    untagged = lambda octets: octets[:12] + octets[16:] if octets[12:14] == b"\x81\x00" else octets  # noqa: E731
    return sorted((p.time_ns, untagged(p.octets)) for p in Capture(run.folder / "bus.pcapng.gz").packets)


class ForeignFrames(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.write("base.yaml", SHORT_CASE_2)
        self.script = self.write("stranger.py", STRANGER)

    def run_beside(self, name, frames, ready=""):
        text = SCENARIO.format(script=self.script, source=FOREIGN, frames=frames, ready=ready)
        return self.run_to_end(name, scenario=self.write(f"{name}.yaml", text))

    def test_the_fastest_flood_that_a_host_can_send_loses_no_frame_of_the_run(self):
        self.write("base.yaml", SHORT_CASE_2 + "clock: {speed: 0.05}\n")  # time enough
        calm = self.run_beside("calm", 0)
        self.script = self.write("flooder.py", FLOODER)
        flooded = self.run_beside("flooded", 100_000)
        self.assert_identical(calm, flooded)
        said = [event["text"] for event in flooded.events() if event["event"] == "foreign_frames"]
        self.assertGreater(sum(int(t.split()[0]) for t in said if "'process_bus'" in t), 20_000)

    def test_copies_of_the_run_s_own_frames_change_nothing(self):
        calm = self.run_beside("calm", 0)
        self.script = self.write("copier.py", COPIER)
        for name, keep, source in (("under_another_address", 0, FOREIGN), ("as_they_were", 1, "024753")):
            copied = self.run_beside(name, keep, ready="ready: {says: listening, within_s: 60}")  # the run may be shorter than its start
            if keep:  # a copy may come first: the capture then has it, at the port of the copier and without a tag
                self.assertGreater(len(frames_of(calm)), 500)
                self.assertEqual(frames_of(calm), frames_of(copied))
                for run in (calm, copied):
                    (run.folder / "bus.pcapng.gz").unlink()
            else:
                self.assertEqual((calm.folder / "bus.pcapng.gz").read_bytes(), (copied.folder / "bus.pcapng.gz").read_bytes())
            self.assert_identical(calm, copied)
            said = " ".join(event["text"] for event in copied.events() if event["event"] == "foreign_frames")
            self.assertRegex(said, "from " + ":".join(source[i:i + 2] for i in range(0, len(source), 2)), name)

    def test_a_flood_on_a_link_changes_nothing_and_is_counted(self):
        self.write("base.yaml", SHORT_CASE_2 + "clock: {speed: 0.2}\n")  # time enough
        calm = self.run_beside("calm", 0)
        flooded = self.run_beside("flooded", 20_000)
        self.assert_identical(calm, flooded)
        self.assertEqual((calm.folder / "bus.pcapng.gz").read_bytes(), (flooded.folder / "bus.pcapng.gz").read_bytes())
        said = [event["text"] for event in flooded.events() if event["event"] == "foreign_frames"]
        for ethertype in ("0x88ba", "0x88b8"):
            text = next(t for t in said if ethertype in t and "'process_bus'" in t)
            self.assertGreater(int(re.search(r"(\d+) from 02:00:00:00:00:99", text)[1]), 100, text)
        self.assertGreater(sum(int(t.split()[0]) for t in said if "'process_bus'" in t), 5_000, "looked at or not, they are counted")
        self.assertTrue(any("neither SMV, GOOSE nor IP" in t and "from 02:00:00:00:00:99" in t for t in said), said)
        page = (flooded.folder / "report" / "index.html").read_text()
        self.assertRegex(page, r"Not of this run(.|\n)*<td>process_bus</td><td>relay2</td><td>\d+ frames of ethertype 0x88ba .*from 02:00:00:00:00:99")
        self.assertNotIn("Not of this run", (calm.folder / "report" / "index.html").read_text())
        self.assertEqual([e for e in calm.events() if e["event"] == "foreign_frames"], [], "nothing of ours is foreign")


if __name__ == "__main__":
    unittest.main()
