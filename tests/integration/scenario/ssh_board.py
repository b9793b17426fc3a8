# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A board for tests: a network namespace with an sshd of its own, joined to another namespace by a cable. Needs root.

The "launcher's machine" is a network namespace too, so that nothing of this machine's network is touched and tests run side by side.
Keys and configurations are thrown away; the board has a home directory of its own.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import time

MACHINE, BOARD, NOBODY = "192.168.77.1", "192.168.77.2", "192.168.77.3"
PORT, WEAK_PORT = 22, 2223
SSHD = shutil.which("sshd", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")

SSHD_CONFIG = """
Port {port}
ListenAddress {address}
HostKey {folder}/host_key
AuthorizedKeysFile {folder}/authorized_keys
PidFile none
StrictModes no
UsePAM no
PermitRootLogin yes
PasswordAuthentication no
KbdInteractiveAuthentication no
"""


class Board:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir()
        self.processes = []
        self.machine = self._namespace()
        self.board = self._namespace()
        self.on_machine("ip link add wire type veth peer name eth0 netns " + str(self.board))
        self.on_machine(f"ip link set lo up; ip addr add {MACHINE}/24 dev wire; ip link set wire up")
        self.on_board(f"ip link set lo up; ip addr add {BOARD}/24 dev eth0; ip link set eth0 up")
        self.on_board("mount -t tmpfs none /root; mount -t tmpfs none /run; mkdir /run/sshd")
        home = self.folder.parent  # of the test, which may be in /tmp
        self.on_board(f"mount --bind {home} /mnt; mount -t tmpfs none /tmp; mkdir -p {home}; mount --move /mnt {home}")
        for key in ("host_key", "key", "stranger"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.folder / key], check=True)
        shutil.copy(self.folder / "key.pub", self.folder / "authorized_keys")
        public = (self.folder / "host_key.pub").read_text()
        self.known(f"{BOARD} {public}[{BOARD}]:{WEAK_PORT} {public}")
        (self.folder / "ssh_config").write_text(
            f"Host *\n  UserKnownHostsFile {self.folder}/known_hosts\n  GlobalKnownHostsFile /dev/null\n  IdentitiesOnly yes\n"
            f"Host {BOARD} {NOBODY} board\n  IdentityFile {self.folder}/key\nHost board\n  HostName {BOARD}\n  HostKeyAlias {BOARD}\n  User root\n")
        self._sshd(PORT)

    def known(self, text):
        (self.folder / "known_hosts").write_text(text)

    def _namespace(self):
        process = subprocess.Popen(["unshare", "-n", "-m", "sh", "-c", "echo; exec sleep 3600"], stdout=subprocess.PIPE)
        process.stdout.readline()  # it is in its namespaces
        process.stdout.close()
        self.processes.append(process)
        return process.pid

    def _run(self, pid, command):
        return subprocess.run(["nsenter", "-t", str(pid), "-n", "-m", "sh", "-ec", command], check=True, capture_output=True, text=True, timeout=60).stdout

    def on_machine(self, command):
        return self._run(self.machine, command)

    def on_board(self, command):
        return self._run(self.board, command)

    def _sshd(self, port, prefix=()):
        config = self.folder / f"sshd_{port}"
        config.write_text(SSHD_CONFIG.format(port=port, address=BOARD, folder=self.folder))
        log = open(self.folder / f"sshd_{port}.log", "w")
        self.processes.append(subprocess.Popen(["nsenter", "-t", str(self.board), "-n", "-m", *prefix, SSHD, "-D", "-e", "-f", config],
                                               stdin=subprocess.DEVNULL, stdout=log, stderr=log))
        log.close()
        deadline = time.monotonic() + 60
        while "Server listening" not in (self.folder / f"sshd_{port}.log").read_text():
            assert time.monotonic() < deadline, "sshd does not start"
            time.sleep(0.02)

    def start_weak_sshd(self):
        """One whose users, root too, lack what makes network namespaces."""
        self._sshd(WEAK_PORT, ["setpriv", "--bounding-set=-sys_admin,-net_admin", "--inh-caps=-sys_admin,-net_admin"])

    def prefix(self):
        """Runs a command on the launcher's machine."""
        return ["nsenter", "-t", str(self.machine), "-n"]

    def shadow(self, program, text):
        """The board has another program in the place of this one."""
        file = self.folder / pathlib.Path(program).name
        file.write_text("#!/bin/sh\n" + text)
        file.chmod(0o755)
        self.on_board(f"mount --bind {file} {program}")

    def devices_alive(self):
        """Our programs that run on the board, or in namespaces that were made there: from its home directory, and no other board's."""
        home = os.stat(f"/proc/{self.board}/root/root").st_dev
        out = []
        for entry in pathlib.Path("/proc").iterdir():
            try:
                program, device = os.readlink(entry / "exe"), os.stat(entry / "exe").st_dev
            except OSError:
                continue
            if "/.cache/gridspace/" in program and device == home:
                out.append((entry.name, program))
        return out

    def folders_left(self):
        """What our programs have made in the board's /tmp."""
        return self.on_board("ls -d /tmp/gridspace-?????? 2>/dev/null || true").split()

    def wait_until_idle(self, within_s):
        deadline = time.monotonic() + within_s
        while self.devices_alive() and time.monotonic() < deadline:
            time.sleep(0.05)
        return self.devices_alive()

    def cut_session(self):
        """Ends the connections, as a reboot of the board would."""
        for pid in self.on_board("pgrep -f '^sshd: root' || true").split():
            if os.readlink(f"/proc/{pid}/ns/net") == os.readlink(f"/proc/{self.board}/ns/net"):
                os.kill(int(pid), signal.SIGKILL)

    def close(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait()
