# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What `./gridspace bench` measures: each function runs something once and gives figures. A figure with a baseline was taken beside it
in the same run."""
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator

ROOT = pathlib.Path(__file__).resolve().parents[1]
CASE_2 = "configs/scenarios/protection_lockstep.yaml"
LONGEST_S = 900


class NotMeasured(Exception):
    """Why a measure could not be taken."""


@dataclasses.dataclass
class Figure:
    """One value of one round. aim: as the project states it, for the value or, where there is a baseline, for value / baseline."""
    key: str
    what: str
    value: float
    unit: str
    more_is_better: bool
    baseline: float | None = None
    baseline_what: str = ""
    aim: float | None = None


@dataclasses.dataclass
class Build:
    """The folder of the preset `bench`."""
    folder: pathlib.Path

    def output(self, *words: str) -> str:
        """What a program of this build prints; NotMeasured with its last line when it fails."""
        command = [str(self.folder / words[0]), *words[1:]]
        try:
            done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=LONGEST_S)
        except subprocess.TimeoutExpired as e:
            raise NotMeasured(f"{words[0]} was not ready within {LONGEST_S} s") from e
        except OSError as e:
            raise NotMeasured(f"{words[0]}: {e.strerror}") from e
        if done.returncode != 0:
            raise NotMeasured(f"{words[0]} ended with {done.returncode}: {(done.stderr or done.stdout).strip().splitlines()[-1:] or ''}")
        return done.stdout

    def run(self, scenario: str, *options: str) -> tuple[dict, dict[str, int], float]:
        """(summary, octets of the files of its folder, wall time of the command) of a run."""
        with tempfile.TemporaryDirectory(prefix="gridspace-bench-") as folder:
            began = time.monotonic()
            command = [str(self.folder / "bin/gridspace"), "run", scenario, "--quiet", "--out", f"{folder}/run", "--set", "expect=~", *options]
            done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=LONGEST_S)
            took_s = time.monotonic() - began
            if done.returncode != 0:
                raise NotMeasured(f"{scenario} ended with {done.returncode}: {done.stderr.strip()[:200]}")
            files = {file.name: file.stat().st_size for file in pathlib.Path(folder, "run").iterdir() if file.is_file()}
            return json.loads(pathlib.Path(folder, "run/report/summary.json").read_text()), files, took_s


def codec(build: Build) -> Iterator[Figure]:
    """Nanoseconds of processor time for one frame."""
    aims = {"decode_sv_frame/le92": 18, "encode_goose/1": 30, "decode_goose_frame/1": 60,
            "authenticated_streams/hmac_sha256": 1000, "authenticated_streams/aes_gmac": 1000}
    for one in json.loads(build.output("bench/bench_wire_codec", "--benchmark_format=json", "--benchmark_min_time=0.2"))["benchmarks"]:
        yield Figure(one["name"], one["name"].replace("_", " "), one["cpu_time"], "ns", False, aim=aims.get(one["name"]))


def forecaster(build: Build) -> Iterator[Figure]:
    """Nanoseconds of processor time for the forecast of one phase-sample, and of a plain loop over 20 samples."""
    aims = {"ar_20": 35, "mlp_20_10_1": 200}
    found = {one["name"]: one["cpu_time"] / one["phases"]
             for one in json.loads(build.output("bench/bench_forecaster", "--benchmark_format=json", "--benchmark_min_time=0.2"))["benchmarks"]}
    for name, value in found.items():
        yield Figure(name, f"a forecast of {name}" if name != "plain_loop" else "a plain loop over 20 samples", value, "ns", False, aim=aims.get(name))


def wire(build: Build) -> Iterator[Figure]:
    """Frames over a virtual cable, compared with bare packet sockets."""
    found = json.loads(build.output("bench/bench_wire_frames"))
    yield Figure("one_way_p50", "a frame from sender to receiver, p50", found["one_way_us"]["p50"], "us", False, found["bare_one_way_us"]["p50"], "bare packet sockets")
    yield Figure("batch", "frames sent in batches", found["send_batch_per_s"], "frames/s", True, found["send_single_per_s"], "one by one")


def streams(build: Build) -> Iterator[Figure]:
    """Many streams at once over a virtual cable, compared with bare packet sockets that send and count equal frames."""
    bare_what = "bare packet sockets"
    for name, found in json.loads(build.output("bench/bench_wire_streams", "--seconds", "5")).items():
        ours, bare = found["ours"], found["bare"]
        yield Figure(f"{name} lost", f"{name}: samples lost", ours["lost"], "samples", False, aim=0)
        yield Figure(f"{name} rate", f"{name}: of the frames that are due", 100 * ours["frames_per_s"] / found["due_per_s"], "%", True, aim=99.99)
        yield Figure(f"{name} p99.9", f"{name}: due until read, p99.9", ours["delay_us"]["p99.9"], "us", False, bare["delay_us"]["p99.9"], bare_what)
        for way in "send", "receive":
            yield Figure(f"{name} {way}", f"{name}: a frame's processor time to {way}", ours[f"{way}_cpu_ns"], "ns", False, bare[f"{way}_cpu_ns"], bare_what)


def lockstep(build: Build) -> Iterator[Figure]:
    """Steps a second of the whole contract, compared with a bare Fast DDS ping-pong of the same shape."""
    aims = {1: 1.0, 4: 0.9, 16: 0.8, 50: 0.8}
    rows = re.findall(r"^ +(\d+) +(\d+) \(.*?\) +(\d+) \(.*?\) +(\d+) \(", build.output("bench/bench_lockstep", *map(str, aims)), re.MULTILINE)
    for members, shared, contract, bare in rows:
        what, aim = f"contract with {members} members", aims.get(int(members))
        yield Figure(f"members_{members}_as_run", f"{what}, as `run` starts it", float(shared), "steps/s", True, float(bare), "bare Fast DDS", aim)
        yield Figure(f"members_{members}", f"{what}, all of it over DDS", float(contract), "steps/s", True, float(bare), "bare Fast DDS", aim)


def emt(build: Build) -> Iterator[Figure]:
    """Waveform steps, and ngspice on the same circuit."""
    text = build.output("bench/bench_emt")
    rows = re.findall(r"^(\S.*?) +(\d+) buses +p50 +([\d.]+) .*? ([\d.]+) x real time", text, re.MULTILINE)
    for name, buses, p50, speed in rows:
        yield Figure(f"{name} {buses}", f"{name.strip()}, {buses} buses: speed", float(speed), "x real time", True)
        yield Figure(f"{name} {buses} step", f"{name.strip()}, {buses} buses: a step, p50", float(p50), "us", False)
    steps = {name: float(p50) for name, _, p50, _ in rows}
    for name, p50 in steps.items():
        if "threads: 2" in name:
            yield Figure(f"{name} ratio", f"{name}: a step, p50", p50, "us", False, steps[name.replace("threads: 2", "threads: 1")], "one thread")
    if both := re.search(r"gridspace +([\d.]+) s.*\n +ngspice +([\d.]+) s", text):
        yield Figure("coupled_sections", "12 coupled three-phase sections, 1 s", float(both[1]), "s", False, float(both[2]), "ngspice")


def speeds(build: Build) -> Iterator[Figure]:
    """Lockstep, simulated seconds a second; the recorder's share."""
    no_monitor, no_recording = ("--set", "processes.monitor=~"), ("--set", "record={samples: none, frames: none}")
    for key, what, scenario, options, aim in (
            ("case_2", "case 2 as shipped", CASE_2, (), 2.5),
            ("case_2_no_monitor", "case 2 without the monitor", CASE_2, no_monitor, 3),
            ("case_2_bare", "case 2 without monitor and recording", CASE_2, (*no_monitor, *no_recording), 4),
            ("case_3", "case 3 (fdi_ids_supervised)", "configs/scenarios/fdi_ids_supervised.yaml", (), 1)):
        summary, files, took_s = build.run(scenario, *options)
        yield Figure(key, f"{what}: speed", summary["simulated_s"] / summary["wall_s"], "x real time", True, aim=aim)
        if key == "case_2":
            used = {process["name"]: process["cpu_s"] for process in summary["processes"]}
            yield Figure("recorder_share", "case 2: the recorder's share of the processor time", 100 * used["recorder"] / sum(used.values()), "%", False, aim=15)
            yield Figure("recording", "case 2: octets recorded", sum(files.values()) / summary["simulated_s"] / 1e6, "MB per simulated s", False, aim=252e9 / 3 / 86400 / 1e6)
            yield Figure("case_2_around", "case 2: start, end and report", took_s - summary["wall_s"], "s", False)
    summary, _, _ = build.run("configs/scenarios/ev_charging.yaml")
    yield Figure("case_1", "case 1, 8 h", summary["wall_s"], "s", False, aim=3)


