#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a device costs on ARM64: the tables of docs/reference/arm64.md, measured again.

  ./gridspace arm64 measure            prints them
  ./gridspace arm64 measure --write    and puts them into the page

On the emulated board `-icount shift=0,sleep=off` makes the virtual clock advance by one nanosecond an instruction, so that its
nanoseconds are instructions; a steal of the host's processor does not disturb them.
"""
import argparse
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARM64, NATIVE = ROOT / "build/arm64", ROOT / "build/release"
SYSROOT, BOARD = ROOT / "build/arm64-sysroot", ROOT / "build/arm64-board"
PAGE = ROOT / "docs/reference/arm64.md"
MODELS = {"relay alone": None, "relay and AR(20)": "ar_20.json", "relay and 20-10-1 network": "mlp_20_10_1.json"}
PROGRAMS = {"relay": "gridspace-relay", "merging unit": "gridspace-mu", "breaker IED": "gridspace-breaker", "EV agent": "gridspace-ev", "MCCA": "gridspace-mcca",
            "cable": "gridspace-cable"}
QEMU_USER = [shutil.which("qemu-aarch64-static") or "qemu-aarch64-static", "-L", str(SYSROOT)]
BUDGET_US, CLOCK_GHZ = 1e6 / 4800, 1.5
# Instructions in a cycle. A Cortex-A53 issues two at best; compiled floating-point code of this kind gets less than one.
PER_CYCLE = (0.7, 1.0)
PASSES = 3


def output(*words, **kwargs):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=600, **kwargs)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(c) for c in line) + " |" for line in lines) + "\n"


def processor_time(*words):
    """Least of five, in seconds."""
    best = float("inf")
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        output(*words)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        best = min(best, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return best


def sample_us(*emulator, program, model):
    words = [*emulator, program, "20", *([ROOT / "configs/models" / model] if model else [])]
    return int(re.match(r"(\d+) ns", output(*words))[1]) / 1e3


class Relay:
    """A relay of case 2, or of case 3 with its detector, that waits for the clock: all its memory is there."""

    def __init__(self, folder, name, scenario):
        self.tree = folder / name
        self.tree.mkdir()
        output(NATIVE / "bin/gridspace", "bundle", ROOT / "configs/scenarios" / scenario, "relay2", "--out", self.tree)
        output("tar", "-C", self.tree, "-xf", self.tree / "gridspace-relay2_arm64.tar.gz")
        self.conf = self.tree / "gridspace-relay2/conf"
        text = (self.conf / "config.yaml").read_text().replace("/opt/gridspace-relay2/conf", str(self.conf))
        text = re.sub(r"\b10\.254\.\d+\.\d+", "127.0.0.1", text).replace('interface: "process_bus"', 'interface: "lo"')
        self.config = self.conf / "alone.yaml"
        self.config.write_text(text)

    def native_mb(self):
        relay = subprocess.Popen(["unshare", "-rn", "sh", "-c", f"ip link set lo up; exec {NATIVE}/bin/gridspace-relay --config {self.config}"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        status = pathlib.Path(f"/proc/{relay.pid}/status")
        seen, since = 0, time.monotonic()
        while time.monotonic() - since < 2:
            now = int(re.search(r"VmHWM:\s+(\d+)", status.read_text())[1])
            if now != seen:
                seen, since = now, time.monotonic()
            time.sleep(0.05)
        relay.send_signal(signal.SIGTERM)
        relay.wait()
        return seen / 1024


def on_board(folder, relays):
    """What the board's console says about a script of ours, with -icount."""
    stage = folder / "board"
    (stage / "gridspace").mkdir(parents=True)
    (stage / "gridspace/network").write_text("")
    (stage / "gridspace/environment").write_text("")
    (stage / "gridspace/command").write_text("/bin/busybox\nsh\n/gridspace/measure.sh\n")
    script = ["ip link set lo up", "ip link set lo multicast on", "ip route add 224.0.0.0/4 dev lo"]
    shutil.copy(ARM64 / "tests/sample_cost", stage / "gridspace/sample_cost")
    for name, model in MODELS.items():
        if model:
            shutil.copy(ROOT / "configs/models" / model, stage / "gridspace" / model)
        script.append(f"echo \"@sample {name}: $(/gridspace/sample_cost {PASSES} {'/gridspace/' + model if model else ''})\"")
    # One pass more than none is the start: the clock of /proc/uptime is too coarse, and the shell's own steps are small beside it.
    script.append('a=$(cut -d" " -f1 /proc/uptime); for i in 1 2 3 4 5; do /bin/gridspace-relay --version >/dev/null; done; b=$(cut -d" " -f1 /proc/uptime); echo "@start $a $b"')
    for name, relay in relays.items():
        there = stage / str(relay.conf).lstrip("/")
        shutil.copytree(relay.conf, there)
        script.append(f"/bin/gridspace-relay --config {relay.config} >/dev/null 2>&1 & sleep 5; grep VmHWM /proc/$!/status | sed 's/^/@memory {name}: /'; kill $!; wait")
    (stage / "gridspace/measure.sh").write_text("\n".join(script) + "\n")
    archive = subprocess.run("find . | cpio --quiet -o -H newc", shell=True, cwd=stage, capture_output=True, check=True).stdout
    initrd = folder / "initrd"
    initrd.write_bytes((BOARD / "initramfs").read_bytes() + archive)
    return output("qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a53", "-smp", 1, "-m", 384, "-nodefaults", "-display", "none", "-no-reboot",
                  "-icount", "shift=0,sleep=off", "-kernel", BOARD / "vmlinuz", "-initrd", initrd,
                  "-append", "quiet loglevel=3 console=ttyAMA0 panic=-1 ipv6.disable=1", "-chardev", "stdio,id=console,signal=off", "-serial", "chardev:console",
                  stdin=subprocess.DEVNULL)


