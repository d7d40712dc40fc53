"""Definitions of message types, from the types themselves.

The .msg files are not asked: where they lie depends on how ROS was installed.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

_PRIMITIVES = {"double": "float64", "float": "float32", "boolean": "bool", "octet": "byte"}
_SEQUENCE = re.compile(r"sequence<(.+?)(?:, (\d+))?>")
_ARRAY = re.compile(r"(.+)\[(\d+)\]")
_SEPARATOR = "=" * 80


def type_name(message: type[Any]) -> str:
    """Return a message type's name as pkg/msg/Name."""
    return f"{message.__module__.split('.')[0]}/msg/{message.__name__}"


def type_definition(message: type[Any]) -> str:
    """Return a message type in the form of "ros2msg", followed by the types that it uses.

    Fields only: constants, defaults and comments are not kept by the types.
    """
    lines, used = _fields(message)
    seen: set[str] = set()
    while used:
        name = used.pop(0)
        if name in seen:
            continue
        seen.add(name)
        package, _, short = name.partition("/")
        fields, more = _fields(getattr(import_module(f"{package}.msg"), short))
        lines += [_SEPARATOR, f"MSG: {name}", *fields]
        used += more
    return "\n".join(lines) + "\n"


def _fields(message: type[Any]) -> tuple[list[str], list[str]]:
    """Return a type's fields, one a line, and the types of those that are messages."""
    lines, used = [], []
    for name, kind in message.get_fields_and_field_types().items():
        element, size = kind, ""
        if match := _SEQUENCE.fullmatch(kind):
            element, size = match[1], f"[<={match[2]}]" if match[2] else "[]"
        elif match := _ARRAY.fullmatch(kind):
            element, size = match[1], f"[{match[2]}]"
        if "/" in element:
            used.append(element)
        element = re.sub(r"string<(\d+)>", r"string<=\1", element)
        lines.append(f"{_PRIMITIVES.get(element, element)}{size} {name}")
    return lines, used
