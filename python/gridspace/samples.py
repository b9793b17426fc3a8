# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Classes of samples, made from IDL when they are asked for. A received sample is a view of the library's memory: nothing is copied."""
from __future__ import annotations

import ctypes
import difflib
import enum
import functools
import json
import os
from collections.abc import Mapping, Sequence as AbstractSequence
from typing import Any

from gridspace import library
from gridspace.launcher import Error

_NUMBERS = {"octet": ctypes.c_uint8, "int8": ctypes.c_int8, "int16": ctypes.c_int16, "uint16": ctypes.c_uint16, "int32": ctypes.c_int32,
            "uint32": ctypes.c_uint32, "int64": ctypes.c_int64, "uint64": ctypes.c_uint64, "float": ctypes.c_float, "double": ctypes.c_double}
_NATIVE = {**_NUMBERS, "boolean": ctypes.c_bool, "char": ctypes.c_uint8, "string": ctypes.c_char_p, "enum": ctypes.c_int32}
_NUMPY = {"octet": "|u1", "int8": "|i1", "int16": "<i2", "uint16": "<u2", "int32": "<i4", "uint32": "<u4", "int64": "<i8", "uint64": "<u8",
          "float": "<f4", "double": "<f8", "boolean": "|b1", "char": "|u1", "enum": "<i4"}  # as __array_interface__ names them


class _SequenceHead(ctypes.Structure):
    _fields_ = [("length", ctypes.c_uint32), ("items", ctypes.c_void_p)]


_set_raw = ctypes.Structure.__setattr__


class Kept:
    """Keeps the memory of a received sample until nobody looks at it any more."""

    __slots__ = ("_address", "_release")

    def __init__(self, address: int):
        loaded = library.load()
        loaded.gridspace_keep(address)
        self._address, self._release = address, loaded.gridspace_release

    def __del__(self):
        self._release(self._address)


