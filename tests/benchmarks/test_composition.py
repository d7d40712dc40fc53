import numpy as np
import pytest
from synthetic import drifting, standing, waving

from benchmarks.composition_judging import TextRetrieval
from benchmarks.composition_lists import SPACE, TIME, load_list
from benchmarks.composition_sampling import Composer
from benchmarks.composition_space import STAND_CLIP, arms_of, own_parts, splice
from motiondiffuse_ros.corpus.captions import captions_of, read_captions, shipped_caption_files
from motiondiffuse_ros.corpus.split import split_of
from motiondiffuse_ros.diffusion.composition import TimedText, compose
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
from motiondiffuse_ros.manifest import shipped
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.parts import PARTS, part_joints


@pytest.fixture(scope="module")
def captions():
    return read_captions(shipped_caption_files())


@pytest.mark.parametrize("path", [SPACE, TIME])
def test_lists_are_of_captions_of_the_test_split(path, captions):
    entries = load_list(path)
    assert len(entries) >= 100
    texts = [piece.text for entry in entries for piece in entry.pieces]
    assert len(set(texts)) == len(texts)
    for piece in (piece for entry in entries for piece in entry.pieces):
        dataset = "bandai_namco" if piece.clip.startswith("dataset") else "cmu"
        assert split_of(dataset, piece.clip) == "test"
        assert piece.text in captions_of(piece.clip, captions)
    assert split_of("bandai_namco", STAND_CLIP) == "test"


def test_timelines_are_of_two_to_four_segments_without_gaps():
    for entry in load_list(TIME):
        assert 2 <= len(entry.pieces) <= 4
        place = 0.0
        for piece in entry.pieces:
            assert piece.start == pytest.approx(place)
            assert 2.5 <= round(piece.end - piece.start, 6) <= 6.0
            assert piece.parts == ()
            place = piece.end
        assert entry.seconds == place


def test_combinations_give_no_part_twice_and_can_be_composed():
    state = PoseState()
    for entry in load_list(SPACE):
        owners = [part for i in range(len(entry.pieces)) for part in own_parts(entry, i)]
        assert len(set(owners)) == len(owners)
        assert arms_of(entry)
        frames = round(entry.seconds * 20.0)
        texts = tuple(TimedText(p.text, 0, frames, p.parts) for p in entry.pieces)
        windows = compose(texts, frames, state, max_frames=196, blend_frames=10)
        np.testing.assert_allclose(sum(w.weight for w in windows), 1.0)


def test_a_side_in_the_words_is_the_side_of_the_part():
    for piece in (piece for entry in load_list(SPACE) for piece in entry.pieces):
        if piece.parts in (("left_arm",), ("right_arm",)):
            side, other = piece.parts[0].split("_")[0], {"left", "right"}
            (wrong,) = other - {side}
            assert side in piece.text
            assert f"{wrong} hand" not in piece.text


def test_spliced_parts_are_their_sources():
    entry = next(e for e in load_list(SPACE) if e.kind == "arms on a body")
    body, arm, stand = drifting(standing(30), 1.0), waving(30), standing(1)
    spliced = splice(entry, [body, arm], stand)
    np.testing.assert_array_equal(spliced.root, body.root)
    for part in PARTS:
        joints = list(part_joints(part))
        source = arm if part in arms_of(entry) else body
        np.testing.assert_array_equal(spliced.rotations[:, joints], source.rotations[:, joints])


def test_retrieval_finds_a_text_by_its_own_vector_and_counts_ties_as_wrong(encoder):
    evaluator = Evaluator.from_pretrained(shipped_evaluator(), encoder)
    texts = [piece.text for entry in load_list(SPACE) for piece in entry.pieces]
    retrieval = TextRetrieval(evaluator, texts, seed=0)
    assert (retrieval.ranks(evaluator.embed_texts(texts[:20]), texts[:20]) == 0).all()
    nothing = np.zeros((2, evaluator.network.config.space))
    assert (retrieval.ranks(nothing, texts[:2]) == 31).all()


@pytest.fixture(scope="module")
def composer():
    return Composer(shipped("base"), SamplerConfig(steps=2), seed=0, blend_seconds=0.5)


def test_requests_of_a_group_do_not_touch_each_other(composer):
    one, other, third = load_list(SPACE)[0], load_list(TIME)[0], load_list(TIME)[1]
    requests = [composer.request(composer.timed(e), composer.frames(e)) for e in (one, other)]
    changed = [requests[0], composer.request(composer.timed(third), requests[1].frames)]
    both = composer.sample(requests, "", part_correction=0.5, apart_above=0.25)
    again = composer.sample(changed, "", part_correction=0.5, apart_above=0.25)
    assert [len(x) for x in both] == [r.frames for r in requests]
    # batches of other lengths round otherwise: far less than another text makes
    same, other_text = (np.abs(a - b).max() for a, b in zip(both, again, strict=True))
    assert same < 0.05 * other_text


def test_one_text_is_the_same_composed_or_pasted(composer):
    request = composer.request([TimedText("a person waves", 0, 60)], 60)
    (sampled,), (pasted,) = composer.sample([request], ""), composer.paste([request], "")
    np.testing.assert_allclose(sampled, pasted, atol=1e-5)
