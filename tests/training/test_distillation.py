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
from small_denoiser import SMALL, small_denoiser
from synthetic import standing, waving

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.process import denoising_steps, make_scheduler
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError, InputError
from motiondiffuse_ros.motion.features import REPRESENTATIONS
from motiondiffuse_ros.training.distill_config import DistillConfig
from motiondiffuse_ros.training.distillation import Distiller, Jump, Levels, jumps

LEVELS = Levels(make_scheduler("ddpm", SMALL).alphas_cumprod)
CONFIG = DistillConfig(
    minutes=0.08,
    batch_size=4,
    learning_rate=2e-3,
    warmup_steps=1,
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
    denoiser = small_denoiser(prediction_type="sample")
    return corpus, Checkpoint(denoiser, corpus.statistics, encoder.sha256, "teacher")


@given(st.integers(3, 30), st.floats(1.0, 3.0), st.data())
def test_steps_of_the_student_follow_each_other_and_pass_the_teachers(count, spacing, data):
    times = denoising_steps(count, spacing, 1000)
    pairs = data.draw(st.integers(1, (count - 1) // 2))
    found = jumps(times, pairs)
    assert [t for jump in found for t in jump[:2]] == times[: 2 * pairs]
    assert [jump.end for jump in found] == times[2 : 2 * pairs + 1 : 2]


@given(st.integers(1, 999), st.data())
def test_a_step_towards_the_aim_arrives(start, data):
    end = data.draw(st.integers(0, start - 1))
    x, arrived = torch.randn(2, 1, 3, 4, generator=torch.Generator().manual_seed(start))
    aim = LEVELS.aim(x, arrived, start, end)
    torch.testing.assert_close(LEVELS.moved(x, aim, start, end), arrived, atol=1e-3, rtol=1e-3)


@pytest.mark.parametrize("jump", [(999, 993, 968), (968, 914, 822), (822, 690, 512)])
def test_the_teacher_goes_as_dpm_solver_does(jump):
    start, middle, end = jump = Jump(*jump)
    scheduler = make_scheduler("dpm-solver++", SMALL)
    scheduler.set_timesteps(timesteps=list(jump))
    x, first, second = torch.randn(3, 1, 5, 6)
    there = scheduler.step(first, start, x).prev_sample
    there = scheduler.step(second, middle, there).prev_sample

    at_middle = LEVELS.moved(x, first, start, middle)
    led = second + LEVELS.lead(jump) * (second - first)
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
    errors = [row["validation"] for row in rows if "validation" in row]
    assert errors[-1] < 0.8 * errors[0]
    assert seen[-1].step > 1
    assert all(math.isfinite(progress.loss) for progress in seen)

    left = Checkpoint.from_pretrained(tmp_path / "checkpoint")
    for name, tensor in checkpoint.denoiser.half().float().state_dict().items():
        assert tensor.equal(left.denoiser.state_dict()[name]), name
    card = json.loads((tmp_path / "checkpoint" / "few_steps.json").read_text())
    assert card["teacher"] == "teacher"
    assert card["motions"] == seen[-1].step * CONFIG.batch_size
    pipeline = MotionPipeline(left, encoder)
    assert pipeline.few_steps(SamplerConfig()) == CONFIG.pairs + len(CONFIG.then)


def test_a_corpus_of_another_representation_is_refused(teacher, encoder, tmp_path):
    corpus, checkpoint = teacher
    other = replace(corpus, representation=REPRESENTATIONS["humanml3d"]())
    with pytest.raises(CheckpointError, match="the corpus holds humanml3d"):
        Distiller(other, encoder, checkpoint, CONFIG, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_steps_that_do_not_begin_where_the_student_arrives_are_refused(teacher, encoder, tmp_path):
    elsewhere = replace(CONFIG, then=(500, 300))
    with pytest.raises(InputError, match="must begin at 822"):
        Distiller(*teacher[:1], encoder, *teacher[1:], elsewhere, tmp_path)


def test_settings_out_of_range_are_refused():
    for wrong in ({"pairs": 4}, {"minutes": -1.0}, {"deeds": 1.5}, {"precision": "int3"}):
        with pytest.raises(Exception, match=next(iter(wrong))) as refused:
            DistillConfig(**wrong).validate()
        assert isinstance(refused.value, InputError)
