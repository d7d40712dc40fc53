"""Checks of fields that come from files people write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from reprlib import Repr
from typing import Any

from motiondiffuse_ros.errors import RequestError

_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = 80


def shown(value: Any) -> str:
    """Return a value of any kind and size for a message."""
    try:
        return _SHORT.repr(value)
    except ValueError:  # an integer of too many digits
        return f"a huge {type(value).__name__}"


def check_fields(cls: type, data: Any, where: str) -> None:
    """Refuse what is not a mapping, or has fields that a dataclass has not.

    Raises:
        RequestError: With the fields that there are.
    """
    known = [f.name for f in fields(cls)]
    if not isinstance(data, Mapping):
        raise RequestError(f"{where}: must be a mapping with the fields {', '.join(known)}")
    if unknown := [k for k in data if k not in known]:
        raise RequestError(
            f"{where}: unknown field {shown(unknown[0])}; they are {', '.join(known)}"
        )


def rows(data: Any, where: str, form: str) -> list[Any]:
    """Return a list, or nothing for None.

    Raises:
        RequestError: If it is something else; says the form of an entry.
    """
    if data is None:
        return []
    if not isinstance(data, list):
        raise RequestError(f"{where} must be a list of {form}, got {shown(data)}")
    return data


def number(value: Any, where: str) -> float:
    """Return a number, which may be infinite or none.

    Raises:
        RequestError: If it is something else.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise RequestError(f"{where} must be a number, got {shown(value)}")
    try:
        return float(value)
    except OverflowError:
        raise RequestError(f"{where} is too large, got {shown(value)}") from None


def names(value: Any, where: str) -> tuple[str, ...]:
    """Return a list of names, none for None.

    Raises:
        RequestError: If it is something else.
    """
    if value is None:
        return ()
    if not isinstance(value, (list, tuple)) or not all(isinstance(name, str) for name in value):
        raise RequestError(f"{where} must be a list of names, got {shown(value)}")
    return tuple(value)
