# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The program `gridspace`: where it is, and how it is asked."""
from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gridspace.recording import Run

EXPECTATION_FAILED = 1


class Error(Exception):
    """The launcher refused or failed. `code` is its exit code (docs/reference/exit_codes.md), the text is its own."""

    def __init__(self, text: str, code: int):
        super().__init__(text)
        self.code = code


def program() -> str:
    """The path of `gridspace`: in GRIDSPACE_BIN_DIR, in PATH, or built in the tree that this package is in."""
    named = os.environ.get("GRIDSPACE_BIN_DIR")
    built = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin"
    for folder in (named, None, str(built)):
        found = shutil.which("gridspace", path=folder)
        if found and pathlib.Path(found).is_file():
            return found
    raise Error("the program 'gridspace' is not there: build it, or set GRIDSPACE_BIN_DIR to its folder", 2)


def ask(arguments: Sequence[str], accept: Sequence[int] = (0,)) -> str:
    """Runs `gridspace ARGUMENTS` to its end and returns what it printed. Raises Error for a code that is not accepted."""
    done = subprocess.run([program(), *arguments], capture_output=True, text=True, errors="replace", check=False)
    if done.returncode not in accept:
        raise Error((done.stderr.strip() or done.stdout.strip()) or f"gridspace {' '.join(arguments)}: exit code {done.returncode}", done.returncode)
    return done.stdout


def _as_yaml(value: object) -> str:
    if value is None:
        return "~"
    return json.dumps(value) if isinstance(value, (bool, list, tuple, dict)) else str(value)


def run(scenario: str | os.PathLike, *, out: str | os.PathLike | None = None, set: Mapping[str, object] | Sequence[tuple[str, object]] = (),  # noqa: A002 (--set)
        until: str | None = None, speed: str | float | None = None, seed: int | None = None, arguments: Sequence[str] = ()) -> Run:
    """Runs a scenario to its end and returns its recording, whether or not its expectations hold (Run.passed).

    set: values to override by their path, as --set: {"clock.tick_s": 0.25, "processes.monitor": None}; pairs where the order counts. None
    removes what stands there; a text is YAML, as on the command line; a list or dict stands for itself.
    until: simulated time at which it ends ("10s", "2h"). speed: simulated seconds a second, or "max". out: the run folder; a new one in
    the temporary folder of the machine when not given. arguments: further options of `gridspace run`.
    """
    from gridspace.recording import open_run

    folder = pathlib.Path(out) if out is not None else pathlib.Path(tempfile.mkdtemp(prefix="gridspace-")) / "run"
    words = ["run", os.fspath(scenario), "--out", str(folder)]
    for path, value in set.items() if isinstance(set, Mapping) else set:
        words += ["--set", f"{path}={_as_yaml(value)}"]
    for option, value in (("--until", until), ("--speed", speed), ("--seed", seed)):
        if value is not None:
            words += [option, str(value)]
    ask([*words, *arguments], accept=(0, EXPECTATION_FAILED))
    return open_run(folder)
