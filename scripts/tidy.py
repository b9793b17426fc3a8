#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""clang-tidy on every source whose text, headers, flags or rules have changed since it was last found clean, newest change first.

What is clean is remembered in the user's cache by content, for every clone. With --seconds it stops in time, and says what is left for
the next run. A file that was looked at and is not clean fails the command, but with --commits N only if it changed in the last N commits:
of older ones the findings are shown.
"""
import argparse
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
BUILD = ROOT / "build/asan"


def cache_folder():
    script = f"source {shlex.quote(str(ROOT / 'scripts/cache.sh'))} && gridspace_cache"
    return pathlib.Path(subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.strip()) / "tidy"


@functools.cache
def digest(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


@functools.cache
def included(file):
    """The project's headers that a file names, directly. (What the compiler would skip counts too: a key may change too often.)"""
    out = []
    for line in file.read_text(errors="replace").splitlines():
        words = line.strip().split('"')
        if line.lstrip().startswith("#") and "include" in words[0] and len(words) >= 3:
            for base in (ROOT, file.parent):
                if (base / words[1]).is_file():
                    out.append((base / words[1]).resolve())
                    break
    return out


def closure(file):
    seen, todo = set(), [file]
    while todo:
        for header in included(todo.pop()):
            if header not in seen:
                seen.add(header)
                todo.append(header)
    return sorted(seen)


def single(commands):
    """The commands with those of sources that are compiled together (GRIDSPACE_TOGETHER) taken apart, one for each."""
    out = []
    for entry in commands:
        file = pathlib.Path(entry["file"])
        sources = [ROOT / line.split('"')[1] for line in file.read_text().splitlines()] if file.parent.name == "together" and file.suffix == ".cpp" else [file]
        for source in sources:
            out.append({**entry, "file": str(source), "command": entry["command"].replace(str(file), str(source))})
    return out


def key(entry, version):
    """What a verdict depends on, as one hash: no path of this clone is in it."""
    file = pathlib.Path(entry["file"])
    command = re.sub(r" -o \S+", "", entry["command"]).replace(str(ROOT), "")
    parts = [version, (ROOT / ".clang-tidy").read_text(), command, digest(file)]
    parts += [digest(h) for h in closure(file)]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def changed_last():
    """{file: how long ago its last commit was}, in commits; what is not committed comes first."""
    log = subprocess.run(["git", "-C", ROOT, "log", "-n", "300", "--name-only", "--format=%x00"], capture_output=True, text=True, check=False).stdout
    order = {}
    for age, names in enumerate(log.split("\0")):
        for name in names.split():
            order.setdefault(name, age)
    for line in subprocess.run(["git", "-C", ROOT, "status", "--porcelain"], capture_output=True, text=True, check=False).stdout.splitlines():
        order[line[3:]] = -1
    return order


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no further file after so long")
    parser.add_argument("--commits", type=int, default=10**9, help="findings in files that are older are shown and do not fail")
    arguments = parser.parse_args()
    database = BUILD / "compile_commands.json"
    if not database.exists():
        sys.exit("build/asan/compile_commands.json is not there: cmake --preset asan")
    began = time.monotonic()
    version = subprocess.run(["clang-tidy-19", "--version"], capture_output=True, text=True, check=True).stdout
    clean = cache_folder()
    clean.mkdir(parents=True, exist_ok=True)
    age = changed_last()
    entries = []
    commands = single(json.loads(database.read_text()))
    for entry in commands: # without what is precompiled, so that a missing include is found
        entry["command"] = re.sub(r" -Winvalid-pch| -include-pch \S+| -Xclang -fno-pch-timestamp", "", entry["command"])
    plain = BUILD / "tidy"
    plain.mkdir(exist_ok=True)
    (plain / "compile_commands.json").write_text(json.dumps(commands))
    for entry in commands:
        name = os.path.relpath(entry["file"], ROOT)
        if not name.startswith(("..", "build/", "tests/", "bench/")):
            entries.append((age.get(name, 1000), name, entry))
    entries = [(name, clean / key(entry, version)) for _, name, entry in sorted(entries, key=lambda e: e[:2])]
    todo = [(name, mark) for name, mark in entries if not mark.exists()]

    def check(task):
        name, mark = task
        if time.monotonic() - began > arguments.seconds:
            return None
        done = subprocess.run(["clang-tidy-19", "-p", plain, "--quiet", "--warnings-as-errors=*", ROOT / name], capture_output=True, text=True)
        if done.returncode == 0:
            mark.touch()
        return name, done.returncode, done.stdout

    dirty, old, left = 0, 0, 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for result in pool.map(check, todo):
            if result is None:
                left += 1
            elif result[1] != 0:
                is_old = age.get(result[0], 10**9) >= arguments.commits
                old, dirty = old + is_old, dirty + (not is_old)
                print(result[2].replace(str(ROOT) + "/", ""))
    print(f"{len(entries)} sources: {len(entries) - len(todo)} known to be clean, {len(todo) - left} checked, {dirty} not clean, {old} older ones not clean, {left} left for the next run")
    return 1 if dirty else 0


if __name__ == "__main__":
    sys.exit(main())
