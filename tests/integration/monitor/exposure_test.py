# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A monitor that is reached from elsewhere: only with a token and TLS, and then nothing is told without the token."""
import http.client
import json
import ssl
import subprocess
import unittest
import urllib.parse

import client
import harness

TOKEN = "an-example-of-a-token-0123456789"
DOCUMENT = json.loads((harness.SOURCE / "monitor/app/openapi.json").read_text())


class Exposure(harness.ScenarioTest):
    def setUp(self):
        super().setUp()
        self.token_file = self.secret("token", TOKEN + "\n")
        self.cert, self.key = self.certificate("monitor")

    def secret(self, name, text, mode=0o600):
        file = self.write(name, text)
        file.chmod(mode)
        return file

    def certificate(self, name):
        cert, key = self.folder / f"{name}.pem", self.folder / f"{name}.key"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                        "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,DNS:Lab.example,IP:127.0.0.1", "-keyout", key, "-out", cert],
                       check=True, capture_output=True)
        return cert, key

    def settings(self, **more):
        return [w for k, v in more.items() for w in ("--set", f"processes.monitor.{k}={v}")]

    def test_a_scenario_that_exposes_its_monitor_is_refused_without_token_and_tls(self):
        for settings, missing in [({}, "a token (token_file) and TLS"), ({"token_file": self.token_file}, "TLS (tls_cert and tls_key)"),
                                  ({"tls_cert": self.cert, "tls_key": self.key}, "a token (token_file)"),
                                  ({"token_file": self.token_file, "tls_cert": self.cert}, "a certificate goes with its key")]:
            for verb in ("validate", "run"):
                code, _, err = harness.gridspace(verb, harness.CASE_1, *self.settings(listen="0.0.0.0:0", **settings))
                self.assertEqual(code, harness.USAGE, err)
                self.assertIn(missing, err)
                self.assertIn("processes.monitor", err)

    def test_files_that_do_not_serve_are_refused_with_the_reason(self):
        run = self.run_to_end("run", ["--until", "600s", "--set", "expect=~", "--set", "processes.monitor=~"])
        other_cert, _ = self.certificate("other")
        readable = self.secret("readable", TOKEN, 0o644)
        short = self.secret("short", "secret")
        open_key = self.secret("open.key", self.key.read_text(), 0o644)
        good = ["--bind", "0.0.0.0:0"]
        for arguments, said in [
                (good, "a token (token_file) and TLS"),
                ([*good, "--token-file", self.token_file], "TLS (tls_cert and tls_key)"),
                ([*good, "--token-file", self.token_file, "--tls-cert", self.cert], "a certificate goes with its key"),
                ([*good, "--token-file", readable, "--tls-cert", self.cert, "--tls-key", self.key], "can be read by others (mode 644)"),
                ([*good, "--token-file", short, "--tls-cert", self.cert, "--tls-key", self.key], "holds no token"),
                ([*good, "--token-file", self.folder / "none", "--tls-cert", self.cert, "--tls-key", self.key], "cannot read a token"),
                ([*good, "--token-file", self.token_file, "--tls-cert", other_cert, "--tls-key", self.key], "is no key of that certificate"),
                ([*good, "--token-file", self.token_file, "--tls-cert", self.token_file, "--tls-key", self.key], "is no certificate"),
                ([*good, "--token-file", self.token_file, "--tls-cert", self.cert, "--tls-key", open_key], "can be read by everybody"),
                ([*good, "--token-file", self.token_file, "--tls-cert", self.cert, "--tls-key", self.folder / "none"], "there is no file")]:
            code, _, err = harness.gridspace("monitor", run.folder, *arguments)
            self.assertEqual(code, harness.USAGE, err)
            self.assertIn(said, err)

    def test_nothing_is_told_without_the_token_and_everything_with_it(self):
        run = self.start("run", ["--speed", "60", "--allow-control",
                                 *self.settings(listen="0.0.0.0:0", token_file=self.token_file, tls_cert=self.cert, tls_key=self.key)])
        noted = client.monitor_of(run)
        self.assertTrue(noted.secure)
        stranger = client.Monitor(f"https://127.0.0.1:{noted.port}", self.cert)
        friend = client.Monitor(f"https://127.0.0.1:{noted.port}", self.cert, TOKEN)
        friend.until("/api/v1/run", lambda r: r["state"] == "running", "the run to run")

        for path, methods in DOCUMENT["paths"].items():
            target = path.replace("{topic}", "simulation_clock")
            for method in methods:
                if path in ("/login", "/ws/v1"):
                    continue
                answer = stranger.ask(method.upper(), target)
                self.assertEqual((answer.status, answer.headers.get("www-authenticate")), (401, "Bearer"), path)
            if "get" in methods and path not in ("/login", "/ws/v1"):
                self.assertIn(friend.get(target).status, (200, 400), path)  # 400: a query without names
        self.assertEqual(stranger.get("/nowhere").status, 401)  # not even what there is
        for wrong in ("", TOKEN + "x", TOKEN[:-1], TOKEN.upper()):
            self.assertEqual(stranger.get("/api/v1/run", Authorization=f"Bearer {wrong}").status, 401)
        self.assertEqual(stranger.get(f"/api/v1/run?token={TOKEN}").status, 401)
        for headers in ([], ["Sec-WebSocket-Protocol: foxglove.websocket.v1"]):
            self.assertEqual(self.handshake(stranger, headers), 401)
            self.assertEqual(self.handshake(friend, headers), 101)
            # Foxglove and PlotJuggler know of no headers: their WebSocket, and nothing else, may have the token in its address.
            self.assertEqual(self.handshake(stranger, headers, f"/ws/v1?token={TOKEN}"), 101)
            for wrong in ("", TOKEN + "x", TOKEN[:-1], TOKEN.upper()):
                self.assertEqual(self.handshake(stranger, headers, f"/ws/v1?token={wrong}"), 401)

        self.assert_browser_is_let_in(stranger)
        self.assert_only_tls_is_spoken(noted.port)
        # Host and Origin are still looked at; the address that was asked and what the certificate says are among the names.
        for host, status in (("localhost", 200), ("lab.example:8443", 200), ("LAB.example", 200), ("127.0.0.1", 200), ("evil.example", 403), ("192.0.2.1", 403)):
            self.assertEqual(friend.get("/api/v1/health", Host=host).status, status, host)
        self.assertEqual(friend.get("/api/v1/health", Origin="https://evil.example").status, 403)
        # Whoever may control the run may look at it; whoever may look may not control it.
        control = (run.folder / "control.token").read_text().strip()
        self.assertEqual(client.Monitor(f"https://127.0.0.1:{noted.port}", self.cert, control).get("/api/v1/run").status, 200)
        self.assertEqual(friend.ask("POST", "/api/v1/control", json.dumps({"action": "stop"})).status, 401)
        # The command line knows certificate and token from the run's folder.
        code, out, err = harness.gridspace("topic", "list", "--run", run.folder)
        self.assertEqual(code, harness.OK, err)
        self.assertIn("bus_measurements", out)
        code, _, err = harness.gridspace("stop", run.folder)
        self.assertEqual(code, harness.OK, err)
        run.finish()
        self.assertNotIn(TOKEN, run.stderr())
        for log in (run.folder / "logs").iterdir():
            self.assertNotIn(TOKEN, log.read_text(), log)

    @staticmethod
    def handshake(monitor, headers, path="/ws/v1"):
        push = monitor.web_socket(path, headers)
        push.close()
        return push.status

    def assert_browser_is_let_in(self, stranger):
        page = stranger.get("/", Accept="text/html")
        self.assertEqual(page.status, 401)
        self.assertIn('<form method="post" action="/login">', page.body.decode())
        self.assertNotIn("<script", page.body.decode())

        def log_in(token, **headers):
            return stranger.ask("POST", "/login", urllib.parse.urlencode({"token": token}), {"Content-Type": "application/x-www-form-urlencoded", **headers})
        self.assertEqual(log_in("wrong").status, 401)
        self.assertEqual(log_in(TOKEN, Origin="https://evil.example").status, 403)
        let_in = log_in(TOKEN)
        self.assertEqual((let_in.status, let_in.headers["location"]), (303, "/"))
        for word in ("HttpOnly", "Secure", "SameSite=Strict"):
            self.assertIn(word, let_in.headers["set-cookie"])
        cookie = let_in.headers["set-cookie"].split(";")[0]
        self.assertNotIn(TOKEN, cookie)
        self.assertIn("app.js", stranger.get("/", Accept="text/html", Cookie=cookie).body.decode())
        self.assertEqual(self.handshake(stranger, [f"Cookie: {cookie}"]), 101)
        self.assertEqual(stranger.get("/api/v1/run", Cookie=cookie + "0").status, 401)

    def assert_only_tls_is_spoken(self, port):
        with self.assertRaises((http.client.HTTPException, OSError)):
            client.Monitor(f"http://127.0.0.1:{port}", token=TOKEN).get("/api/v1/health")
        for version, spoken in (("tls1_1", False), ("tls1_2", True), ("tls1_3", True)):
            done = subprocess.run(["openssl", "s_client", "-connect", f"127.0.0.1:{port}", f"-{version}", "-cipher", "ALL:@SECLEVEL=0"],
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=harness.HANG_S)
            self.assertEqual(done.returncode == 0, spoken, version)
        other, _ = self.certificate("other")
        with self.assertRaises(ssl.SSLCertVerificationError):  # the negative control of the certificate itself
            client.Monitor(f"https://127.0.0.1:{port}", other, TOKEN).get("/api/v1/health")


if __name__ == "__main__":
    unittest.main()
