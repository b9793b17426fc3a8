#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""How fast bad clients are turned away by the monitor of a live run, and how long a good request takes meanwhile: beside 1000 sockets, and beside
slow readers. That each is answered as it should be is tests/integration/monitor/bad_clients_test.py; the times are figures of this machine.

  python3 bench/monitor/bad_clients.py [--build build/release] [--repeat 200]"""
import signal
import sys

import shared


def main():
    arguments = shared.begin(__doc__, repeat=200)
    import bad_clients_test
    import client
    import harness

    run = harness.Run(shared.folder("bad") / "run", harness.CASE_1, ["--speed", "60", "--allow-control"])
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
