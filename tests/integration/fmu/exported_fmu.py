# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Unpacks an FMU and calls its binary by the C functions of FMI 3.0, as any importer does. Standard library only."""
import ctypes
import pathlib
import platform
import xml.etree.ElementTree
import zipfile

OK, WARNING, DISCARD, ERROR = range(4)
LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
c_bool, c_double, c_size, c_void = ctypes.c_bool, ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p


class Fmu:
    """An FMU in a folder, its description, and its loaded binary."""

    def __init__(self, file, folder):
        self.folder = pathlib.Path(folder)
        with zipfile.ZipFile(file) as archive:
            archive.extractall(self.folder)
        self.root = xml.etree.ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.token = self.root.get("instantiationToken")
        self.variables = {v.get("name"): v for v in self.root.find("ModelVariables")}
        self.identifier = self.root.find("CoSimulation").get("modelIdentifier")
        self.binary = self.folder / f"binaries/{platform.machine()}-linux/{self.identifier}.so"
        self.c = ctypes.CDLL(str(self.binary))
        self.c.fmi3InstantiateCoSimulation.restype = c_void
        self.c.fmi3InstantiateModelExchange.restype = c_void
        self.c.fmi3GetVersion.restype = ctypes.c_char_p
        self.c.fmi3FreeInstance.restype = None

    def reference(self, name):
        return int(self.variables[name].get("valueReference"))


class Instance:
    """One instance; `said` is what it has logged."""

    def __init__(self, fmu, token=None, resources=None, event_mode=False):
        self.fmu, self.c, self.said = fmu, fmu.c, []
        self.log = LOG(lambda _environment, status, category, message: self.said.append((status, category.decode(), message.decode())))
        folder = str(fmu.folder / "resources") + "/" if resources is None else resources
        self.handle = self.c.fmi3InstantiateCoSimulation(
            b"sut", (token or fmu.token).encode(), folder.encode(), c_bool(False), c_bool(False), c_bool(event_mode), c_bool(False),
            None, c_size(0), None, self.log, None)
        self.time = 0.0

    def call(self, function, *arguments):
        return getattr(self.c, function)(c_void(self.handle), *arguments)

    def begin(self, start=0.0):
        status = self.call("fmi3EnterInitializationMode", c_bool(False), c_double(0), c_double(start), c_bool(False), c_double(0))
        return status or self.call("fmi3ExitInitializationMode")

    def set(self, name, value):
        kind, function = {bool: (c_bool, "fmi3SetBoolean"), int: (ctypes.c_int64, "fmi3SetInt64"), float: (c_double, "fmi3SetFloat64")}[type(value)]
        return self.call(function, (ctypes.c_uint32 * 1)(self.fmu.reference(name)), c_size(1),
                         (kind * 1)(value), c_size(1))

    def get(self, *names):
        references = (ctypes.c_uint32 * len(names))(*[self.fmu.reference(n) for n in names])
        values = (c_double * len(names))()
        status = self.call("fmi3GetFloat64", references, c_size(len(names)), values, c_size(len(names)))
        return (list(values) if len(names) > 1 else values[0]) if status == OK else status

    def step(self, size, at=None):
        flags = [c_bool() for _ in range(3)]
        reached = c_double(-1)
        status = self.call("fmi3DoStep", c_double(self.time if at is None else at), c_double(size), c_bool(True),
                           *[ctypes.byref(f) for f in flags], ctypes.byref(reached))
        if status == OK:
            assert not any(f.value for f in flags), "no event, no end, no early return"
            self.time = reached.value
        return status

    def free(self):
        self.call("fmi3FreeInstance")
