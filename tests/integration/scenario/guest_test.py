# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A virtual machine or container in the place of a host: taps for its interfaces, and a run that begins when it is ready. The guest
here is a program that opens its tap as an emulator does."""
import subprocess
import unittest

from harness import CASE_1, CHILD_DIED, ENVIRONMENT, HANG_S, OK, SOURCE, STALL, USAGE, ScenarioTest, gridspace

GUEST = """
import fcntl, os, struct, sys, time
name, mac = sys.argv[1], bytes.fromhex(sys.argv[2].replace(":", ""))
tap = os.open("/dev/net/tun", os.O_RDWR)
fcntl.ioctl(tap, 0x400454CA, struct.pack("16sH22x", name.encode(), 0x1002))  # TUNSETIFF, IFF_TAP | IFF_NO_PI
print("booting", flush=True)
time.sleep(0.5)
if len(sys.argv) > 3: sys.exit(int(sys.argv[3]))
print("it is up and runn", end="", flush=True)
time.sleep(0.2)
print("ing", flush=True)
os.write(tap, bytes.fromhex("010ccd010009") + mac + bytes.fromhex("88b8") + bytes(46))
while True:
    frame = os.read(tap, 2048)
    if frame[12:14].hex() == "8100" and frame[16:18].hex() == "88ba":
        print("heard", frame[6:12].hex(), "with tag", frame[14:16].hex(), flush=True)
        os.write(tap, bytes.fromhex("010ccd010009") + mac + bytes.fromhex("8100" "8000" "88b8") + bytes(46))
        break
if os.environ.get("PANICS"): sys.exit(0)  # as an emulator does then
while True: time.sleep(1)
"""
SCENARIO = """---
gridspace: 1
extends: {source}/configs/scenarios/protection.yaml
name: guest
simulation: {{duration_s: 1}}
hosts: {{ied9: {{links: [process_bus]}}}}
processes:
  monitor: ~
  ied9: {{program: exec, host: ied9, guest: true, ready: {{says: "up and running", within_s: {within}}},
         command: [python3, {guest}, "{{tap:process_bus}}", "{{mac:process_bus}}"{more}]}}
events: ~
record: {{comtrade: ~}}
expect: ~
"""


class Guest(ScenarioTest):
    def scenario(self, within=60, more="", name="guest"):
        (self.folder / "guest.py").write_text(GUEST)
        file = self.folder / f"{name}.yaml"
        file.write_text(SCENARIO.format(source=SOURCE, guest=self.folder / "guest.py", within=within, more=more))
        return file

    def test_it_stands_on_the_switch_in_the_place_of_its_host_and_the_run_waits_for_it(self):
        run = self.run_to_end("guest", scenario=self.scenario())
        said = (run.folder / "logs/ied9.log").read_text()
        self.assertIn("it is up and running", said)
        self.assertRegex(said, "heard [0-9a-f]{12} with tag 80")  # its priority has come through
        frames = subprocess.run(["tshark", "-r", run.folder / "bus.pcapng.gz", "-Y", "eth.dst == 01:0c:cd:01:00:09", "-T", "fields", "-e", "eth.src",
                                 "-e", "vlan.priority"], capture_output=True, text=True, check=True, timeout=HANG_S).stdout.split("\n")
        self.assertIn("4", [line.split("\t")[1] for line in frames if line], frames)

    def test_one_that_does_not_come_up_or_ends_is_named(self):
        late = self.run_to_end("late", scenario=self.scenario(within=0.1, name="late"), code=STALL)
        self.assertIn("process 'ied9' has not said 'up and running' within 0.1 s of its start", late.stderr())
        dead = self.run_to_end("dead", scenario=self.scenario(more=', "3"', name="dead"), code=CHILD_DIED)
        self.assertIn("ied9", dead.stderr())

    def test_one_that_ends_before_the_run_does_is_a_failure_with_exit_code_0_too(self):
        file = self.scenario()
        file.write_text(file.read_text().replace("command: [", "command: [env, PANICS=1, ").replace("duration_s: 1", "duration_s: 60"))
        run = self.run_to_end("panic", scenario=file, code=CHILD_DIED)
        self.assertIn("process 'ied9', a guest, ended before the run did, with exit code 0", run.stderr())

    def test_what_cannot_be_a_guests_machine_is_said_before_anything_starts(self):
        no_device = ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs none /dev/net && exec "$@"', "sh"]
        run = self.start("device", scenario=self.scenario(), prefix=no_device)
        self.assertEqual(run.finish(), ENVIRONMENT, run.stderr())
        self.assertIn("process 'ied9': a guest is plugged in by tap devices, and /dev/net/tun cannot be opened: No such file", run.stderr())
        self.assertFalse(run.folder.exists())
        guest = ["--set", "hosts.ied9={links: []}", "--set", "processes.ied9={program: exec, host: ied9, guest: true, command: [sleep, '9']}"]
        code, _, err = gridspace("run", CASE_1, *guest, "--no-namespaces", "--dry-run")
        self.assertEqual(code, USAGE, err)
        self.assertIn("hosts with interfaces of their own", err)

    def test_its_files_lie_beside_the_scenario(self):
        code, out, err = gridspace("run", self.scenario(more=', "file={folder}/ied.qcow2,if=virtio"'), "--dry-run")
        self.assertEqual(code, OK, err)
        self.assertIn(f" tap1 02:47:53:02:00:06 file={self.folder}/ied.qcow2,if=virtio\n", out)

    def test_validate_says_what_a_guest_needs(self):
        def said(old, new):
            file = self.scenario()
            file.write_text(file.read_text().replace(old, new))
            code, out, err = gridspace("validate", file)
            self.assertEqual(code, USAGE, out + err)
            return err

        self.assertIn("'{tap:bus}' names a link that host 'ied9' is not plugged into", said("{tap:process_bus}", "{tap:bus}"))
        self.assertIn("a guest in the place of host 'ied2', where", said("host: ied9", "host: ied2"))
        self.assertIn("a guest, and has the real interface 'eth9'", said("guest: true", "guest: true, interface: eth9"))
        self.assertIn("says", said('says: "up and running", ', ""))


if __name__ == "__main__":
    unittest.main()
