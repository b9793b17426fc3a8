# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What is shipped is hardened: the programs by how they were compiled and linked, the service of a board by its unit."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
BOARD = SOURCE / "scripts/board"


def readelf(option, file):
    return subprocess.run(["readelf", "-W", option, file], capture_output=True, text=True, check=True).stdout


@unittest.skipIf(shutil.which("readelf") is None, "needs readelf (package binutils)")
class Programs(unittest.TestCase):
    def test_each_is_position_independent_and_hardened(self):
        programs = [file for file in sorted(BIN.glob("gridspace*")) if file.is_file() and file.read_bytes()[:4] == b"\x7fELF"]
        self.assertTrue(programs, BIN)
        for program in programs:
            with self.subTest(program.name):
                segments, dynamic, symbols = (readelf(option, program) for option in ("-l", "-d", "-s"))
                if "__asan_init" in symbols or "__tsan_init" in symbols:
                    self.skipTest("a build for finding errors")
                self.assertRegex(readelf("-h", program), r"Type:\s+DYN", "position-independent")
                self.assertIn("GNU_RELRO", segments)
                self.assertRegex(segments, r"GNU_STACK .* RW ", "no executable stack")
                self.assertRegex(dynamic, r"FLAGS_1.*NOW", "everything is bound before it runs, and then read-only")
                self.assertIn("__stack_chk_fail", symbols, "stack protector")
                self.assertRegex(symbols, r"__\w+_chk\b", "fortified")


@unittest.skipIf(shutil.which("systemd-analyze") is None, "needs systemd-analyze (package systemd)")
class Service(unittest.TestCase):
    def exposure(self, ending):
        """What `systemd-analyze security` makes of the unit, 0 to 10, with what bundle.sh adds to it."""
        text = (BOARD / "gridspace.service.in").read_text().replace("@NAME@", "x").replace("@PROGRAM@", "gridspace-x")
        text = re.sub("ExecStart=.*", "ExecStart=/bin/true", text) + ending.encode().decode("unicode_escape")
        with tempfile.TemporaryDirectory() as folder:
            unit = pathlib.Path(folder) / "gridspace-x.service"
            unit.write_text(text)
            done = subprocess.run(["systemd-analyze", "security", "--offline=yes", unit], capture_output=True, text=True, check=False)
        found = re.search(r"exposure level for \S+: ([0-9.]+)", done.stdout)
        if found is None:
            self.skipTest(f"this systemd-analyze looks at no file: {done.stderr}")
        return float(found[1])

    def test_a_board_is_exposed_to_little(self):
        with_raw_frames, without = re.findall(r"printf '([^']*CapabilityBoundingSet=[^']*)'", (BOARD / "bundle.sh").read_text())
        self.assertIn("CAP_NET_RAW", with_raw_frames)
        self.assertLessEqual(self.exposure(with_raw_frames), 3.0)
        self.assertLessEqual(self.exposure(without), 2.0)
        self.assertGreater(self.exposure(""), 3.0, "negative control: with all capabilities")


if __name__ == "__main__":
    unittest.main()
