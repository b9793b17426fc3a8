# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""libgridspace: where it is, and its functions (sdk/gridspace/agent.h) for ctypes."""
from __future__ import annotations

import contextlib
import ctypes
import ctypes.util
import functools
import os
import pathlib

from gridspace.launcher import Error, program

ABI_VERSION = 1
NAME = "libgridspace.so.1"

_agent, _text, _number = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int
Begin = ctypes.CFUNCTYPE(_number, _agent, ctypes.c_void_p)
SampleCame = ctypes.CFUNCTYPE(_number, _agent, _number, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
Due = ctypes.CFUNCTYPE(_number, _agent, _number, ctypes.c_void_p)
End = ctypes.CFUNCTYPE(None, _agent, ctypes.c_void_p)


class Program(ctypes.Structure):
    """gridspace_program."""

    _fields_ = [("size", ctypes.c_size_t), ("description", _text), ("folder", _text), ("user", ctypes.c_void_p),
                ("begin", Begin), ("sample", SampleCame), ("due", Due), ("end", End)]


_FUNCTIONS = {  # name: (result, arguments)
    "main": (_number, [ctypes.POINTER(Program), _number, ctypes.POINTER(_text)]),
    "abi_version": (ctypes.c_uint, []),
    "last_error": (_text, []),
    "now_ns": (ctypes.c_int64, [_agent]),
    "now_s": (ctypes.c_double, [_agent]),
    "effect_ns": (ctypes.c_int64, [_agent]),
    "is_lockstep": (_number, [_agent]),
    "process": (_text, [_agent]),
    "every": (_number, [_agent, _text]),
    "at": (_number, [_agent, ctypes.c_int64]),
    "cancel": (_number, [_agent, _number]),
    "settings": (_text, [_agent]),
    "topics": (_text, [_agent]),
    "write": (_number, [_agent, _number, ctypes.c_void_p, ctypes.c_size_t]),
    "keep": (None, [ctypes.c_void_p]),
    "release": (None, [ctypes.c_void_p]),
    "layout": (_text, [_text, _text]),
    "signal": (_number, [_agent, _number, ctypes.c_double]),
    "log": (None, [_number, _text]),
    "fail": (_number, [_agent, _text, _text]),
}


def _places():
    """Named; in the installation or build of the program `gridspace`; in the one that this package is in."""
    if named := os.environ.get("GRIDSPACE_LIBRARY"):
        yield pathlib.Path(named)
    prefixes = [*pathlib.Path(__file__).resolve().parents[4:5]]  # PREFIX/share/gridspace/python/gridspace
    with contextlib.suppress(Error):
        prefixes.insert(0, pathlib.Path(program()).resolve().parent.parent)
    for prefix in prefixes:
        yield prefix / "lib" / NAME
        yield from sorted((prefix / "lib").glob(f"*-linux-gnu/{NAME}"))


@functools.cache
def load() -> ctypes.CDLL:
    """The library; its functions have the types that the header says. Raises Error when there is none."""
    file = next((str(place) for place in _places() if place.is_file()), None) or ctypes.util.find_library("gridspace")
    if file is None:
        raise Error(f"{NAME} is not there: build or install Gridspace, or name the file in GRIDSPACE_LIBRARY", 3)
    try:
        library = ctypes.CDLL(file)
    except OSError as e:
        raise Error(f"{file} cannot be loaded: {e}", 3) from e
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, f"gridspace_{name}")
        function.restype, function.argtypes = result, arguments
    if library.gridspace_abi_version() != ABI_VERSION:
        raise Error(f"{file} has version {library.gridspace_abi_version()} of its interface, and this package is for {ABI_VERSION}", 3)
    return library


def last_error() -> str:
    return load().gridspace_last_error().decode(errors="replace")
