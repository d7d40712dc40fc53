"""A corpus of made motions, as `corpus build` would leave it."""

from collections.abc import Sequence

from motiondiffuse_ros.corpus.statistics import compute_statistics
from motiondiffuse_ros.corpus.store import Corpus, pack_clips
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import PoseState


def corpus_of(entries: Sequence[tuple[str, str, str, Motion]]) -> Corpus:
    """Return a corpus of (name, split, caption, motion)."""
    state = PoseState()
    encoded = [
        (name, "made", split, (caption,), state.encode(motion))
        for name, split, caption, motion in entries
    ]
    clips, features = pack_clips(encoded)
    statistics = compute_statistics([entry[4] for entry in encoded], state)
    return Corpus(clips, features, statistics, state, 20.0, {})
