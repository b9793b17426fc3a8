# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""DDS Security in whole runs: the same recording with and without, and nothing starts with keys that are not valid."""
import datetime
import json
import pathlib
import sys
import unittest

from harness import BASE, BIN, CASE_1, OK, SHORT_CASE_2, SOURCE, USAGE, ScenarioTest, gridspace

SHORT_CASE_1 = [*BASE, "--until", "10min", "--set", "expect=~"]

# An agent that writes what it does not declare: the launcher gives it no right to.
THIEF = """#!/usr/bin/env python3
import ctypes, sys
sys.path.insert(0, {python!r})
import gridspace
from gridspace import Reads, Writes

class Thief(gridspace.Agent):
    {topics}

    @classmethod
    def describe(cls):
        out = super().describe()
        if "--describe" in sys.argv:
            out["writes"] = []
        return out

if __name__ == "__main__":
    Thief.main()
"""


class Security(ScenarioTest):
    def keys(self, *arguments):
        folder = self.folder / "keys"
        code, out, err = gridspace("keys", "init", folder, *arguments)
        self.assertEqual(code, OK, out + err)
        return folder

    def test_a_secured_run_records_what_a_plain_one_records_and_leaves_no_private_key(self):
        plain = self.run_to_end("plain", SHORT_CASE_1)
        secured = self.run_to_end("secured", [*SHORT_CASE_1, "--set", "security=on"])
        self.assert_identical(plain, secured)
        self.assertEqual(list(secured.folder.rglob("*.key")), [])
        self.assertEqual([e for e in secured.events() if e["event"] in ("foreign_datagrams", "unauthenticated_participant")], [])
        rights = (secured.folder / "security/ev1/permissions.p7s").read_text()
        publish = rights[rights.index("<publish>"):rights.index("</publish>")]
        self.assertIn("<topic>requests</topic>", publish)
        self.assertNotIn("bus_measurements", publish)

    def test_case_2_with_keys_of_a_folder_and_messages_encrypted_is_the_same_too(self):
        keys = self.keys()
        plain_file, secured_file = self.write("plain.yaml", SHORT_CASE_2), self.write(
            "secured.yaml", SHORT_CASE_2 + f"security: {{keys: {keys}, messages: encrypt, data: sign, topics: {{signals: {{submessages: none, data: none}}}}}}\n")
        plain, secured = self.run_to_end("plain", scenario=plain_file), self.run_to_end("secured", scenario=secured_file)
        self.assert_identical(plain, secured)

    def test_a_process_that_is_started_again_shows_its_certificate_again(self):
        scenario = SOURCE / "tests/scenarios/misbehaviour/relay_restarted.yaml"
        plain, secured = self.run_to_end("plain", scenario=scenario), self.run_to_end("secured", ["--set", "security=on"], scenario)
        self.assert_identical(plain, secured)

    def test_with_an_expired_or_a_revoked_certificate_nothing_starts(self):
        keys = self.keys()
        setting = ["--set", f"security={{keys: {keys}}}"]
        code, out, err = gridspace("keys", "issue", keys, "ev_agent", "--until", "2020-01-01T00:00:00Z")
        self.assertEqual(code, OK, out + err)
        run = self.run_to_end("expired", [*SHORT_CASE_1, *setting], code=USAGE)
        self.assertIn("the certificate of 'ev_agent'", run.stderr())
        self.assertIn("expired at 2020-01-01T00:00:00Z", run.stderr())
        self.assertFalse((run.folder / "logs").exists())
        self.assertEqual(gridspace("keys", "issue", keys, "ev_agent")[0], OK)
        self.assertEqual(gridspace("keys", "revoke", keys, "mcca")[0], OK)
        run = self.run_to_end("revoked", [*SHORT_CASE_1, *setting], code=USAGE)
        self.assertIn("is revoked", run.stderr())
        self.assertEqual(gridspace("keys", "issue", keys, "mcca")[0], OK)
        self.run_to_end("renewed", [*SHORT_CASE_1, *setting])

    def test_an_identity_ends_with_its_authority_unless_it_is_asked_for_more(self):
        made = datetime.datetime.now(datetime.timezone.utc) - datetime.timedelta(days=20 * 365 - 100)  # an authority lasts 20 years
        self.assertEqual(gridspace("keys", "init", self.folder / "old", "--until", made.strftime("%Y-%m-%dT%H:%M:%SZ"))[0], OK)
        ends = (made + datetime.timedelta(days=20 * 365 - 1)).strftime("%Y-%m-%d")
        code, out, err = gridspace("keys", "issue", self.folder / "old", "relay")
        self.assertEqual(code, OK, out + err)
        self.assertIn(f"relay: valid until {ends}", out)
        code, out, err = gridspace("keys", "issue", self.folder / "old", "relay", "--days", "365")
        self.assertEqual(code, USAGE, out + err)
        self.assertIn("would outlive the authority", err)

    def test_somebody_without_keys_is_an_event_and_changes_nothing(self):
        plain = self.run_to_end("plain", SHORT_CASE_1)
        outsider = {"program": "exec", "host": "board1", "command": ["sh", "-c", f"exec {BIN}/gridspace monitor --domain 0 --address $GRIDSPACE_MANAGEMENT_ADDRESS"]}
        run = self.run_to_end("beside", [*SHORT_CASE_1, "--speed", "600", "--set", "security=on", "--set", f"processes.outsider={json.dumps(outsider)}"])
        told = [e for e in run.events() if e["event"] == "unauthenticated_participant"]
        self.assertTrue(told, run.events())
        self.assertIn("'monitor'", told[0]["text"])
        self.assert_identical(plain, run)

    def test_a_process_that_writes_what_it_does_not_declare_is_refused(self):
        thief = self.write("thief.py", THIEF.format(python=str(SOURCE / "python"), topics='requests = Writes("requests", "ChargingRequest")'))
        thief.chmod(0o755)
        process = json.dumps({"program": {"path": str(thief)}, "host": "board1"})
        run = self.start("thief", [*SHORT_CASE_1, "--set", "security=on", "--set", f"processes.thief={process}"])
        self.assertNotEqual(run.finish(), OK)
        self.assertIn("DDS refused the writer of topic 'requests'; 'thief' has no right to publish it", (run.folder / "logs/thief.log").read_text() + run.stderr())


if __name__ == "__main__":
    unittest.main()
