# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What the benches of the monitor share: the build that they measure, what tests/integration/monitor knows of a monitor, and what a process uses."""
import argparse
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def begin(about, **numbers):
    """The arguments of a bench: --build, and a number for each name, with its default. `client`, `harness` and the tests can be imported
    afterwards, and run the programs of that build."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    for name, default in numbers.items():
        parser.add_argument(f"--{name}", type=type(default), default=default)
    arguments = parser.parse_args()
    os.environ["GRIDSPACE_BIN_DIR"] = str(arguments.build.resolve() / "bin")
    sys.path.insert(0, str(ROOT / "tests/integration/monitor"))
    return arguments


def folder(name):
    return pathlib.Path(tempfile.mkdtemp(prefix=f"gridspace-{name}-"))


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(pid):
    line = next(x for x in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines() if x.startswith("VmRSS"))
    return int(line.split()[1]) / 1024
