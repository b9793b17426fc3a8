#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a board user gets from `gridspace bundle`, used under qemu-user; and what is said where something is missing or wrong.

What needs no program for ARM64 is in native_bundle_test.py. Run by `./gridspace arm64 test`. By hand: python3 tests/arm64/bundle_test.py -v,
after `./gridspace arm64 build`.
"""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRIDSPACE = pathlib.Path(os.environ.get("GRIDSPACE", ROOT / "build/release/bin/gridspace"))
SYSROOT = ROOT / "build/arm64-sysroot"
SCENARIO = ROOT / "configs/scenarios/protection_arm64.yaml"
EMULATOR = shutil.which("qemu-aarch64-static") or "qemu-aarch64-static"
C_LIBRARY = ["libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"]


def run(*words, **kwargs):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=300, **kwargs)
    return done.returncode, done.stdout + done.stderr


class Bundle(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace_bundle_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        code, text = run(GRIDSPACE, "bundle", SCENARIO, "relay2", "--out", cls.folder)
        assert code == 0, text
        code, text = run("tar", "-C", cls.folder, "-xf", cls.folder / "gridspace-relay2_arm64.tar.gz")
        assert code == 0, text
        cls.tree = cls.folder / "gridspace-relay2"
        # A board that has the C library of Debian 12, and nothing else of ours.
        cls.board = cls.folder / "board"
        (cls.board / "lib/aarch64-linux-gnu").mkdir(parents=True)
        for library in C_LIBRARY:
            shutil.copy(SYSROOT / "lib/aarch64-linux-gnu" / library, cls.board / "lib/aarch64-linux-gnu" / library)
        shutil.copy(SYSROOT / "lib/aarch64-linux-gnu/ld-linux-aarch64.so.1", cls.board / "lib/ld-linux-aarch64.so.1")

    def test_the_tarball_runs_on_a_board_that_has_the_c_library_alone(self):
        code, text = run(EMULATOR, "-L", self.board, self.tree / "bin/gridspace-relay", "--version")
        self.assertEqual(code, 0, text)
        self.assertIn("gridspace-relay", text)

    def test_its_configuration_names_files_of_the_board_and_is_valid(self):
        config = (self.tree / "conf/config.yaml").read_text()
        self.assertRegex(config, r'(?m)^  qos: "?relay.xml"?$', "beside it: the bundle may be unpacked anywhere")
        self.assertTrue((self.tree / "conf/relay.xml").is_file())
        self.assertNotIn(str(ROOT), config)
        code, text = run(EMULATOR, "-L", self.board, self.tree / "bin/gridspace-relay", "--config", self.tree / "conf/config.yaml", "--check")
        self.assertEqual(code, 0, text)

    def test_a_missing_library_is_named(self):
        without = self.folder / "without"
        shutil.copytree(self.tree, without)
        (without / "lib/libfastcdr.so.1").unlink()
        code, text = run(EMULATOR, "-L", self.board, without / "bin/gridspace-relay", "--version")
        self.assertEqual(code, 127, text)
        self.assertIn("libfastcdr.so.1", text)

    @unittest.skipIf(os.uname().machine == "aarch64", "needs a machine of another processor")
    def test_on_a_wrong_machine_it_says_so_with_exit_code_3(self):
        code, text = run("sh", self.tree / "start")
        self.assertEqual(code, 3, text)
        self.assertIn("this bundle is for aarch64, and this machine is", text)

    def test_the_debian_package_depends_on_what_the_program_links_to(self):
        _, fields = run("dpkg-deb", "-f", self.folder / "gridspace-relay2_arm64.deb", "Architecture", "Depends")
        self.assertIn("arm64", fields)
        for package in ("libfastrtps2.9", "libyaml-cpp0.7", "libc6 (>= 2.36)"):
            self.assertIn(package, fields)

    def test_the_service_may_send_raw_frames_and_nothing_more(self):
        unit = (self.tree / "gridspace-relay2.service").read_text()
        self.assertIn("CapabilityBoundingSet=CAP_NET_RAW\n", unit)
        code, text = run(GRIDSPACE, "bundle", ROOT / "configs/scenarios/ev_charging_arm64.yaml", "ev1", "--out", self.folder)
        self.assertEqual(code, 0, text)
        _, unit = run("tar", "-xOf", self.folder / "gridspace-ev1_arm64.tar.gz", "gridspace-ev1/gridspace-ev1.service")
        self.assertIn("CapabilityBoundingSet=\n", unit)
        self.assertNotIn("AF_PACKET", unit)

    def test_a_relay_without_the_capability_for_raw_frames_names_it_with_exit_code_3(self):
        if os.geteuid() != 0:
            self.skipTest("dropping a capability needs root")
        config = (self.tree / "conf/config.yaml").read_text().replace("relay.xml", str(self.tree / "conf/relay.xml"))
        config = config.replace("10.254.0.4", "127.0.0.1").replace('interface: "process_bus"', 'interface: "lo"')
        file = self.folder / "lo.yaml"
        file.write_text(config)
        code, text = run("unshare", "-n", "setpriv", "--bounding-set=-net_raw", "--inh-caps=-net_raw", "sh", "-c",
                         f"ip link set lo up 2>/dev/null; exec {EMULATOR} -L {self.board} "
                         f"-E LD_PRELOAD={ROOT}/build/arm64/bin/libgridspace-qemu-user.so {self.tree}/bin/gridspace-relay --config {file}")
        self.assertEqual(code, 3, text)
        self.assertIn("CAP_NET_RAW", text)


class DebianPackage(unittest.TestCase):
    """The package, installed by dpkg into the root of a Debian for arm64."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace_deb_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        code, text = run(GRIDSPACE, "bundle", SCENARIO, "relay2", "--out", cls.folder)
        assert code == 0, text
        cls.package = cls.folder / "gridspace-relay2_arm64.deb"

    def root(self, name, without=()):
        """A root whose dpkg knows the packages that the sysroot was made of, but for some."""
        root = self.folder / name
        (root / "var/lib/dpkg/updates").mkdir(parents=True)
        (root / "var/lib/dpkg/info").mkdir()
        (root / "var/lib/dpkg/arch").write_text("amd64\narm64\n")
        status = []
        for package in sorted((ROOT / "build/arm64-packages/cache/archives").glob("*.deb")):
            name = package.name.split("_")[0]
            if name not in without:
                fields = subprocess.run(["dpkg-deb", "-f", package], capture_output=True, text=True, check=True).stdout
                status.append("\n".join(["Status: install ok installed", *(line for line in fields.splitlines() if line)]) + "\n")
                (root / "var/lib/dpkg/info" / f"{name}.list").write_text("")
        (root / "var/lib/dpkg/status").write_text("\n".join(status))
        return root

    def dpkg(self, root, *words):
        # Scripts of packages would have to be run by an emulator: ours is told that the root is elsewhere.
        return run("dpkg", f"--root={root}", "--force-not-root", "--force-script-chrootless", *words)

    def test_it_installs_runs_and_leaves_nothing(self):
        root = self.root("board")
        code, text = self.dpkg(root, "-i", self.package)
        self.assertEqual(code, 0, text)
        for file in ("usr/lib/gridspace/relay2/start", "etc/gridspace/relay2/config.yaml", "lib/systemd/system/gridspace-relay2.service"):
            self.assertTrue((root / file).exists(), file)
        for library in ("lib", "usr/lib"):
            (root / library).mkdir(exist_ok=True)
            (root / library / "aarch64-linux-gnu").symlink_to(SYSROOT / "usr/lib/aarch64-linux-gnu")
        (root / "lib/ld-linux-aarch64.so.1").symlink_to(SYSROOT / "lib/ld-linux-aarch64.so.1")
        code, text = run(EMULATOR, "-L", root, root / "usr/lib/gridspace/relay2/bin/gridspace-relay", "--config", "/etc/gridspace/relay2/config.yaml", "--check")
        self.assertEqual(code, 0, text)
        self.assertIn("valid", text)
        config = root / "etc/gridspace/relay2/config.yaml"
        config.write_text(config.read_text() + "# mine\n")
        code, text = self.dpkg(root, "-r", "gridspace-relay2")
        self.assertEqual(code, 0, text)
        self.assertTrue(config.exists(), "what the user changed stays until it is purged")
        code, text = self.dpkg(root, "-P", "gridspace-relay2")
        self.assertEqual(code, 0, text)
        self.assertEqual([p for p in root.rglob("*relay2*")], [])

    def test_it_does_not_install_where_fast_dds_is_missing(self):
        code, text = self.dpkg(self.root("without_dds", {"libfastrtps2.9"}), "-i", self.package)
        self.assertNotEqual(code, 0, text)
        self.assertRegex(text, r"gridspace-relay2(:arm64)? depends on libfastrtps2\.9")