def found(pattern, text):
    match = re.search(pattern, text)
    if not match:
        sys.exit(f"the board did not say {pattern}:\n{text}")
    return match


def memory_mb(name, console):
    return int(found(rf"@memory {re.escape(name)}: VmHWM:\s+(\d+)", console)[1]) / 1024


def percent(us):
    return f"{100 * us / BUDGET_US:.1f}"


def measure(folder):
    out = ["Size:\n"]
    code = [int(output("aarch64-linux-gnu-size", ARM64 / "bin" / p).splitlines()[1].split()[0]) / 1e6 for p in PROGRAMS.values()]
    out.append(table(["", *PROGRAMS], [["code and constants, MB", *(f"{c:.1f}" for c in code)]]))
    relays = {"relay": Relay(folder, "relay", "protection_lockstep.yaml"), "relay and 20-10-1 network": Relay(folder, "ids", "fdi_ids.yaml")}
    bundle = {ending: (relays["relay"].tree / f"gridspace-relay2_arm64.{ending}").stat().st_size / 1e6 for ending in ("deb", "tar.gz")}
    out.append(f"A relay's Debian package has {bundle['deb']:.1f} MB, its tarball, with Fast DDS and everything else but the C library, {bundle['tar.gz']:.1f} MB.\n")

    console = on_board(folder, relays)
    out.append("One sample of a line (both ends, three phases), of which there are 4800 a second:\n")
    rows = []
    for name, model in MODELS.items():
        instructions = int(found(rf"@sample {re.escape(name)}: (\d+) ns", console)[1])
        low, high = (instructions / (per * CLOCK_GHZ * 1e3) for per in reversed(PER_CYCLE))
        native, emulated = (sample_us(program=NATIVE / "tests/sample_cost", model=model), sample_us(*QEMU_USER, program=ARM64 / "tests/sample_cost", model=model))
        rows.append([name, f"{instructions:,}", f"{low:.1f} to {high:.1f}", f"{percent(low)} to {percent(high)} %", f"{native:.2f}", f"{emulated:.0f}"])
    out.append(table(["", "ARM64 instructions", "Cortex-A53 at 1.5 GHz, estimated, us", f"of the {BUDGET_US:.1f} us of a sample", "native x86-64, us", "qemu-user, us"], rows))

    begin, end = map(float, found(r"@start (\S+) (\S+)", console).groups())
    instructions = (end - begin) * 1e9 / 5
    native, emulated = processor_time(NATIVE / "bin/gridspace-relay", "--version"), processor_time(*QEMU_USER, ARM64 / "bin/gridspace-relay", "--version")
    out.append("Start-up and memory of a relay:\n")
    out.append(table(["", "ARM64 board", "native x86-64", "qemu-user"], [
        ["start to the end of `--version`", f"{instructions / 1e6:.0f} million instructions, {instructions / 1e6 / CLOCK_GHZ / PER_CYCLE[1]:.0f} to "
         f"{instructions / 1e6 / CLOCK_GHZ / PER_CYCLE[0]:.0f} ms at 1.5 GHz", f"{native * 1e3:.0f} ms", f"{emulated * 1e3:.0f} ms"],
        *[[f"memory (peak RSS), {name}", f"{memory_mb(name, console):.0f} MB", f"{relay.native_mb():.0f} MB", ""]
          for name, relay in relays.items()]]))
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="put the tables into docs/reference/arm64.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gridspace_measure_") as folder:
        text = measure(pathlib.Path(folder))
    print(text)
    if arguments.write:
        page = PAGE.read_text()
        begin, end = "<!-- measured: begin -->\n", "<!-- measured: end -->"
        PAGE.write_text(page[:page.index(begin) + len(begin)] + "\n" + text + "\n" + page[page.index(end):])
    return 0


if __name__ == "__main__":
    os.environ.setdefault("PYTHONUNBUFFERED", "1")
    sys.exit(main())
