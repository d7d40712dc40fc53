"""A wheel built from the checkout holds everything that runs, and nothing that does not."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> zipfile.ZipFile:
    pytest.importorskip("catkin_pkg", reason="building needs the packages of `make venv`")
    folder = tmp_path_factory.mktemp("wheel")
    tracked = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split("\0")
    for name in filter(None, tracked):
        target = folder / "source" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, target)
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q"]
    subprocess.run([*build, "-w", str(folder), str(folder / "source")], check=True)
    (file,) = folder.glob("*.whl")
    return zipfile.ZipFile(file)


def test_code_interfaces_and_data_are_in_it(wheel):
    names = wheel.namelist()
    for wanted in (
        "motiondiffuse_ros/py.typed",
        "motiondiffuse_ros/msg/_motion_plan.py",
        "motiondiffuse_ros/action/_generate_motion.py",
        "motiondiffuse_ros/corpus/captions/cmu_captions.jsonl",
        "motiondiffuse_ros/corpus/skeleton_maps/cmu.yaml",
    ):
        assert wanted in names
    assert any(n.endswith(".so") and "typesupport" in n for n in names)


def test_every_tracked_module_and_data_file_of_the_package_is_in_it(wheel):
    tracked = subprocess.run(
        ["git", "ls-files", "motiondiffuse_ros"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    assert set(tracked) <= set(wheel.namelist())


def test_ros_finds_the_package_its_executables_and_launch_files(wheel):
    names = {n.partition(".data/data/")[2] for n in wheel.namelist() if ".data/data/" in n}
    share = {f"share/motiondiffuse_ros/{p.relative_to(ROOT)}" for p in (ROOT / "launch").iterdir()}
    scripts = {f"lib/motiondiffuse_ros/{p.name}" for p in (ROOT / "scripts").iterdir()}
    index = "share/ament_index/resource_index"
    assert share | scripts <= names
    assert {f"{index}/packages/motiondiffuse_ros"} <= names
    assert {f"{index}/rosidl_interfaces/motiondiffuse_ros"} <= names
    assert {
        f"share/motiondiffuse_ros/{p.relative_to(ROOT)}" for p in (ROOT / "sim").rglob("*.xml")
    } <= names


def test_tests_and_benchmarks_are_not_in_it(wheel):
    assert not [n for n in wheel.namelist() if n.startswith(("tests/", "benchmarks/", "build"))]
