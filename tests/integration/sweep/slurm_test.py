#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace sweep --slurm` on a cluster of two nodes, one of which is killed in the middle: nothing is lost, nothing is run twice."""
import csv
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
CLUSTER = pathlib.Path(__file__).resolve().parent / "slurm_cluster.sh"
HANG_S = 400
MISSING = [p for p in ("slurmctld", "slurmd", "sbatch", "munged") if not shutil.which(p, path=os.environ["PATH"] + ":/usr/sbin")]

STUDY = f"""
gridspace_study: 1
name: nodes
scenario: {SOURCE}/configs/scenarios/ev_charging.yaml
set: {{processes.monitor: ~, simulation.duration_h: 0.5, report: ~}}
vary:
  load_kw: {{set: simulation.network_changes.loads.L3.p_kw, range: {{from: 5, to: 19, step: 1}}}}
expectations: []
results:
  v_min: {{min_of: bus.*.v_pu, above: 0.1}}
"""


def rows(folder):
    with (folder / "out/results.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def sweep(folder, **kwargs):
    return subprocess.Popen([BIN / "gridspace", "sweep", "study.yaml", "--out", "out", "--slurm"], cwd=folder, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **kwargs)


def processes_of_node(node):
    """Pids of what Slurm has started on a node of this machine; the node's slurmd itself first."""
    out = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words, environment = (entry / "cmdline").read_bytes().split(b"\0"), (entry / "environ").read_bytes().split(b"\0")
            except OSError:
                continue
            if words[0].endswith(b"slurmd") and node.encode() in words:
                out.insert(0, int(entry.name))
            elif f"SLURMD_NODENAME={node}".encode() in environment:
                out.append(int(entry.name))
    return out


class Inside(unittest.TestCase):
    """In the namespaces of the cluster."""

    def setUp(self):
        self.folder = pathlib.Path(os.environ["GRIDSPACE_TEST_FOLDER"]) / self.id().rpartition(".")[2]
        self.folder.mkdir()
        (self.folder / "study.yaml").write_text(STUDY)

    def records(self):
        return {f: f.stat().st_mtime_ns for f in self.folder.glob("out/runs/*/record.json")}

    def wait_for_records(self, process, count):
        deadline = time.monotonic() + HANG_S
        while len(self.records()) < count:
            self.assertIsNone(process.poll(), "it ended too early")
            self.assertLess(time.monotonic(), deadline, "no results came")
            time.sleep(0.02)

    def check_all(self, process, before):
        text, _ = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 0, text)
        self.assertEqual([r["state"] for r in rows(self.folder)], ["passed"] * 15, text)
        self.assertEqual(before, {f: t for f, t in self.records().items() if f in before}, "a run that was done was done again")

    def test_a_node_is_killed_and_nothing_is_lost(self):
        process = sweep(self.folder)
        self.wait_for_records(process, 2)
        deadline = time.monotonic() + HANG_S
        while len(victims := processes_of_node("n1")) < 3:  # slurmd, the task, and a run of it
            self.assertLess(time.monotonic(), deadline, "the node got nothing to do")
        before = self.records()
        for pid in victims:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.check_all(process, before)
        self.assertTrue(list(self.folder.glob("out/slurm/job")))
        subprocess.run(["/usr/sbin/slurmd", "-c", "-N", "n1"], check=True)
        subprocess.run(["scontrol", "update", "nodename=n1", "state=resume"], check=False, capture_output=True)

    def test_a_sweep_that_is_killed_finds_its_job_again(self):
        process = sweep(self.folder)
        self.wait_for_records(process, 2)
        process.kill()
        process.communicate()
        job = (self.folder / "out/slurm/job").read_text()
        self.check_all(sweep(self.folder), self.records())
        self.assertEqual(job, (self.folder / "out/slurm/job").read_text(), "it was submitted twice")


class Cluster(unittest.TestCase):
    def test_without_slurm_it_says_what_is_missing(self):
        with tempfile.TemporaryDirectory(prefix="gridspace-slurm-") as folder:
            folder = pathlib.Path(folder)
            (folder / "study.yaml").write_text(STUDY)
            process = sweep(folder, env={**os.environ, "PATH": str(folder)})
            text, _ = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 3, text)
        self.assertIn("Slurm does not take the job", text)

    def test_a_job_that_nobody_can_ask_for_ends_the_sweep(self):
        with tempfile.TemporaryDirectory(prefix="gridspace-slurm-") as folder:
            folder = pathlib.Path(folder)
            (folder / "study.yaml").write_text(STUDY)
            (folder / "out/slurm").mkdir(parents=True)
            (folder / "out/slurm/job").write_text("7")  # a sweep was killed here, and squeue is gone
            process = sweep(folder, env={**os.environ, "PATH": str(folder)})
            text, _ = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 3, text)
        self.assertIn("nobody knows whether job 7 of Slurm still runs", text)

    @unittest.skipIf(os.geteuid() != 0 or (MISSING and "GRIDSPACE_TEST_ALL" not in os.environ), f"needs root, and {', '.join(MISSING) or 'nothing else'}")
    def test_on_two_nodes(self):
        with tempfile.TemporaryDirectory(prefix="gridspace-slurm-") as folder:
            command = [CLUSTER, pathlib.Path(folder) / "cluster", sys.executable, __file__, "-v", "Inside"]
            done = subprocess.run(command, env={**os.environ, "GRIDSPACE_TEST_FOLDER": folder}, capture_output=True, text=True, timeout=2 * HANG_S, check=False)
            logs = "\n".join(f"{f}:\n{f.read_text()[-2000:]}" for f in pathlib.Path(folder).glob("cluster/*.log"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr + logs)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *([] if "Inside" in sys.argv else ["Cluster"]), *sys.argv[1:]])
