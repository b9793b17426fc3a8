#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""How fast bad clients are turned away, and whether anybody else notices: on a live run, beside a client that behaves.

  python3 bench/monitor/bad_clients.py [--build build/release] [--repeat 200]

Prints for each kind the status and the time until it was there; then how long a good request took meanwhile, with 1000 sockets open and
with slow readers. That the status is right and that others are served is tested in tests/; the times are figures of this machine."""
import argparse
import json
import os
import pathlib
import signal
import socket
import statistics
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEY = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
LOCAL = "Host: localhost\r\n"
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
    "1 MB header": (f"GET / HTTP/1.1\r\n{LOCAL}X: {'a' * 1_000_000}\r\n\r\n", 431),
    "huge body": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}Content-Length: 100000000\r\n\r\n", 413),
    "two lengths": (f"POST /a HTTP/1.1\r\n{LOCAL}Content-Length: 2\r\nContent-Length: 3\r\n\r\nabc", 400),
    "length and chunks": (f"POST /a HTTP/1.1\r\n{LOCAL}Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    "DELETE": (f"DELETE /api/v1/run HTTP/1.1\r\n{LOCAL}\r\n", 405),
    "nothing there": (f"GET /nowhere HTTP/1.1\r\n{LOCAL}\r\n", 404),
    "control without a token": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}Content-Length: 17\r\n\r\n" + '{"action":"stop"}', 401),
    "control with a wrong one": (f"POST /api/v1/control HTTP/1.1\r\n{LOCAL}Authorization: Bearer 0\r\nContent-Length: 17\r\n\r\n" + '{"action":"stop"}', 401),
    "WebSocket elsewhere": (f"GET /nowhere HTTP/1.1\r\n{LOCAL}{KEY}\r\n", 404),
    "WebSocket of a stranger's page": (f"GET /ws/v1 HTTP/1.1\r\n{LOCAL}Origin: https://evil.example\r\n{KEY}\r\n", 403),
}


def percentiles(times):
    times = sorted(1e3 * t for t in times)
    return f"p50 {statistics.median(times):6.2f} ms   p99 {times[int(0.99 * (len(times) - 1))]:6.2f} ms   most {times[-1]:6.2f} ms"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeat", type=int, default=200)
    arguments = parser.parse_args()
    os.environ["GRIDSPACE_BIN_DIR"] = str(arguments.build.resolve() / "bin")
    sys.path.insert(0, str(ROOT / "tests/integration/monitor"))
    import client
    import harness

    run = harness.Run(pathlib.Path(tempfile.mkdtemp(prefix="gridspace-bad-")) / "run", harness.CASE_1, ["--speed", "60", "--allow-control"])
    try:
        monitor = client.monitor_of(run)
        monitor.until("/api/v1/run", lambda r: r["state"] == "running", "the run to run")
        where = (monitor.host, monitor.port)
        failed = 0
        for name, (request, wanted) in BAD.items():
            request = request.encode() if isinstance(request, str) else request
            times, status = [], None
            for _ in range(arguments.repeat):
                with socket.create_connection(where, timeout=10) as s:
                    began = time.monotonic()
                    try:
                        s.sendall(request)
                    except OSError:
                        pass  # it has heard enough
                    answer = s.recv(65536)
                    times.append(time.monotonic() - began)
                    status = int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else None
                    failed += status != wanted
            print(f"{name:<32} {status}   {percentiles(times)}")

        def good():
            times = []
            for _ in range(arguments.repeat):
                began = time.monotonic()
                assert monitor.get("/api/v1/run").status == 200
                times.append(time.monotonic() - began)
            return percentiles(times)

        print(f"{'a good request':<32} 200   {good()}")
        crowd = [socket.create_connection(where, timeout=10) for _ in range(1000)]
        for s in crowd[::2]:
            s.sendall(b"GET / HT")
        print(f"{'a good one beside 1000 sockets':<32} 200   {good()}")
        for s in crowd:
            s.close()
        slow = []
        names = [s["name"] for s in monitor.json("/api/v1/signals")["signals"]]
        for _ in range(64):
            push = monitor.web_socket()
            if push.status != 101:
                break
            push.send(json.dumps({"op": "view", "id": "v", "names": names[:40], "window_s": -1, "px": 4000}))
            slow.append(push)
        print(f"{'a good one beside 64 slow readers':<32} 200   {good()}")
        for push in slow:
            push.close()
        state = monitor.json("/api/v1/run")
        print(f"the run is {state['state']} at {state['time_s']} s with all {len(state['processes'])} processes "
              f"{'alive' if all(p['state'] == 'alive' for p in state['processes']) else 'NOT ALL ALIVE'}; answers that were not as expected: {failed}")
        return 1 if failed else 0
    finally:
        run.process.send_signal(signal.SIGINT)
        run.finish()


if __name__ == "__main__":
    sys.exit(main())
