"""What pip, colcon and the reader are told agrees."""

import re
import sys
import xml.etree.ElementTree as ET
from importlib.metadata import requires, version
from pathlib import Path

import motiondiffuse_ros
from motiondiffuse_ros.share import share_dir

ROOT = Path(__file__).resolve().parents[2]


def names(file: str) -> set[str]:
    lines = (line.split("#")[0].strip() for line in (ROOT / file).read_text().splitlines())
    return {re.split(r"[<>=;\[ ]", line)[0] for line in lines if line}


def test_pip_and_colcon_build_the_same_version():
    manifest = ET.parse(ROOT / "package.xml").getroot()
    assert manifest.findtext("version") == motiondiffuse_ros.__version__
    assert version("motiondiffuse-ros") == motiondiffuse_ros.__version__


def test_every_runtime_requirement_is_pinned_for_ci():
    required = names("requirements.txt") | names("build_tools/ros_wheels.txt")
    assert required <= names("constraints.txt")
    declared = {re.split(r"[<>=;\[ ]", line)[0] for line in requires("motiondiffuse-ros") or []}
    assert required <= declared


def test_build_requirements_include_the_ros_wheels():
    if sys.version_info >= (3, 11):
        import tomllib

        table = tomllib.loads((ROOT / "pyproject.toml").read_text())
        assert names("build_tools/ros_wheels.txt") <= set(table["build-system"]["requires"])


def test_share_folder_holds_what_is_not_python():
    share = share_dir()
    for name in ("package.xml", "launch/motiondiffuse.launch.xml", "msg/MotionPlan.msg"):
        assert (share / name).is_file(), name