class Mistakes(unittest.TestCase):
    def test_a_process_that_is_not_there_is_refused_with_the_names_that_are(self):
        code, text = run(GRIDSPACE, "bundle", SCENARIO, "relay9", "--out", "/nonexistent")
        self.assertEqual(code, 2, text)
        self.assertIn("relay2", text)

    def test_the_simulator_is_nothing_for_a_board(self):
        code, text = run(GRIDSPACE, "bundle", SCENARIO, "sim")
        self.assertEqual(code, 2, text)

    def test_a_program_for_another_processor_is_refused_before_anything_starts(self):
        code, text = run(GRIDSPACE, "run", SCENARIO, "--out", "/nonexistent/run", env={**os.environ, "GRIDSPACE_ARM64_BIN": str(GRIDSPACE.parent)})
        self.assertEqual(code, 3, text)
        self.assertIn("is a program for x86-64, and qemu-user runs ARM64", text)

    def test_a_missing_build_is_named_with_what_makes_it(self):
        code, text = run(GRIDSPACE, "run", SCENARIO, "--out", "/nonexistent/run", env={**os.environ, "GRIDSPACE_ARM64_BIN": "/nonexistent"})
        self.assertEqual(code, 3, text)
        self.assertIn("./gridspace arm64 build", text)

    def test_a_place_that_is_none_is_refused_with_the_nearest_spelling(self):
        code, text = run(GRIDSPACE, "validate", SCENARIO, "--set", "defaults.gridspace-relay.run_on=qemu-usr")
        self.assertEqual(code, 2, text)
        self.assertIn("did you mean 'qemu-user'?", text)

    def test_the_simulator_is_refused_in_emulation(self):
        code, text = run(GRIDSPACE, "validate", SCENARIO, "--set", "processes.sim.run_on=qemu-user")
        self.assertEqual(code, 2, text)


if __name__ == "__main__":
    unittest.main()
