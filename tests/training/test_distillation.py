"""A student of a small teacher, and what the teacher's two steps come to."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from made_corpus import corpus_of
from small_denoiser import SMALL
from synthetic import standing, waving

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.process import denoising_steps, make_scheduler
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.training.distill_config import DistillConfig
from motiondiffuse_ros.training.distillation import Distiller, Levels, jumps

LEVELS = Levels(make_scheduler("ddpm", SMALL).alphas_cumprod)
CONFIG = DistillConfig(
    minutes=0.08,
    batch_size=4,
    learning_rate=2e-3,
    warmup_steps=1,
    whole=0.2,
    # a random teacher's motions have no kinematics to speak of
    difference_weight=0.0,
    position_weight=0.0,
    velocity_weight=0.0,
    slide_weight=0.0,
    ema_decay=0.5,
)


@pytest.fixture(scope="module")
def teacher(encoder):
    corpus = corpus_of(
        [
            (f"{split}_{i}", split, text, motion)
            for split in ("train", "val")
            for i, (text, motion) in enumerate(
                [
                    ("a person stands", standing(40)),
                    ("a person waves with the right hand", waving(40)),
                ]
            )
        ]
    )
    # of two clips most features hardly vary: what is normalised by that is no motion any more
    dim = corpus.representation.dim
    corpus = replace(corpus, statistics=Statistics(np.zeros(dim, "f"), np.ones(dim, "f")))
    torch.manual_seed(0)
    denoiser = Denoiser(replace(SMALL, prediction_type="sample")).eval()
    with torch.no_grad():  # so that texts, and with them guidance, matter
        for layer in denoiser.layers:
            for style in layer.styles:
                style.project.weight.normal_(std=0.2)
    return corpus, Checkpoint(denoiser, corpus.statistics, encoder.sha256, "teacher")


@given(st.integers(1, 30), st.floats(1.0, 3.0), st.data())
def test_steps_of_the_student_follow_each_other_and_pass_all_of_the_teachers(count, spacing, data):
    times = denoising_steps(count, spacing, 1000)
    pairs = data.draw(st.integers(0, count // 2))
    found = jumps(times, pairs)
    assert len(found) == count - pairs
    assert [jump.end for jump in found] == [*(jump.start for jump in found[1:]), None]
    passed = [t for jump in found for t in (jump.start, jump.middle) if t is not None]
    assert passed == times
    assert [jump.middle is not None for jump in found] == [i < pairs for i in range(len(found))]


@given(st.integers(1, 999), st.integers(0, 998), st.booleans())
def test_a_step_towards_the_aim_arrives(start, end, clean):
    end = None if clean or end >= start else end
    x, arrived = torch.randn(2, 1, 3, 4, generator=torch.Generator().manual_seed(start))
    aim = LEVELS.aim(x, arrived, start, end)
    torch.testing.assert_close(LEVELS.moved(x, aim, start, end), arrived, atol=1e-3, rtol=1e-3)


@pytest.mark.parametrize(
    ("start", "middle", "end"), [(999, 993, 968), (968, 914, 822), (822, 690, 512), (512, 283, 0)]
)
def test_the_teacher_goes_as_dpm_solver_does(start, middle, end):
    scheduler = make_scheduler("dpm-solver++", SMALL)
    scheduler.set_timesteps(timesteps=[start, middle, end])
    x, first, second = torch.randn(3, 1, 5, 6)
    there = scheduler.step(first, start, x).prev_sample
    there = scheduler.step(second, middle, there).prev_sample

    at_middle = LEVELS.moved(x, first, start, middle)
    led = second + LEVELS.lead(start, middle, end) * (second - first)
    torch.testing.assert_close(
        LEVELS.moved(at_middle, led, middle, end), there, atol=1e-4, rtol=1e-3
    )


def test_a_run_brings_the_student_nearer_and_leaves_weights_that_need_few_steps(
    teacher, encoder, tmp_path
):
    corpus, checkpoint = teacher
    seen = []
    Distiller(corpus, encoder, checkpoint, CONFIG, tmp_path).run(seen.append)
    rows = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    apart = [row["validation_by_jump"] for row in rows if "validation" in row]
    assert apart[-1][0] < 0.8 * apart[0][0]  # where guidance is to be learnt
    assert seen[-1].step > 1
    assert all(math.isfinite(progress.loss) for progress in seen)

    left = Checkpoint.from_pretrained(tmp_path / "checkpoint")
    for name, tensor in checkpoint.denoiser.half().float().state_dict().items():
        assert tensor.equal(left.denoiser.state_dict()[name]), name
    pipeline = MotionPipeline(left, encoder)
    assert pipeline.completed(SamplerConfig()).steps == CONFIG.teacher_steps - CONFIG.pairs
    assert pipeline.sha256_of(SamplerConfig()) == left.few_steps.sha256


def test_settings_out_of_range_are_refused():
    for wrong in ({"pairs": 5}, {"minutes": -1.0}, {"whole": 1.5}, {"precision": "int3"}):
        with pytest.raises(Exception, match=next(iter(wrong))) as refused:
            DistillConfig(**wrong).validate()
        assert isinstance(refused.value, InputError)
