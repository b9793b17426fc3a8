# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs Gridspace scenarios and reads their recordings. Only the standard library is needed; with pandas there are DataFrames."""
from gridspace.launcher import Error, run
from gridspace.recording import Event, Expectation, Run, Signal, open_run

open = open_run  # noqa: A001 (gridspace.open, as of a file)

__all__ = ["Error", "Event", "Expectation", "Run", "Signal", "open", "run"]
