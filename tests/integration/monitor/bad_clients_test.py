# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Bad clients of a live run: each is told so, and nobody else notices. How fast is a figure: it is printed, and measured by
bench/monitor/bad_clients.py."""
import json
import socket
import time
import unittest

import client
import harness

KEY = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
LOCAL = "Host: localhost\r\n"
STOP = 'Content-Length: 17\r\n\r\n{"action":"stop"}'
BAD = {
    "no HTTP": ("hello?\r\n\r\n", 400),
    "octets of all kinds": (bytes(range(256)) * 4 + b"\r\n\r\n", 400),
    "wrong Host": ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", 403),
    "no Host": ("GET / HTTP/1.1\r\n\r\n", 403),
    "wrong Origin": (f"GET /api/v1/run HTTP/1.1\r\n{LOCAL}Origin: https://evil.example\r\n\r\n", 403),
    "../": (f"GET /../../etc/passwd HTTP/1.1\r\n{LOCAL}\r\n", 400),
    "%2e%2e%2f": (f"GET /%2e%2e%2f%2e%2e%2fetc/passwd HTTP/1.1\r\n{LOCAL}\r\n", 400),
    "NUL in the path": (f"GET /a%00b HTTP/1.1\r\n{LOCAL}\r\n", 400),
    "absolute address": (f"GET http://evil.example/ HTTP/1.1\r\n{LOCAL}\r\n", 400),
    "20 kB header": (f"GET / HTTP/1.1\r\n{LOCAL}X: {'a' * 20_000}\r\n\r\n", 431),
    "huge body": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}Content-Length: 100000000\r\n\r\n", 413),
    "two lengths": (f"POST /a HTTP/1.1\r\n{LOCAL}Content-Length: 2\r\nContent-Length: 3\r\n\r\nabc", 400),
    "length and chunks": (f"POST /a HTTP/1.1\r\n{LOCAL}Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    "DELETE": (f"DELETE /api/v1/run HTTP/1.1\r\n{LOCAL}\r\n", 405),
    "nothing there": (f"GET /nowhere HTTP/1.1\r\n{LOCAL}\r\n", 404),
    "control without a token": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}{STOP}", 401),
    "control with a wrong one": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}Authorization: Bearer 0\r\n{STOP}", 401),
    "WebSocket elsewhere": (f"GET /nowhere HTTP/1.1\r\n{LOCAL}{KEY}\r\n", 404),
    "WebSocket of a stranger's page": (f"GET /ws/v1 HTTP/1.1\r\n{LOCAL}Origin: https://evil.example\r\n{KEY}\r\n", 403),
}


def try_one(monitor, request):
    """(status, seconds until it was there)"""
    with socket.create_connection((monitor.host, monitor.port), timeout=client.PATIENCE_S) as s:
        began = time.monotonic()
        try:
            s.sendall(request.encode() if isinstance(request, str) else request)
            answer = s.recv(65536)
        except ConnectionError:  # it has heard enough before all was said
            answer = b""
        took = time.monotonic() - began
    return int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else None, took


def good(monitor, repeat):
    times = []
    for _ in range(repeat):
        began = time.monotonic()
        assert monitor.get("/api/v1/run").status == 200
        times.append(time.monotonic() - began)
    return client.percentiles(times)


def assault(monitor, repeat, tell=print):
    """Everything that a bad client does; what was not as expected, one text each."""
    wrong = []
    for name, (request, wanted) in BAD.items():
        outcomes = [try_one(monitor, request) for _ in range(repeat)]
        wrong += [f"{name}: {status}, expected {wanted}" for status, _ in outcomes if status != wanted]
        tell(f"{name:<34} {wanted}   {client.percentiles([t for _, t in outcomes])}")
    tell(f"{'a good request':<34} 200   {good(monitor, repeat)}")
    crowd = [socket.create_connection((monitor.host, monitor.port), timeout=client.PATIENCE_S) for _ in range(1000)]
    for s in crowd[::2]:
        s.sendall(b"GET / HT")
    tell(f"{'a good one beside 1000 sockets':<34} 200   {good(monitor, repeat)}")
    for s in crowd:
        s.close()
    names = [s["name"] for s in monitor.json("/api/v1/signals")["signals"]]
    slow = [monitor.web_socket() for _ in range(64)]
    wrong += [f"WebSocket: {push.status}" for push in slow if push.status != 101]
    for push in slow:
        push.send(json.dumps({"op": "view", "id": "v", "names": names[:40], "window_s": -1, "px": 4000}))
    tell(f"{'a good one beside 64 slow readers':<34} 200   {good(monitor, repeat)}")
    for push in slow:
        push.close()
    state = monitor.json("/api/v1/run")
    wrong += [f"{p['name']} is {p['state']}" for p in state["processes"] if p["state"] != "alive"]
    if state["state"] != "running":
        wrong.append(f"the run is {state['state']}")
    return wrong


class BadClients(harness.ScenarioTest):
    def test_each_is_told_so_and_the_run_goes_on(self):
        run = self.start("run", ["--speed", "60", "--allow-control"])
        monitor = client.monitor_of(run)
        monitor.until("/api/v1/run", lambda r: r["state"] == "running" and r["time_s"] > 0, "the run to run")
        self.assertEqual(assault(monitor, 5), [])
        before = monitor.json("/api/v1/run")["time_s"]
        monitor.until("/api/v1/run", lambda r: r["time_s"] > before, "time to pass")
        token = (run.folder / "control.token").read_text().strip()
        self.assertEqual(monitor.ask("POST", "/api/v1/control", '{"action":"stop"}', {"Authorization": f"Bearer {token}"}).status, 202)
        run.finish()


if __name__ == "__main__":
    unittest.main()