def start(build: Build) -> Iterator[Figure]:
    """From the command to the first tick."""
    for key, what, scenario in (("case_1", "case 1", "configs/scenarios/ev_charging.yaml"), ("case_2", "case 2 in lockstep", CASE_2)):
        with tempfile.TemporaryDirectory(prefix="gridspace-bench-") as folder:
            began = time.monotonic()
            command = [str(build.folder / "bin/gridspace"), "run", scenario, "--out", f"{folder}/run", "--set", "expect=~", "--until", "1 s"]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=ROOT) as run:
                ready_s = next((time.monotonic() - began for line in run.stderr if "processes are ready" in line), None)
                run.stderr.read()
                if run.wait(LONGEST_S) != 0 or ready_s is None:
                    raise NotMeasured(f"{scenario} did not start")
        yield Figure(f"{key}_start", f"{what}: from the command to the first tick", ready_s, "s", False, aim=0.7)


def real_time(build: Build) -> Iterator[Figure]:
    """Case 2 in real time, 8 s, compared with what the machine itself can do."""
    summary, _, _ = build.run("configs/scenarios/protection.yaml")
    yield Figure("overruns", "case 2 in real time: late ticks", summary["overruns"], "ticks", False, aim=10 * summary["simulated_s"] / 60)
    yield Figure("late_p99", "a tick is late by, p99", summary["ticks"]["p99_us"], "us", False)
    smv = summary["wire_timing"]["smv"]["SMV21"]
    for share, aim in (("p50", 2), ("p99", 2.2)):
        yield Figure(f"age_{share}", f"age of a sample when its frame is sent, {share}", smv["publish_age_ms"][share], "ms", False, aim=aim)
    yield Figure("rate", "rate of a stream", smv["rate_hz"], "Hz", True)
    latency = json.loads(build.output("bin/gridspace", "doctor", "--latency", "--seconds", "3", "--json"))
    ways = [way for way in latency["ways"] if "p99_us" in way and way["waiting"] != "polling"]
    yield Figure("wakeup_p99", f"a wake-up of this machine ({ways[-1]['waiting']}), p99", ways[-1]["p99_us"], "us", False, ways[0]["p99_us"], "sleeping")


