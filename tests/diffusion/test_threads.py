import os

import numpy as np
import pytest
import torch

from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.diffusion.threads import Threads, in_halves, sharing
from motiondiffuse_ros.manifest import shipped


@pytest.mark.parametrize(
    ("count", "shared"),
    [(1, Threads(1)), (2, Threads(1, True)), (5, Threads(2, True)), (8, Threads(4, True))],
)
def test_several_threads_share_two_halves(count, shared):
    assert Threads.of(count) == shared


@pytest.mark.parametrize(
    ("cores", "told", "shared"),
    [
        (1, None, Threads(1)),
        (2, None, Threads(1, True)),
        (4, None, Threads(1, True)),
        (9, None, Threads(4, True)),
        (9, "1", Threads(1)),
        (2, "4", Threads(2, True)),
        (2, "4,2", Threads(1, True)),
    ],
)
def test_unless_told_the_cores_decide(monkeypatch, cores, told, shared):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(cores)))
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    if told is not None:
        monkeypatch.setenv("OMP_NUM_THREADS", told)
    assert Threads.of(0) == shared


@pytest.mark.parametrize("rows", [1, 2, 7])
@pytest.mark.parametrize("halves", [False, True])
def test_every_row_is_worked_on_once_and_in_its_place(rows, halves):
    asked = torch.arange(rows)
    with sharing(Threads(1, halves)):
        assert in_halves(lambda some: asked[some] * 2, rows).tolist() == (asked * 2).tolist()


def test_what_fails_in_the_second_half_is_told():
    def fails_on_the_last(some: slice) -> torch.Tensor:
        if some.stop == 4:
            raise ValueError("row 3")
        return torch.zeros(2)

    with sharing(Threads(1, halves=True)), pytest.raises(ValueError, match="row 3"):
        in_halves(fails_on_the_last, 4)


def test_halves_make_the_same_motions_but_for_rounding():
    pipeline = MotionPipeline.from_pretrained(shipped("base"))
    text = TimedText("a person walks forward", 0, 61, ())
    found = []
    for halves in (False, True):
        with sharing(Threads(1, halves)):
            samples = pipeline(
                (text,), 61, config=SamplerConfig(), candidates=3, seed=4, blend_frames=0
            )
        found.append([motion.positions for motion in samples.motions])
    whole, halved = found
    assert len(whole) == 3
    assert np.allclose(whole, halved, atol=0.01)
