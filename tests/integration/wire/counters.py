# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What devices without a run count of their streams (topic stream_statistics), seen through a monitor beside them."""
import json
import os
import pathlib
import subprocess
import time

BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", "build/release/bin")).resolve()
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
HANG_S = 60


class Counters:
    """For a TestCase with `folder`, and `running`: processes that it ends."""

    def until(self, condition, what):
        deadline = time.monotonic() + HANG_S
        while not (found := condition()):
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.05)
        return found

    def start_monitor(self, domain):
        config, log = self.folder / "monitor.yaml", self.folder / "monitor.log"
        config.write_text(json.dumps({
            "process": "monitor", "program": "gridspace-monitor",
            "bus": {"qos": str(SOURCE / "qos/monitor.xml"), "management": {"domain": domain, "addresses": ["10.99.0.1"]}},
            "settings": {"listen": "127.0.0.1:0"}}))
        with open(log, "w", encoding="utf-8") as out:
            self.running.append(subprocess.Popen([BIN / "gridspace-monitor", "--config", config], stdout=out, stderr=out))
        self.address = self.until(lambda: next((w for w in log.read_text().split() if w.startswith("http://")), None), "no monitor")

    def rows_when(self, streams, condition):
        """By stream: what has been counted, as soon as `condition` holds for it."""
        def look():
            done = subprocess.run([BIN / "gridspace", "topic", "echo", "stream_statistics", "--run", self.address, "--json"], capture_output=True,
                                  text=True, check=False, timeout=HANG_S)
            last = json.loads(done.stdout)["last"] if done.returncode == 0 else []
            rows = {entry["fields"]["stream"]: entry["fields"] for entry in last}
            return rows if set(streams) <= set(rows) and condition(rows) else None
        return self.until(look, f"the counters of {streams} do not come to what is waited for")

    def assert_zero(self, rows, stream, *counters):
        for counter in counters:
            self.assertEqual(int(rows[stream][counter]), 0, (stream, counter, rows[stream]))
