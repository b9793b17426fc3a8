# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames that nobody of a lockstep run has announced change nothing in it, and are counted by link and source."""
import re
import unittest

from harness import SHORT_CASE_2, ScenarioTest

# Sampled values, GOOSE and others, plain and tagged, as fast as they go: from before the start until it is ended.
STRANGER = """
import itertools, random, socket, sys, time
source, most = bytes.fromhex(sys.argv[1]), int(sys.argv[2])
port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
port.bind(("process_bus", 0))
noise = random.Random(1)
sent = 0
for n in itertools.count():
    if n >= most:
        time.sleep(0.001 if most else 1)
        if not most:
            continue
    kind = (b"\\x88\\xb8", b"\\x88\\xba", b"\\x88\\xb5", b"\\x81\\x00\\x80\\x05\\x88\\xba")[n % 4]
    destination = bytes.fromhex("010ccd040021" if n % 3 else "ffffffffffff")
    try:
        port.send(destination + source + kind + noise.randbytes(noise.choice((46, 100, 1400))))
    except OSError:
        pass  # the queue is full, or the link is not up yet
"""

SCENARIO = """---
gridspace: 1
extends: base.yaml
name: strangers
hosts: {{evil: {{links: [process_bus]}}}}
processes:
  stranger: {{program: exec, host: evil, command: [python3, {script}, "{source}", "{frames}"]}}
"""
FOREIGN = "020000000099"


class ForeignFrames(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.write("base.yaml", SHORT_CASE_2)
        self.script = self.write("stranger.py", STRANGER)

    def run_beside(self, name, frames):
        text = SCENARIO.format(script=self.script, source=FOREIGN, frames=frames)
        return self.run_to_end(name, scenario=self.write(f"{name}.yaml", text))

    def test_a_flood_on_a_link_changes_nothing_and_is_counted(self):
        calm = self.run_beside("calm", 0)
        flooded = self.run_beside("flooded", 20_000)
        self.assert_identical(calm, flooded)
        self.assertEqual((calm.folder / "bus.pcapng").read_bytes(), (flooded.folder / "bus.pcapng").read_bytes())
        said = [event["text"] for event in flooded.events() if event["event"] == "foreign_frames"]
        for ethertype in ("0x88ba", "0x88b8"):
            text = next(t for t in said if ethertype in t and "'process_bus'" in t)
            self.assertGreater(int(re.search(r"(\d+) from 02:00:00:00:00:99", text)[1]), 1024, text)
        self.assertTrue(any("neither SMV, GOOSE nor IP" in t and "from 02:00:00:00:00:99" in t for t in said), said)
        self.assertEqual([e for e in calm.events() if e["event"] == "foreign_frames"], [], "nothing of ours is foreign")


if __name__ == "__main__":
    unittest.main()
