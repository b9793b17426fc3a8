# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What monitor/app/openapi.json promises, a live and a finished run keep: every route is called and its answer compared with its
schema. (That every route is in the document is tests/unit/monitor/api_routes_test.cpp.)"""
import copy
import json
import re
import unittest
import urllib.parse

import client
import harness
import json_schema

DOCUMENT = json.loads((harness.SOURCE / "monitor/app/openapi.json").read_text())
CASE_2 = harness.SOURCE / "configs/scenarios/protection_lockstep.yaml"


def examples_of(operation, known):
    """Path and query parameters with their examples; `known` says better ones."""
    for parameter in operation.get("parameters", []):
        if parameter["name"] in known or "example" in parameter:
            yield parameter, known.get(parameter["name"], parameter.get("example"))


def check_answer(document, operation, answer):
    """What is wrong with an answer."""
    responses = operation["responses"]
    if str(answer.status) not in responses:
        return [f"status {answer.status} is not in the document: {answer.body[:200]}"]
    content = json_schema.resolve(document, responses[str(answer.status)]).get("content")
    if content is None:
        return []
    if answer.kind not in content:
        return [f"content type {answer.kind} is not in the document"]
    if answer.kind != "application/json":
        return json_schema.problems(document, content[answer.kind]["schema"], answer.body.decode())
    return json_schema.problems(document, content["application/json"]["schema"], json.loads(answer.body, parse_constant=str))


def check_all(document, monitor, known):
    """Calls every GET of the document; what is wrong, one text each."""
    wrong, called = [], 0
    for path, methods in document["paths"].items():
        if "get" not in methods or path == "/ws/v1":
            continue
        target, query = path, {}
        for parameter, value in examples_of(methods["get"], known):
            if parameter["in"] == "path":
                target = target.replace("{" + parameter["name"] + "}", urllib.parse.quote(str(value), safe=""))
            else:
                query[parameter["name"]] = value
        if query:
            target += "?" + urllib.parse.urlencode(query)
        answer = monitor.get(target)
        called += 1
        wanted = 404 if path == "/login" else 200  # this monitor asks for no token
        if answer.status != wanted:
            wrong.append(f"{target}: {answer.status}, expected {wanted}")
        wrong += [f"{target}: {problem}" for problem in check_answer(document, methods["get"], answer)]
    assert called > 10
    return wrong


class Contract(harness.ScenarioTest):
    maxDiff = None

    def assert_kept(self, monitor, known):
        self.assertEqual(monitor.json("/api/v1/openapi.json"), DOCUMENT)
        self.assertEqual(check_all(DOCUMENT, monitor, known), [])
        # Mistakes are answered as the document says, too.
        for target, operation in [("/api/v1/topics/nobody_has_seen_it", DOCUMENT["paths"]["/api/v1/topics/{topic}"]["get"]),
                                  ("/api/v1/topics/nobody_has_seen_it/last", DOCUMENT["paths"]["/api/v1/topics/{topic}/last"]["get"]),
                                  ("/api/v1/signals/query", DOCUMENT["paths"]["/api/v1/signals/query"]["get"]),
                                  ("/api/v1/signals/query?names=no.such.signal", DOCUMENT["paths"]["/api/v1/signals/query"]["get"]),
                                  ("/api/v1/signals/query?names=a&px=many", DOCUMENT["paths"]["/api/v1/signals/query"]["get"]),
                                  ("/api/v1/signals/query?names=a&px=0", DOCUMENT["paths"]["/api/v1/signals/query"]["get"]),
                                  ("/api/v1/events?after=1.5", DOCUMENT["paths"]["/api/v1/events"]["get"]),
                                  ("/api/v1/events?after=-1", DOCUMENT["paths"]["/api/v1/events"]["get"])]:
            answer = monitor.get(target)
            self.assertIn(answer.status, (400, 404), target)
            self.assertEqual(check_answer(DOCUMENT, operation, answer), [], target)
        push = monitor.web_socket()
        self.assertEqual(push.status, 101)
        push.close()
        # Whatever the pages load is served, and in the document.
        for page in ("/", "/plain"):
            for part in re.findall(r'(?:src|href)="(/[^"]*)"', monitor.get(page).body.decode()):
                self.assertIn(part, DOCUMENT["paths"])
        for path in DOCUMENT["paths"]:
            if path.startswith("/api/v1/") and "{" not in path and "get" in DOCUMENT["paths"][path] and path != "/api/v1/signals/query":
                head = monitor.ask("HEAD", path)
                self.assertEqual((head.status, head.body), (200, b""), path)

    def test_a_live_run_keeps_it(self):
        run = self.start("run", ["--speed", "60", "--allow-control"])
        monitor = client.monitor_of(run)
        monitor.until("/api/v1/run", lambda r: r["state"] == "running" and r["time_s"] > 0, "the run to run")
        signals = monitor.until("/api/v1/signals", lambda s: any("value" in e and e["name"].startswith("bus.") for e in s["signals"]), "signals of the buses")["signals"]
        name = next(s["name"] for s in signals if "value" in s and s["name"].startswith("bus."))
        monitor.until("/api/v1/topics", lambda t: any(x["name"] == "bus_measurements" and x["samples"] > 0 for x in t["topics"]), "a measurement")
        self.assert_kept(monitor, {"names": name, "topic": "bus_measurements"})
        monitor.until("/api/v1/topics", lambda t: not any(x["not_heard"] for x in t["topics"]), "a reader for every writer")
        self.assertEqual([e for e in monitor.json("/api/v1/events")["events"] if e["event"] == "not_heard"], [])

        control = DOCUMENT["paths"]["/api/v1/control"]["post"]
        token = (run.folder / "control.token").read_text().strip()
        action = DOCUMENT["components"]["schemas"]["Action"]
        for said, body, status in [("wrong", {"action": "pause"}, 401), (token, {"action": "explode"}, 400), (token, {"action": "pause"}, 202),
                                   (token, {"action": "step 3"}, 202), (token, {"action": "continue"}, 202), (token, {"action": "stop"}, 202)]:
            self.assertEqual(json_schema.problems(DOCUMENT, action, body) == [], status != 400, body)
            answer = monitor.ask("POST", "/api/v1/control", json.dumps(body), {"Authorization": f"Bearer {said}"})
            self.assertEqual(answer.status, status, body)
            if status == 202 and body["action"] in ("pause", "continue"):
                wanted = "paused" if body["action"] == "pause" else "running"
                monitor.until("/api/v1/run", lambda r, wanted=wanted: r["state"] == wanted, f"the run to be {wanted}")
            self.assertEqual(check_answer(DOCUMENT, control, answer), [], body)
        run.finish()

    def test_a_finished_run_keeps_it(self):
        run = self.run_to_end("run", ["--set", "events.fault.at_s=0.1", "--set", "simulation.duration_s=0.2", "--set", "expect=~"], scenario=CASE_2)
        with client.look_at(run.folder) as monitor:
            monitor.until("/api/v1/run", lambda r: r["state"] == "recorded", "the recording to be read")
            self.assert_kept(monitor, {"names": "breaker.CB3.position", "topic": "TL_21"})
            streams = {s["name"]: s for s in monitor.json("/api/v1/streams")["streams"]}
            self.assertEqual(set(streams), {"SMV21", "SMV22", "TRIP2"}, "and no link that somebody captures")
            states = {p["name"]: p["state"] for p in monitor.json("/api/v1/run")["processes"]}
            self.assertEqual({states[name] for name in ("sim", "relay2", "breaker2")}, {"ended"}, states)
            up = [line for line in monitor.get("/metrics").body.decode().splitlines() if line.startswith("gridspace_process_up{")]
            self.assertEqual({line.rsplit(" ", 1)[1] for line in up}, {"0"}, "nobody is on the bus any more")
            self.assertEqual((streams["SMV21"]["kind"], streams["SMV21"]["from"]), ("smv", ["mu21"]))
            self.assertEqual(streams["TRIP2"]["kind"], "goose")
            answer = monitor.ask("POST", "/api/v1/control", json.dumps({"action": "stop"}))
            self.assertEqual(answer.status, 403)
            self.assertEqual(check_answer(DOCUMENT, DOCUMENT["paths"]["/api/v1/control"]["post"], answer), [])
            self.assert_notices_wrong_documents(monitor)

    def assert_notices_wrong_documents(self, monitor):
        """The negative control: a document that says something else is not kept."""
        known = {"names": "breaker.CB3.position", "topic": "TL_21"}

        def wrong(change):
            document = copy.deepcopy(DOCUMENT)
            change(document)
            return check_all(document, monitor, known)

        schemas = lambda d: d["components"]["schemas"]  # noqa: E731
        self.assertTrue(wrong(lambda d: schemas(d)["Run"]["properties"].update(time_s={"type": "string"})))
        self.assertTrue(wrong(lambda d: schemas(d)["Run"]["properties"].pop("factor")))
        self.assertTrue(wrong(lambda d: schemas(d)["Health"]["required"].append("mood")))
        self.assertTrue(wrong(lambda d: schemas(d)["Wire"]["properties"].update(kind={"enum": ["goose"]})))
        self.assertTrue(wrong(lambda d: d["paths"].update({"/api/v1/weather": d["paths"]["/api/v1/run"]})))
        self.assertTrue(wrong(lambda d: d["paths"]["/metrics"]["get"]["responses"].pop("200")))
        with self.assertRaises(ValueError):
            wrong(lambda d: schemas(d)["Run"].update(maxProperties=3))


if __name__ == "__main__":
    unittest.main()