class _Field:
    """What may stand in a member, a sequence or an array, and how it lies in memory. `where` is for messages."""

    def __init__(self, where: str, layout: dict[str, Any]):
        self.where, self.kind, self.bound = where, layout["kind"], layout.get("bound", 0)
        self.raw = ""  # of a member: the attribute of ctypes
        self.written_as = {"double": float, "string": str}.get(self.kind)  # a value of that type needs no looking at
        self.element = _Field(f"{where}[…]", layout["element"]) if "element" in layout else None
        self.enum = enum.IntEnum(layout["name"].rpartition("::")[2], layout["values"]) if self.kind == "enum" else None
        if self.kind == "struct":
            self.native = sample_class(layout)
        elif self.kind == "array":
            self.native = self.element.native * self.bound
        else:
            self.native = _SequenceHead if self.kind == "sequence" else _NATIVE[self.kind]

    def wrong(self, value: object, expected: str, error: type = TypeError) -> Exception:
        kind = type(value).__name__
        said = f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}, {value!r}" if error is TypeError else repr(value)
        return error(f"{self.where} is {expected}, and not {said}")

    def read(self, raw: Any, owner: object) -> Any:
        """The value in a member, of what ctypes gives for it."""
        if self.kind == "string":
            return "" if raw is None else raw.decode("utf-8", "replace")
        if self.kind == "sequence":
            return Items(self.element, raw.items or 0, raw.length, owner)
        if self.kind == "array":
            return Items(self.element, ctypes.addressof(raw), self.bound, (owner, raw))
        if self.kind == "enum":
            try:
                return self.enum(raw)
            except ValueError:
                return raw
        return chr(raw) if self.kind == "char" else raw

    def native_of(self, value: Any, keep: list) -> Any:
        """What ctypes stores for a value; what it points to is put into `keep`. Raises TypeError or ValueError."""
        if self.kind in ("double", "float"):
            if type(value) is float:
                return value
            if isinstance(value, (str, bytes)) or getattr(value, "ndim", 0) or not hasattr(value, "__float__") and not hasattr(value, "__index__"):
                raise self.wrong(value, f"a number ({self.kind})")
            return float(value)
        if self.kind in _NUMBERS:
            return self._whole(value)
        if self.kind == "boolean":
            if not isinstance(value, (bool, int)) and type(value).__name__ not in ("bool_", "bool"):
                raise self.wrong(value, "True or False")
            return bool(value)
        if self.kind == "string":
            if not isinstance(value, str):
                raise self.wrong(value, "a text")
            if "\0" in value:
                raise self.wrong(value, "a text without NUL", ValueError)
            return value.encode()
        if self.kind == "char":
            if not isinstance(value, str) or len(value) != 1 or ord(value) > 255:
                raise self.wrong(value, "a text of one character")
            return ord(value)
        if self.kind == "enum":
            return self._enum(value)
        if self.kind == "struct":
            return self._struct(value, keep)
        return self._items(value, keep)

    def _whole(self, value: Any) -> int:
        if isinstance(value, bool) or getattr(value, "ndim", 0) or not hasattr(value, "__index__"):
            raise self.wrong(value, f"a whole number ({self.kind})")
        value = value.__index__()
        if self.native(value).value != value:
            raise self.wrong(value, f"a whole number of {8 * ctypes.sizeof(self.native)} bits ({self.kind})", ValueError)
        return value

    def _enum(self, value: Any) -> int:
        try:
            return int(self.enum[value] if isinstance(value, str) else self.enum(value))
        except (KeyError, ValueError) as e:
            raise self.wrong(value, f"one of {', '.join(self.enum.__members__)}", ValueError) from e

    def _struct(self, value: Any, keep: list) -> Sample:
        if isinstance(value, Mapping):
            value = self.native(**value)
        if type(value) is not self.native:
            raise self.wrong(value, f"a {self.native.__name__}")
        keep.append(value)
        return value

    def _items(self, value: Any, keep: list) -> Any:
        if isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__len__") or getattr(value, "ndim", 1) == 0:
            raise self.wrong(value, "a list")
        count = len(value)
        if self.kind == "array" and count != self.bound:
            raise ValueError(f"{self.where} holds {self.bound} items, and not {count}")
        items = self.element.array_of(value, count, keep)
        if self.kind == "array":
            return items
        if self.bound and count > self.bound:
            raise ValueError(f"{self.where} holds at most {self.bound} items, and not {count}")
        keep.append(items)
        return _SequenceHead(count, ctypes.addressof(items) if count else None)

    def array_of(self, values: Any, count: int, keep: list) -> ctypes.Array:
        array = self.native * count
        if self.kind in _NUMBERS:
            try:
                view = memoryview(values)  # numpy's, array's: all at once
            except TypeError:
                pass
            else:
                if view.format == memoryview(array()).format.lstrip("<") and view.ndim == 1 and view.contiguous:
                    return array.from_buffer_copy(view)
        out = array()
        for i, value in enumerate(values):
            out[i] = self.native_of(value, keep)
        return out


class Items(AbstractSequence):
    """A sequence or array of a sample. numpy.asarray(items) is a view of numbers, or of a structured type, without a copy."""

    __slots__ = ("_field", "_address", "_length", "_owner")

    def __init__(self, field: _Field, address: int, length: int, owner: object):
        self._field, self._address, self._length, self._owner = field, address, length, owner

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(self._length))]
        place = index + self._length if index < 0 else index
        if not 0 <= place < self._length:
            raise IndexError(f"{self._field.where.removesuffix('[…]')} has {self._length} items, and none at {index}")
        native = self._field.native
        item = native.from_address(self._address + place * ctypes.sizeof(native))
        if self._field.kind == "struct":
            item.__dict__["_kept"] = self._owner
            return item
        return self._field.read(item if isinstance(item, (_SequenceHead, ctypes.Array)) else item.value, self._owner)

    def __iter__(self):
        if self._field.kind != "struct":
            return (self[i] for i in range(self._length))
        return self._structs()

    def _structs(self):
        made_of = self._field.native.from_address
        step = ctypes.sizeof(self._field.native)
        for address in range(self._address, self._address + self._length * step, step):
            item = made_of(address)
            item.__dict__["_kept"] = self._owner
            yield item

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (AbstractSequence, Items)) and list(self) == list(other)

    def __repr__(self) -> str:
        return repr(list(self))

    @property
    def __array_interface__(self) -> dict[str, Any]:
        field = self._field
        description = {"version": 3, "shape": (self._length,), "data": (self._address, True)}
        if field.kind == "struct":
            return {**description, "typestr": f"|V{ctypes.sizeof(field.native)}", "descr": field.native._columns()}
        if field.kind in ("string", "sequence", "array"):
            raise AttributeError(f"{field.where} is no number")
        return {**description, "typestr": _NUMPY[field.kind]}


