# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`run_on: ssh:HOST`: a process on a board that is reached over ssh. The board is a namespace with an sshd; needs root."""
import os
import signal
import subprocess
import unittest

from harness import BIN, CHILD_DIED, ENVIRONMENT, OK, SOURCE, STALL, ScenarioTest, gridspace
from ssh_board import BOARD, NOBODY, SSHD, WEAK_PORT, Board

SHORT = SOURCE / "tests/scenarios/misbehaviour/base.yaml"


@unittest.skipUnless(os.geteuid() == 0 and SSHD, "needs root and sshd (apt install openssh-server)")
class SshBoard(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.board = Board(self.folder / "board")
        self.addCleanup(self.board.close)

    def on(self, place=f"ssh:root@{BOARD}", *more):
        settings = [f"processes.relay2.run_on={place}", f"processes.relay2.ssh.config={self.board.folder}/ssh_config", *more]
        return [word for setting in settings for word in ("--set", setting)]

    def refused(self, *arguments, code=ENVIRONMENT):
        """The run ends before anything is started; what it says."""
        done = subprocess.run([*self.board.prefix(), BIN / "gridspace", "run", SHORT, "--out", self.folder / "refused", *map(str, arguments)],
                              capture_output=True, text=True, timeout=240)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertFalse((self.folder / "refused").exists(), "nothing is started")
        return done.stderr

    def test_a_relay_on_a_board_trips_as_a_native_one_and_its_log_comes_home(self):
        native = self.run_to_end("native", scenario=SHORT)
        first = self.run_to_end("first", self.on(), SHORT, prefix=self.board.prefix())
        self.assert_identical(native, first)
        self.assertIn("copying gridspace-relay", first.stderr())
        log = (first.folder / "logs/relay2.log").read_text()
        self.assertIn("trip", log)
        self.assertEqual(self.board.wait_until_idle(10), [])
        self.assertEqual(self.board.folders_left(), [])
        second = self.run_to_end("second", self.on("ssh:board"), SHORT, prefix=self.board.prefix())
        self.assert_identical(native, second)
        self.assertNotIn("copying", second.stderr(), "it is there already")

    def test_a_restart_of_the_timeline_restarts_it_on_the_board(self):
        scenario = SOURCE / "tests/scenarios/misbehaviour/relay_restarted.yaml"
        native = self.run_to_end("native", scenario=scenario)
        away = self.run_to_end("away", self.on(), scenario, prefix=self.board.prefix())
        self.assert_identical(native, away)

    def test_an_installed_bundle_is_used_as_it_is(self):
        code, _, err = gridspace("bundle", SHORT, "relay2", "--arch", "amd64", "--out", self.folder)
        self.assertEqual(code, OK, err)
        self.board.on_board(f"tar -C /root -xf {self.folder}/gridspace-relay2_amd64.tar.gz")
        run = self.run_to_end("installed", self.on(f"ssh:root@{BOARD}", "processes.relay2.ssh.installed=/root/gridspace-relay2"), SHORT,
                              prefix=self.board.prefix())
        self.assertNotIn("copying", run.stderr())
        self.assertEqual(self.board.on_board("ls /root/.cache 2>/dev/null || true"), "")
        self.assertIn("no/such/folder", self.refused(*self.on(f"ssh:root@{BOARD}", "processes.relay2.ssh.installed=/no/such/folder")))

    def test_a_board_that_is_not_there_is_named_with_the_step(self):
        said = self.refused(*self.on(f"ssh:root@{BOARD}:2299"))
        self.assertIn(f"process 'relay2': root@{BOARD}:2299 (connection): it cannot be reached", said)
        self.assertIn("Connection refused", said)
        said = self.refused(*self.on(f"ssh:root@{NOBODY}"))
        self.assertIn(f"root@{NOBODY} (connection): it cannot be reached", said)

    def test_a_refused_key_is_said_to_be_refused(self):
        for file in ("authorized_keys", "ssh_config"):  # no other key is offered
            (self.board.folder / file).write_text((self.board.folder / file).read_text().replace("/key\n", "/stranger\n"))
        said = self.refused(*self.on())
        self.assertIn(f"root@{BOARD} (connection): it refuses the key", said)
        said = self.refused(*self.on(f"ssh:root@{BOARD}", f"processes.relay2.ssh.identity={self.board.folder}/no_such_key"))
        self.assertIn("no_such_key' cannot be read", said)

    def test_an_unknown_host_key_is_not_accepted(self):
        self.board.known("")
        self.assertIn("host key is not the known one, or not known yet", self.refused(*self.on()))

    def test_a_board_of_another_architecture_is_refused(self):
        self.board.shadow("/usr/bin/uname", "echo riscv64")
        said = self.refused(*self.on())
        self.assertIn(f"root@{BOARD} (copy): it is a 'riscv64'", said)

    def test_a_program_for_another_processor_is_refused(self):
        self.run_to_end("copies_it", self.on(), SHORT, prefix=self.board.prefix())
        self.board.on_board("f=$(ls -d /root/.cache/gridspace/*)/bin/gridspace-relay; printf '\\267\\000' | dd of=$f bs=1 seek=18 conv=notrunc")  # e_machine
        said = self.refused(*self.on())
        self.assertIn(f"root@{BOARD} (check)", said)
        self.assertIn("it is for another processor than the board's (x86_64)", said)

    def test_a_missing_library_is_named(self):
        self.run_to_end("copies_it", self.on(), SHORT, prefix=self.board.prefix())
        self.board.on_board("rm /root/.cache/gridspace/*/lib/libyaml-cpp.so.0.7")
        self.board.shadow("/usr/lib/x86_64-linux-gnu/libyaml-cpp.so.0.7", "")
        said = self.refused(*self.on())
        self.assertIn(f"root@{BOARD} (check)", said)
        self.assertIn("libyaml-cpp.so.0.7", said)

    def test_a_copy_that_does_not_fit_leaves_nothing_and_says_how_much_space_it_needs(self):
        self.board.on_board("mkdir /root/.cache; mount -t tmpfs -o size=2m none /root/.cache")
        said = self.refused(*self.on())
        self.assertRegex(said, rf"root@{BOARD} \(copy\): .*No space left on device\n  it needs \d+\.\d MB in ~/\.cache/gridspace there")
        self.assertEqual(self.board.on_board("ls -A /root/.cache/gridspace"), "")
        self.board.on_board("umount /root/.cache")
        self.run_to_end("with_space", self.on(), SHORT, prefix=self.board.prefix())

    def test_a_missing_capability_is_named(self):
        self.board.start_weak_sshd()
        said = self.refused(*self.on(f"ssh:root@{BOARD}:{WEAK_PORT}"))
        self.assertIn(f"root@{BOARD}:{WEAK_PORT} (check)", said)
        self.assertIn("the capability CAP_SYS_ADMIN is missing", said)

    def test_a_board_that_does_not_answer_is_not_waited_for_for_ever(self):
        self.board.shadow("/usr/bin/uname", "exec sleep 3600")
        said = self.refused(*self.on(), code=STALL)
        self.assertRegex(said, rf"root@{BOARD} \(connection\): not done after \d+ s")

    def test_a_lost_connection_ends_the_run_and_the_program_on_the_board(self):
        run = self.start("lost", [*self.on(), "--set", "simulation.duration_s=100"], SHORT, self.board.prefix())
        run.wait_for_time(0.01)
        self.board.cut_session()
        self.assertEqual(run.finish(), CHILD_DIED, run.stderr())
        self.assertIn(f"root@{BOARD} (connection): the connection is lost", run.stderr())
        self.assertEqual(self.board.wait_until_idle(30), [])

    def test_a_cable_that_is_pulled_ends_the_run_before_the_simulator_wonders(self):
        run = self.start("pulled", [*self.on(), "--set", "simulation.duration_s=100"], SHORT, self.board.prefix())
        run.wait_for_time(0.01)
        self.board.on_machine("ip link set wire down")
        self.assertEqual(run.finish(), CHILD_DIED, run.stderr())
        self.assertRegex(run.stderr(), rf"root@{BOARD} \(connection\): the connection is lost: nothing has come for \d+ s")
        self.assertEqual(self.board.wait_until_idle(60), [])

    def test_nothing_is_left_on_the_board_when_the_launcher_is_killed(self):
        run = self.start("killed", [*self.on(), "--set", "simulation.duration_s=100"], SHORT, self.board.prefix())
        run.wait_for_time(0.01)
        self.assertNotEqual(self.board.devices_alive(), [])
        os.kill(run.pid_of("launcher"), signal.SIGKILL)
        run.finish()
        self.assertEqual(self.board.wait_until_idle(30), [])
        self.assertEqual(self.board.folders_left(), [])

    def test_only_agents_and_gateways_go_to_a_board_and_each_has_a_host_of_its_own(self):
        for setting, what in (("processes.sim.run_on=ssh:root@board", "stays on the machine"),
                              ("processes.recorder.run_on=ssh:root@board", "give it a host of its own"),
                              ("processes.relay2.run_on=ssh:root@", "names no machine"),
                              ("processes.relay2.run_on=ssh:-oProxyCommand=x", "names no machine")):
            code, _, err = gridspace("validate", SHORT, "--set", setting)
            self.assertEqual(code, 2, err)
            self.assertIn(what, err)


if __name__ == "__main__":
    unittest.main()
