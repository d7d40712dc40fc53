from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.motion.spans import pieces, runs


@given(st.lists(st.booleans()))
def test_runs_cover_what_is_true_and_do_not_touch(flags):
    covered = np.zeros(len(flags), dtype=bool)
    found = runs(np.array(flags, dtype=bool))
    for start, stop in found:
        covered[start:stop] = True
    assert covered.tolist() == flags
    assert all(stop < start for (_, stop), (start, _) in pairwise(found))


@given(st.integers(0, 100), st.integers(1, 40))
def test_pieces_cover_every_frame_once(count, size):
    frames = list(range(count))
    found = [frames[piece] for piece in pieces(count, size)]
    assert [frame for piece in found for frame in piece] == frames
    assert found
    assert max(map(len, found)) <= size