class Sample(ctypes.Structure):
    """A sample of a type of IDL: `Type(member=value, …)`. A member that is not given is 0, "" or empty."""

    _idl_fields: dict[str, _Field] = {}

    def __init__(self, **members: Any):
        fields = self._idl_fields
        for name, value in members.items():
            field, kind = fields.get(name), type(value)
            if field is not None and field.written_as is kind and (kind is float or "\0" not in value):  # most of what agents write
                _set_raw(self, field.raw, value if kind is float else value.encode())
            else:
                self._set(name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if "_kept" in self.__dict__:
            raise AttributeError(f"{type(self).__name__}.{name}: a received sample is not changed; take {type(self).__name__}(**sample.to_dict())")
        self._set(name, value)

    def _set(self, name: str, value: Any) -> None:
        field = self._idl_fields.get(name)
        if field is None:
            near = difflib.get_close_matches(name, self._idl_fields, 1)
            raise AttributeError(f"{type(self).__name__} has no member '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        keep: list = []
        _set_raw(self, field.raw, field.native_of(value, keep))
        if keep:
            self.__dict__.setdefault("_pointed_to", {})[name] = keep

    def to_dict(self) -> dict[str, Any]:
        """Its members, with lists and dicts for what is in it: a copy."""
        return {name: _plain(getattr(self, name)) for name in self._idl_fields}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.to_dict() == other.to_dict()

    __hash__ = None

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name)!r}' for name in self._idl_fields)})"

    @classmethod
    def _columns(cls) -> list[tuple]:
        """For numpy. Pointers are left as octets: texts and sequences are read by their names."""
        out, at = [], 0
        for name, field in cls._idl_fields.items():
            place = getattr(cls, f"_{name}")
            if place.offset > at:
                out.append(("", f"|V{place.offset - at}"))
            if field.kind == "struct":
                out.append((name, field.native._columns()))
            else:
                out.append((name, f"|V{place.size}" if field.kind in ("string", "sequence", "array") else _NUMPY[field.kind]))
            at = place.offset + place.size
        if ctypes.sizeof(cls) > at:
            out.append(("", f"|V{ctypes.sizeof(cls) - at}"))
        return out


def _plain(value: Any) -> Any:
    if isinstance(value, Sample):
        return value.to_dict()
    return [_plain(item) for item in value] if isinstance(value, Items) else value


def _text_member(raw: str) -> property:
    def read(self: Sample) -> str:
        value = getattr(self, raw)
        return value.decode("utf-8", "replace") if value else ""
    return property(read)


def _member(made: type[Sample], name: str, field: _Field) -> Any:
    """How a member is read: numbers as ctypes does it, others as Python has them."""
    raw = f"_{name}"
    if field.kind in _NUMBERS or field.kind in ("boolean", "struct"):
        return made.__dict__[raw]
    return _text_member(raw) if field.kind == "string" else property(lambda self: field.read(getattr(self, raw), self))


@functools.cache
def _class_of(layout: str) -> type[Sample]:
    described = json.loads(layout)
    name = described["name"]
    fields = {member["name"]: _Field(f"{name}.{member['name']}", member["type"]) for member in described["members"]}
    for member, field in fields.items():
        field.raw = f"_{member}"
    body: dict[str, Any] = {"_idl_fields": fields, "_idl_name": name, "_fields_": [(f"_{n}", field.native) for n, field in fields.items()]}
    made = type(name.rpartition("::")[2], (Sample,), body)
    for member, field in fields.items():
        setattr(made, member, _member(made, member, field))
    offsets = [getattr(made, f"_{n}").offset for n in fields]
    if ctypes.sizeof(made) != described["size"] or offsets != [m["offset"] for m in described["members"]]:
        raise Error(f"{name} lies in memory in another way for Python than for libgridspace", 3)
    return made


def sample_class(layout: dict[str, Any]) -> type[Sample]:
    """The class for a layout of gridspace_layout or gridspace_topics; the same one each time."""
    return _class_of(json.dumps(layout))


@functools.cache
def sample_type(name: str, idl: str | os.PathLike | None = None) -> type[Sample]:
    """The class of a type: of Gridspace, or of the IDL file that defines it. Raises Error when there is none."""
    layout = library.load().gridspace_layout(name.encode(), None if idl is None else os.fsencode(idl))
    if layout is None:
        raise Error(library.last_error(), 2)
    return sample_class(json.loads(layout))
