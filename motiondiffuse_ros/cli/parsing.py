"""Arguments to frozen dataclasses, the same way in every command."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import tyro

T = TypeVar("T")


def parse(command: type[T], arguments: Sequence[str], name: str) -> T:
    """Parse arguments; bad ones end the process with exit code 2 and a message."""
    return tyro.cli(
        command,
        args=list(arguments),
        prog=f"motiondiffuse {name}",
        config=(tyro.conf.OmitArgPrefixes,),
    )
