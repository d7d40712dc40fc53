"""Where the files that are not Python live: `sim/`, `launch/`, `msg/` and `action/`."""

from __future__ import annotations

from pathlib import Path

PACKAGE = "motiondiffuse_ros"


def share_dir() -> Path:
    """Return the folder that holds `package.xml`, `sim/` and `launch/`.

    That is the checkout when the package runs from one, and `share/motiondiffuse_ros` of the
    install otherwise (pip, colcon or Debian). The ament index is not asked: the ROS wheels
    leave AMENT_PREFIX_PATH unset.

    Raises:
        FileNotFoundError: If the package was installed without these files.
    """
    package = Path(__file__).resolve().parent
    for parent in package.parents:
        for candidate in (parent, parent / "share" / PACKAGE):
            if (candidate / "package.xml").is_file() and (candidate / "launch").is_dir():
                return candidate
    raise FileNotFoundError(f"no share/{PACKAGE} above {package}; reinstall the package")
