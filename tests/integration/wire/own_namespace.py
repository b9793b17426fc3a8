# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests with cables of their own: the whole test program runs once more in a network namespace, as root or not."""
import json
import os
import subprocess
import sys
import time
import unittest

INSIDE = "GRIDSPACE_TEST_IN_OWN_NAMESPACE"
DDS_CABLE = ("ip link set lo up && ip link add dds type veth peer name dds1 && ip link set dds1 up && "
             "ip addr add 10.99.0.1/24 dev dds && ip link set dds up && ip route add 239.0.0.0/8 dev dds")


def cable(a, b):
    """Two ends of a cable that carry frames: the kernel starts an interface's queue a moment after its link came up, and
    drops what is sent before."""
    subprocess.run(f"ip link add {a} type veth peer name {b} && ip link set {a} up && ip link set {b} up", shell=True, check=True)
    deadline = time.monotonic() + 60
    for end in (a, b):
        while json.loads(subprocess.run(["ip", "-j", "link", "show", end], check=True, capture_output=True).stdout)[0]["operstate"] != "UP":
            assert time.monotonic() < deadline, f"{end} does not come up"


def main(prepare=None):
    """`prepare`: a shell command that is run inside, before the tests; DDS_CABLE makes an interface with multicast, dds, 10.99.0.1."""
    if INSIDE not in os.environ:
        kind = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
        os.environ["PATH"] = "/usr/sbin:/sbin:" + os.environ["PATH"]
        os.execvpe(kind[0], [*kind, sys.executable, *sys.argv], {**os.environ, INSIDE: "1"})
    if prepare:
        subprocess.run(prepare, shell=True, check=True)
    unittest.main()
