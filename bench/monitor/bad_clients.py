#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""How fast bad clients are turned away by the monitor of a live run, and how long a good request takes meanwhile: beside 1000 sockets, and beside
slow readers. That each is answered as it should be is tests/integration/monitor/bad_clients_test.py; the times are figures of this machine.

  python3 bench/monitor/bad_clients.py [--build build/release] [--repeat 200]"""
import argparse
import os
import pathlib
import signal
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeat", type=int, default=200)
    arguments = parser.parse_args()
    os.environ["GRIDSPACE_BIN_DIR"] = str(arguments.build.resolve() / "bin")
    sys.path.insert(0, str(ROOT / "tests/integration/monitor"))
    import bad_clients_test
    import client
    import harness

    run = harness.Run(pathlib.Path(tempfile.mkdtemp(prefix="gridspace-bad-")) / "run", harness.CASE_1, ["--speed", "60", "--allow-control"])
    try:
        monitor = client.monitor_of(run)
        monitor.until("/api/v1/run", lambda r: r["state"] == "running", "the run to run")
        wrong = bad_clients_test.assault(monitor, arguments.repeat)
        print("\n".join(wrong) or "everybody was answered as expected, and all processes are alive")
        return 1 if wrong else 0
    finally:
        run.process.send_signal(signal.SIGINT)
        run.finish()


if __name__ == "__main__":
    sys.exit(main())
