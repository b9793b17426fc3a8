# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""examples/guests: a real virtual machine, emulated, whose relay protects the line. No expectation here is about how fast."""
import os
import shutil
import subprocess
import unittest

from harness import BIN, CHILD_DIED, HANG_S, SOURCE, ScenarioTest

EXAMPLE = SOURCE / "examples/guests"
MISSING = [tool for tool in ("qemu-system-x86_64", "cpio", "apt-get") if not shutil.which(tool)]
SLOWLY = ["--set", "processes.monitor=~", "--set", "clock.speed=0.3", "--set", "clock.start_at=~"]
OPENED = '"source":"breaker2","event":"command","text":"open"'


@unittest.skipIf(MISSING and "GRIDSPACE_TEST_ALL" not in os.environ, f"{', '.join(MISSING)} missing: apt install qemu-system-x86 cpio")
class GuestMachine(ScenarioTest):
    @classmethod
    def setUpClass(cls):
        cls.image = BIN.parent / "guest_image"
        made = subprocess.run([EXAMPLE / "make_image.sh", cls.image], capture_output=True, text=True, timeout=HANG_S)
        if made.returncode != 0 and "no kernel from the package" in made.stderr and "GRIDSPACE_TEST_ALL" not in os.environ:
            raise unittest.SkipTest(f"Debian's kernel cannot be fetched: {made.stderr}")
        assert made.returncode == 0, made.stderr

    def scenario(self):
        """The example, with its image beside it."""
        (self.folder / "image").symlink_to(self.image)
        text = (EXAMPLE / "guest_relay.yaml").read_text()
        for old, new in (("../../configs", f"{SOURCE}/configs"), ("within_s: 60", f"within_s: {HANG_S / 2}")):
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.write("guest_relay.yaml", text)

    def test_a_relay_with_a_kernel_of_its_own_protects_the_line(self):
        run = self.start("run", SLOWLY, scenario=self.scenario())
        run.finish()  # its code is not looked at: on a busy machine the trip is late
        self.assertEqual(run.left_over(), {})
        said = (run.folder / "logs/relay_machine.log").read_text()
        self.assertRegex(said, "relay: hears GS_TL2_MU2[12], priority 4", run.stderr())
        self.assertIn("relay: trip at sample", said)
        events = (run.folder / "events.ndjson").read_text()
        self.assertIn(OPENED, events)
        self.assertLess(events.index('"text":"fault"'), events.index(OPENED))
        trips = subprocess.run(["tshark", "-r", run.folder / "bus.pcapng.gz", "-Y", "goose.stNum == 2", "-T", "fields", "-e", "eth.src", "-e", "vlan.priority"],
                               capture_output=True, text=True, check=True, timeout=HANG_S).stdout.split("\n")
        self.assertEqual({line for line in trips if line}, {"02:47:53:02:00:04\t4"})

    def test_it_starts_again_and_dies_by_events(self):
        events = "again: {at_s: 0.3, restart: relay_machine}, dead: {at_s: 2.8, kill: relay_machine}"
        run = self.start("run", ["--set", f"events={{fault: ~, {events}}}", "--set", "expect=~", *SLOWLY], scenario=self.scenario())
        run.finish()
        self.assertEqual(run.left_over(), {})
        self.assertEqual((run.folder / "logs/relay_machine.log").read_text().count("relay: hears"), 2, run.stderr())

    def test_a_panic_of_its_kernel_ends_the_run(self):
        file = self.scenario()
        file.write_text(file.read_text().replace("quiet panic=-1", "quiet panic=-1 rdinit=/none root=/none"))
        run = self.run_to_end("run", SLOWLY, scenario=file, code=CHILD_DIED)
        self.assertIn("'relay_machine', a guest, ended before the run did, with exit code 0", run.stderr())
        self.assertIn("Kernel panic", (run.folder / "logs/relay_machine.log").read_text())


if __name__ == "__main__":
    unittest.main()
