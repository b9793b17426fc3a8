# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Clients of a live run that ask for everything and read nothing."""
import json
import socket

import client

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
            out.send(json.dumps({"op": "view", "id": f"v{i}", "names": names[i::8][:64], "window_s": -1, "px": 4000}))
        return out

    @classmethod
    def foxglove(cls, monitor):
        out = cls(monitor, "/", ["Sec-WebSocket-Protocol: foxglove.websocket.v1"])
        while True:  # until channels are told; then it reads no more
            text = out.receive()
            told = json.loads(text) if isinstance(text, str) else {}
            if told.get("op") == "advertise":
                ids = [c["id"] for c in told["channels"]]
                out.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": i, "channelId": i} for i in ids]}))
                return out


class NarrowMonitor(client.Monitor):
    """Reached through sockets that hold next to nothing."""

    def socket(self):
        out = socket.socket()
        out.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        out.settimeout(client.PATIENCE_S)
        out.connect((self.host, self.port))
        return out


def slow_clients_of(address):
    """Ten of them, as soon as there is something to ask for: dashboards, and two that speak Foxglove's protocol."""
    found = address.until("/api/v1/signals", lambda s: sum("value" in e for e in s["signals"]) > 20, "signals")
    narrow, names = NarrowMonitor(f"http://{address.host}:{address.port}"), [s["name"] for s in found["signals"]]
    return [SlowClient.dashboard(narrow, names) for _ in range(CLIENTS - 2)] + [SlowClient.foxglove(narrow) for _ in range(2)]


def dropped_for_slow_clients(address):
    """Messages that the monitor could not send."""
    lines = address.get("/metrics").body.decode().splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith("gridspace_monitor_dropped_total "))