def python_agent(build: Build) -> Iterator[Figure]:
    """A tick of an agent in Python, compared with the same in C++."""
    text = subprocess.run([sys.executable, "bench/python/bench_python.py", "1"], capture_output=True, text=True, cwd=ROOT, timeout=LONGEST_S,
                          env={**os.environ, "GRIDSPACE_BIN_DIR": str(build.folder / "bin")})
    found = re.search(r"C\+\+ \d+ us of processor time \((-?\d+) us of wall time\), of Python \d+ \((-?\d+)\)", text.stdout)
    if not found:
        raise NotMeasured(f"bench_python.py: {(text.stderr or text.stdout).strip()[-200:]}")
    yield Figure("tick", "a tick with an agent in Python", float(found[2]), "us", False, float(found[1]), "in C++")


def simulated_time(build: Build) -> Iterator[Figure]:
    """A call that is intercepted in simulated time, compared with the same in real time."""
    for call, real, held in re.findall(r"^(\w+) +([\d.]+) +([\d.]+)$", build.output("bench/bench_timebox"), re.MULTILINE):
        yield Figure(call, "the kernel's bare stop, below which no held call can be" if call == "stop" else f"a held {call}", float(held), "us", False, float(real), "real time")


MEASURES: dict[str, Callable[[Build], Iterator[Figure]]] = {
    "codec": codec, "forecaster": forecaster, "wire": wire, "streams": streams, "emt": emt, "lockstep": lockstep, "speeds": speeds, "start": start, "real_time": real_time, "python": python_agent, "timebox": simulated_time}
