# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run is the same with the monitor and without it, whoever looks, however slowly."""
import json
import socket
import unittest

import client
import harness

CASE_2 = harness.SOURCE / "configs/scenarios/protection_lockstep.yaml"
SHORT = ["--set", "simulation.duration_s=0.4", "--set", "events.fault.at_s=0.2", "--set", "expect=~"]
CLIENTS = 10


class SlowClient(client.WebSocket):
    """Asks for more than the monitor can send to somebody who reads nothing."""

    def __init__(self, monitor, path, headers):
        super().__init__(monitor, path, headers)
        assert self.status == 101

    @classmethod
    def dashboard(cls, monitor, names):
        out = cls(monitor, "/ws/v1", [])
        for i in range(8):
            out.send_text(json.dumps({"op": "view", "id": f"v{i}", "names": names[i::8][:64], "window_s": -1, "px": 4000}))
        return out

    @classmethod
    def foxglove(cls, monitor):
        out = cls(monitor, "/", ["Sec-WebSocket-Protocol: foxglove.websocket.v1"])
        while True:  # until channels are told; then it reads no more
            text = out.receive()
            told = json.loads(text) if isinstance(text, str) else {}
            if told.get("op") == "advertise":
                ids = [c["id"] for c in told["channels"]]
                out.send_text(json.dumps({"op": "subscribe", "subscriptions": [{"id": i, "channelId": i} for i in ids]}))
                return out

    def send_text(self, text):
        content = text.encode()
        head = bytes([129]) + (bytes([128 | len(content)]) if len(content) < 126 else bytes([254]) + len(content).to_bytes(2, "big"))
        self.socket.sendall(head + b"\0\0\0\0" + content)


class SlowMonitor(client.Monitor):
    def socket(self):
        out = socket.socket()
        out.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        out.settimeout(client.PATIENCE_S)
        out.connect((self.host, self.port))
        return out


class Lockstep(harness.ScenarioTest):
    def test_ten_slow_clients_change_nothing(self):
        alone = self.run_to_end("alone", [*SHORT, "--set", "processes.monitor=~"], scenario=CASE_2)
        watched = self.start("watched", [*SHORT, "--speed", "0.05"], scenario=CASE_2)  # slow enough for all of them to come
        address = client.monitor_of(watched)
        monitor = SlowMonitor(f"http://{address.host}:{address.port}")
        listed = address.until("/api/v1/signals", lambda s: sum("value" in e for e in s["signals"]) > 20, "signals")["signals"]
        names = [s["name"] for s in listed]
        slow = [SlowClient.dashboard(monitor, names) for _ in range(CLIENTS - 2)] + [SlowClient.foxglove(monitor) for _ in range(2)]

        def dropped():
            lines = address.get("/metrics").body.decode().splitlines()
            return sum(int(line.split()[1]) for line in lines if line.startswith("gridspace_monitor_dropped_total "))
        while dropped() == 0:  # they are slow indeed
            self.assertIsNone(watched.process.poll(), "the run ended before a client was too slow")
        self.assertEqual(watched.finish(), harness.OK, watched.stderr())
        for one in slow:
            one.close()
        self.assert_identical(alone, watched)

        # The negative control: another run is another one.
        other = self.run_to_end("other", [*SHORT, "--set", "processes.monitor=~", "--set", "events.fault.at_s=0.21"], scenario=CASE_2)
        code, _ = self.compare(alone, other)
        self.assertEqual(code, harness.EXPECTATION)


if __name__ == "__main__":
    unittest.main()
