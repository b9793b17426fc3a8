# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs Gridspace scenarios, reads their recordings, and is what agents in Python are made of. Only the standard library is needed; with
pandas there are DataFrames, with matplotlib drawings, with numpy views of sequences."""
from gridspace.agent import Agent
from gridspace.declaration import Reads, ReadsStream, Setting, Signal, Writes, WritesStream
from gridspace.launcher import Error, run
from gridspace.recording import Event, Expectation, Run, open_run
from gridspace.samples import Sample, sample_type
from gridspace.sweeps import Sweep, sweep

open = open_run  # noqa: A001 (gridspace.open, as of a file)

__all__ = [
    "Agent", "Error", "Event", "Expectation", "Reads", "ReadsStream", "Run", "Sample", "Setting", "Signal", "Sweep", "Writes", "WritesStream", "open", "run", "sample_type",
    "sweep",
]
