# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Keys of authenticated streams come from a file that is its owner's alone, change during a run, and are in no run folder."""
import unittest

from harness import OK, SOURCE, USAGE, ScenarioTest

SECRET = "a1b2c3d4e5f60718293a4b5c6d7e8f90"
KEYS = f"5 {SECRET} until=0.12\n6 0102030405060708090a0b0c0d0e0f10 from=0.11\n"
SCENARIO = f"""---
gridspace: 1
extends: {SOURCE}/tests/scenarios/misbehaviour/fault_with_authentication.yaml
name: keyed
streams:
  SMV21: {{authentication: {{key_name: ~, key_file: bus.keys, algorithm: aes_gmac}}}}
  SMV22: {{authentication: {{key_name: ~, key_file: bus.keys}}}}
  TRIP2: {{authentication: {{key_name: ~, key_file: bus.keys}}}}
"""


class KeyFile(ScenarioTest):
    def keyed(self, mode):
        keys = self.folder / "bus.keys"
        keys.write_text(KEYS)
        keys.chmod(mode)
        return self.write("keyed.yaml", SCENARIO)

    def test_keys_that_overlap_change_while_the_fault_is_cleared_and_are_not_recorded(self):
        run = self.run_to_end("run", scenario=self.keyed(0o600), code=OK)
        holding = [str(f) for f in run.folder.rglob("*") if f.is_file() and SECRET.encode() in f.read_bytes()]
        self.assertEqual(holding, [])

    def test_a_file_that_others_may_read_starts_nothing(self):
        run = self.run_to_end("run", scenario=self.keyed(0o644), code=USAGE)
        self.assertIn("others may read or write it (mode 0644)", "".join(f.read_text() for f in (run.folder / "logs").iterdir()))


if __name__ == "__main__":
    unittest.main()
