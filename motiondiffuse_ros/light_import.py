"""Imports of libraries that would load others for nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import ModuleType

_UNUSED: dict[str, tuple[str, ...]] = {
    "torch._dynamo": ("allow_in_graph", "disable"),
    "scipy.stats": (),
}
"""Modules that are not loaded, and their decorators that the libraries use."""


@contextmanager
def light_import() -> Iterator[None]:
    """Let modules be imported that load torch's compiler or scipy.stats, but not those two.

    diffusers and roma import the compiler for decorators of what is never compiled here, and
    diffusers the statistics for a schedule that is not used here: together a third of the node's
    start, and 60 MiB. Meanwhile the decorators change nothing; who needs them later gets them.
    """
    missing = [name for name in _UNUSED if name not in sys.modules]
    for name in missing:
        stand_in = ModuleType(name)
        for decorator in _UNUSED[name]:
            setattr(stand_in, decorator, _unchanged)
        sys.modules[name] = stand_in
    try:
        yield
    finally:
        for name in missing:
            del sys.modules[name]


def _unchanged(function: Callable[..., object]) -> Callable[..., object]:
    return function
