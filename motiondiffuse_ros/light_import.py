"""Imports of libraries that would load torch's compiler for nothing."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

_COMPILER = "torch._dynamo"


@contextmanager
def without_compiler() -> Iterator[None]:
    """Let modules be imported that mark functions for `torch.compile`, but do not load it.

    diffusers and roma import the compiler for decorators of what is never compiled here: a fifth of
    the node's start and 60 MiB. Meanwhile the decorators change nothing; who needs the compiler
    later gets it.
    """
    if _COMPILER in sys.modules:
        yield
        return
    stand_in = ModuleType(_COMPILER)
    for decorator in ("allow_in_graph", "disable"):
        setattr(stand_in, decorator, lambda function: function)
    sys.modules[_COMPILER] = stand_in
    try:
        yield
    finally:
        del sys.modules[_COMPILER]
