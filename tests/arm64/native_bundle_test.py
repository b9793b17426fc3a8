#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What `gridspace bundle --arch amd64` makes, used on this machine: start script, service, Debian package.

By hand: GRIDSPACE_BIN_DIR=build/release/bin python3 tests/arm64/native_bundle_test.py -v
"""
import os
import pathlib
import re
import shutil
import subprocess
import tarfile
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRIDSPACE = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", ROOT / "build/release/bin")) / "gridspace"
SCENARIO = ROOT / "configs/scenarios/protection_lockstep.yaml"
PACKAGE = "gridspace-relay2_amd64.deb"


def run(*words, **kwargs):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace", timeout=300, **kwargs)
    return done.returncode, done.stdout + done.stderr


def setUpModule():
    if os.uname().machine != "x86_64":
        raise unittest.SkipTest("a bundle for amd64 is one of the programs of such a machine")


def bundle(folder, *more, at_s=None):
    """Makes the relay's bundle, at a time of Unix if that is said; the Debian package."""
    env = {name: value for name, value in os.environ.items() if name != "SOURCE_DATE_EPOCH"}
    if at_s is not None:
        env["SOURCE_DATE_EPOCH"] = str(at_s)
    code, text = run(GRIDSPACE, "bundle", SCENARIO, "relay2", "--arch", "amd64", "--out", folder, *more, env=env)
    assert code == 0, text
    return folder / PACKAGE


class NativeBundle(unittest.TestCase):
    """What the tests look at: the bundle, unpacked both ways."""

    @classmethod
    def setUpClass(cls):
        if NativeBundle.folder is None:
            made = tempfile.mkdtemp(prefix="gridspace_native_bundle_")
            unittest.addModuleCleanup(shutil.rmtree, made, ignore_errors=True)
            NativeBundle.folder = pathlib.Path(made)
            bundle(NativeBundle.folder)
            run("dpkg-deb", "-x", cls.folder / PACKAGE, cls.folder / "root")
            run("dpkg-deb", "-e", cls.folder / PACKAGE, cls.folder / "scripts")
            with tarfile.open(cls.folder / "gridspace-relay2_amd64.tar.gz") as archive:
                archive.extractall(cls.folder)
        cls.tree = cls.folder / "gridspace-relay2"
        cls.installed = cls.folder / "root/usr/lib/gridspace/relay2"

    folder = None


class Start(NativeBundle):
    """The start script, on a processor that runs it."""

    def test_it_starts_the_program(self):
        for place in (self.installed, self.tree):
            code, text = run("sh", place / "start", "--version")
            self.assertEqual(code, 0, text)
            self.assertIn("gridspace-relay", text)

    def test_the_tarball_uses_the_libraries_that_it_brings_along_and_no_others(self):
        code, text = run("sh", self.tree / "start", "--version", env={**os.environ, "LD_DEBUG": "libs"})
        self.assertEqual(code, 0, text)
        used = set(re.findall(r"calling init: (\S+)", text))
        for library in (self.tree / "lib").iterdir():
            self.assertIn(str(library), used)
            self.assertEqual([file for file in used if file.endswith("/" + library.name)], [str(library)])

    def start_damaged(self, place, before, after):
        program = place / "bin/gridspace-relay"
        whole = program.read_bytes()
        self.assertIn(before, whole)
        self.assertEqual(len(before), len(after))
        try:
            program.write_bytes(whole.replace(before, after))
            return run("sh", place / "start", "--version")
        finally:
            program.write_bytes(whole)

    def test_a_missing_library_is_named_with_exit_code_3(self):
        code, text = self.start_damaged(self.installed, b"libfastcdr.so.1", b"libfastcdr.so.x")
        self.assertEqual(code, 3, text)
        self.assertIn("libraries are missing: libfastcdr.so.x; install the packages that README names", text)
        readme = (self.folder / "root/usr/share/doc/gridspace-relay2/README").read_text()
        self.assertRegex(readme, r"apt install .*libfastcdr1 .*libfastrtps2\.9")
        code, text = self.start_damaged(self.tree, b"libfastcdr.so.1", b"libfastcdr.so.x")
        self.assertEqual(code, 3, text)
        self.assertIn("libraries are missing: libfastcdr.so.x; unpack the tarball again", text)

    def test_a_program_that_cannot_be_loaded_says_so_with_exit_code_3(self):
        code, text = self.start_damaged(self.installed, b"\x7fELF", b"\x7fELV")
        self.assertEqual(code, 3, text)
        self.assertIn("gridspace-relay cannot be loaded", text)


