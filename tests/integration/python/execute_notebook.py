#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""execute_notebook.py NOTEBOOK OUT: executes a notebook in its own folder, as Jupyter does, and writes it with what came out.

For the Python of the system, which has Debian's python3-nbclient and python3-ipykernel. Exit code 1 when a cell fails; its traceback is printed.
"""
import pathlib
import sys

import nbclient
import nbformat

TIMEOUT_S = 240  # of a cell


def main(file, out):
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    client = nbclient.NotebookClient(notebook, timeout=TIMEOUT_S, startup_timeout=TIMEOUT_S, kernel_name="python3",
                                     resources={"metadata": {"path": str(pathlib.Path(file).parent)}})
    try:
        client.execute()
    except nbclient.exceptions.CellExecutionError as e:
        print(e, file=sys.stderr)
        return 1
    nbformat.write(notebook, out)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
