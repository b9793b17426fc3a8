# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Talks to gridspace-monitor as outside programs do. Standard library only."""
import base64
import contextlib
import http.client
import json
import os
import pathlib
import socket
import ssl
import statistics
import struct
import subprocess
import sys
import threading
import time
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
import harness  # noqa: E402

PATIENCE_S = 120


def percentiles(times_s):
    times = sorted(1e3 * t for t in times_s)
    return f"p50 {statistics.median(times):6.2f} ms   p99 {times[int(0.99 * (len(times) - 1))]:6.2f} ms   most {times[-1]:6.2f} ms"


class Answer:
    def __init__(self, response):
        self.status = response.status
        self.headers = {k.lower(): v for k, v in response.getheaders()}
        self.body = response.read()

    @property
    def kind(self):
        return self.headers.get("content-type", "").split(";")[0]

    def json(self):
        return json.loads(self.body)


class Monitor:
    """Where a monitor serves: "http://127.0.0.1:8080", or https with the certificate that it must show."""

    def __init__(self, url, certificate=None, token=None):
        parts = urllib.parse.urlsplit(url.strip())
        self.host, self.port, self.secure = parts.hostname, parts.port, parts.scheme == "https"
        self.token = token
        self.tls = None
        if self.secure:
            self.tls = ssl.create_default_context(cafile=certificate)
            self.tls.check_hostname = False

    def connect(self):
        if self.secure:
            return http.client.HTTPSConnection(self.host, self.port, timeout=PATIENCE_S, context=self.tls)
        return http.client.HTTPConnection(self.host, self.port, timeout=PATIENCE_S)

    def ask(self, method, path, body=None, headers=None):
        headers = dict(headers or {})
        if self.token is not None:
            headers.setdefault("Authorization", f"Bearer {self.token}")
        connection = self.connect()
        try:
            connection.request(method, path, body=body, headers=headers)
            return Answer(connection.getresponse())
        finally:
            connection.close()

    def get(self, path, **headers):
        return self.ask("GET", path, headers=headers)

    def json(self, path):
        answer = self.get(path)
        assert answer.status == 200, (path, answer.status, answer.body)
        return answer.json()

    def until(self, path, condition, what):
        """The answer (JSON) that satisfies `condition`."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            found = self.json(path)
            if condition(found):
                return found
            time.sleep(0.05)
        raise AssertionError(f"waited {PATIENCE_S} s for {what}; last: {str(found)[:2000]}")

    def socket(self):
        plain = socket.create_connection((self.host, self.port), timeout=PATIENCE_S)
        return self.tls.wrap_socket(plain) if self.secure else plain

    def web_socket(self, path="/ws/v1", headers=()):
        return WebSocket(self, path, headers)


class WebSocket:
    """RFC 6455, as far as a test needs it. `status` is that of the handshake."""

    def __init__(self, monitor, path, headers):
        self.socket = monitor.socket()
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", f"Host: {monitor.host}:{monitor.port}", "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}", *headers]
        if monitor.token is not None:
            lines.append(f"Authorization: Bearer {monitor.token}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.pending = b""
        while b"\r\n\r\n" not in self.pending:
            more = self.socket.recv(65536)
            if not more:
                break
            self.pending += more
        head, _, self.pending = self.pending.partition(b"\r\n\r\n")
        self.status = int(head.split()[1])

    def _take(self, size):
        while len(self.pending) < size:
            more = self.socket.recv(1 << 20)
            if not more:
                raise EOFError("the monitor has closed the WebSocket")
            self.pending += more
        out, self.pending = self.pending[:size], self.pending[size:]
        return out

    def receive(self):
        """The next message: text or bytes."""
        message, kind = b"", 0
        while True:
            first, second = self._take(2)
            size = second & 127
            if size == 126:
                size = struct.unpack(">H", self._take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self._take(8))[0]
            content = self._take(size)
            if first & 15 == 9:  # ping
                self.send(content, 10)
            elif first & 15 == 8:
                raise EOFError("the monitor has closed the WebSocket")
            else:
                message, kind = message + content, first & 15 or kind
                if first & 128:  # the last of its parts
                    return message.decode() if kind == 1 else message

    def send(self, content, opcode=1):
        content = content.encode() if isinstance(content, str) else content
        size = len(content)
        head = bytes([128 | opcode]) + (bytes([128 | size]) if size < 126 else bytes([254]) + struct.pack(">H", size))
        self.socket.sendall(head + b"\0\0\0\0" + content)  # a mask of zeros is a mask

    def close(self):
        self.socket.close()


def monitor_of(run):
    """The monitor of a harness.Run, as soon as the launcher has noted it."""
    note = run.folder / "monitor.address"
    deadline = time.monotonic() + PATIENCE_S
    while not (note.exists() and note.read_text().count("\n") == 3):
        if run.process.poll() is not None or time.monotonic() > deadline:
            raise AssertionError("no monitor was started:\n" + run.stderr())
        time.sleep(0.02)
    return Monitor(note.read_text().splitlines()[0])


@contextlib.contextmanager
def look_at(folder, *arguments, certificate=None, token=None):
    """`gridspace monitor FOLDER`, until the block ends."""
    process = subprocess.Popen([harness.BIN / "gridspace", "monitor", str(folder), *map(str, arguments)], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    errors = []
    reader = threading.Thread(target=lambda: errors.extend(process.stderr))
    reader.start()
    try:
        url = process.stdout.readline()
        if not url:
            process.wait(PATIENCE_S)
            reader.join(PATIENCE_S)
            raise AssertionError("".join(errors))
        yield Monitor(url, certificate, token)
    finally:
        process.terminate()
        process.wait(PATIENCE_S)
        reader.join(PATIENCE_S)
        process.stdout.close()
        process.stderr.close()