class Service(NativeBundle):
    def unit(self, change=lambda text: text):
        """What systemd has to say about the unit, in a root with systemd's own."""
        root = self.folder / "systemd"
        shutil.rmtree(root, ignore_errors=True)
        run("dpkg-deb", "-x", self.folder / PACKAGE, root)
        shutil.copytree("/lib/systemd/system", root / "lib/systemd/system", dirs_exist_ok=True, symlinks=True)
        file = root / "lib/systemd/system/gridspace-relay2.service"
        file.write_text(change(file.read_text()))
        return run("systemd-analyze", "verify", f"--root={root}", "gridspace-relay2.service"), file

    @unittest.skipUnless(shutil.which("systemd-analyze"), "needs systemd-analyze")
    def test_systemd_finds_nothing_wrong_with_its_unit_and_it_is_locked_down(self):
        (code, text), file = self.unit()
        self.assertEqual((code, text.strip()), (0, ""))
        _, text = self.unit(lambda unit: unit.replace("ProtectHome=", "ProtectHom="))[0]
        self.assertIn("ProtectHom", text)  # it would have said so
        (code, text), _ = self.unit(lambda unit: unit.replace("/relay2/start", "/relay2/begin"))
        self.assertIn("begin", text)
        _, file = self.unit()
        code, text = run("systemd-analyze", "security", "--offline=true", "--threshold=25", file)
        self.assertEqual(code, 0, text)  # of 100, where 100 is an unconfined service

    def test_it_is_started_again_after_every_end_but_that_of_a_wrong_configuration(self):
        for file in (self.folder / "root/lib/systemd/system/gridspace-relay2.service", self.tree / "gridspace-relay2.service"):
            sections = {name: dict(line.split("=", 1) for line in body.splitlines() if "=" in line and not line.startswith("#"))
                        for name, body in re.findall(r"\[(\w+)\]\n(.*?)(?=\n\[|\Z)", file.read_text(), re.S)}
            self.assertEqual(sections["Service"]["Restart"], "always")  # the next run, after a finished one
            self.assertEqual(sections["Service"]["RestartPreventExitStatus"], "2")
            self.assertEqual(sections["Unit"]["StartLimitIntervalSec"], "0", "it never gives up")
            self.assertIn("WantedBy", sections["Install"])
            self.assertEqual(sections["Service"]["LimitMEMLOCK"], "infinity")


class DebianPackage(NativeBundle):
    def version(self, package):
        return run("dpkg-deb", "-f", package, "Version")[1].strip()

    def test_a_bundle_that_is_made_later_is_newer_and_the_same_one_is_the_same(self):
        made = [bundle(self.folder / name, *more, at_s=at_s)
                for name, at_s, more in (("first", 1_800_000_000, ()), ("again", 1_800_000_000, ()),
                                         ("later", 1_800_000_001, ("--set", "processes.relay2.element.pickup_a=31")))]
        first, again, later = map(self.version, made)
        self.assertRegex(first, r"^\d+\.\d+\.\d+\+20270115\.080000\.[0-9a-f]{8}$")
        self.assertEqual(run("dpkg", "--compare-versions", later, "gt", first)[0], 0, f"{later} after {first}")
        self.assertNotEqual(later.rsplit(".", 1)[1], first.rsplit(".", 1)[1], "another content")
        self.assertEqual(first, again)
        self.assertEqual(made[0].read_bytes(), made[1].read_bytes())
        self.assertEqual(*((self.folder / name / "gridspace-relay2_amd64.tar.gz").read_bytes() for name in ("first", "again")))

    def script(self, name, *arguments):
        """What a script of the package asks of systemd, on a machine that runs it."""
        fake = self.folder / "fake"
        fake.mkdir(exist_ok=True)
        (fake / "systemctl").write_text(f"#!/bin/sh\necho \"$*\" >>{fake}/asked\n")
        (fake / "systemctl").chmod(0o755)
        (fake / "asked").write_text("")
        code, text = run("unshare", "-rm", "sh", "-ec",
                         f"mount -t tmpfs none /run; mkdir -p /run/systemd/system; PATH={fake}:$PATH sh {self.folder}/scripts/{name} {' '.join(arguments)}")
        self.assertEqual(code, 0, text)
        return (fake / "asked").read_text().splitlines()

    def test_a_removed_package_leaves_no_service_behind_and_an_upgraded_one_runs_the_new_configuration(self):
        self.assertEqual(self.script("prerm", "remove"), ["--no-reload disable --now gridspace-relay2.service"])
        self.assertEqual(self.script("postrm", "remove"), ["daemon-reload"])
        self.assertEqual(self.script("prerm", "upgrade", "0.2"), [])
        self.assertEqual(self.script("postinst", "configure", "0.1"), ["daemon-reload", "try-restart gridspace-relay2.service"])
        self.assertEqual(self.script("postinst", "configure"), ["daemon-reload"])

    def test_licences_are_named_and_those_of_libraries_that_are_brought_along_are_there(self):
        copyright_file = self.folder / "root/usr/share/doc/gridspace-relay2/copyright"
        self.assertIn("License: Apache-2.0", copyright_file.read_text())
        licences = {file.name for file in (self.tree / "licenses").iterdir()}
        self.assertLessEqual({"gridspace", "libfastrtps2.9", "libfastcdr1", "libssl3", "libstdc++6", "libyaml-cpp0.7", "libsqlite3-0"}, licences)
        self.assertIn("OpenSSL", (self.tree / "licenses/libssl3").read_text())
        self.assertIn("Apache License", (self.tree / "licenses/gridspace").read_text())


class Readme(NativeBundle):
    def test_it_says_what_a_board_has_to_be_given(self):
        for file in (self.tree / "README", self.folder / "root/usr/share/doc/gridspace-relay2/README"):
            text = file.read_text()
            self.assertIn("sysctl -w net.core.rmem_max=4194304", text)
            self.assertRegex(text, r"(?s)exit code.*started again", "what its service does when it ends")
            self.assertNotIn("@", re.sub(r"gridspace@\S+", "", text), "nothing is left to be filled in")


class Refused(NativeBundle):
    def test_who_writes_into_the_run_folder_stays_beside_it(self):
        for process, why in (("recorder", ": its recording belongs into the run's folder"), ("monitor", "")):
            out = self.folder / "refused"
            code, text = run(GRIDSPACE, "bundle", ROOT / "configs/scenarios/ev_charging.yaml", process, "--arch", "amd64", "--out", out)
            self.assertEqual(code, 2, text)
            self.assertIn(f"process '{process}' (gridspace-{process}) is nothing for a board{why}", text)
            self.assertIn("agents, gateways and link process are", text)
            self.assertFalse(out.exists(), "nothing is written")



if __name__ == "__main__":
    unittest.main()
