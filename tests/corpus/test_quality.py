import numpy as np
import pytest
from synthetic import drifting, moved, standing, waving

from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.errors import CorpusError

CAPTIONS = ("a person stands",)


@pytest.mark.parametrize(
    ("motion", "captions", "reason"),
    [
        (waving(), CAPTIONS, None),
        (waving(), (), "no caption"),
        (waving(5), CAPTIONS, "shorter"),
        (drifting(standing(), 9.0), CAPTIONS, "root faster"),
        (moved(waving(), np.array([np.nan, 0.0, 0.0])), CAPTIONS, "not finite"),
    ],
)
def test_unfit_clips_are_dropped_with_the_reason(motion, captions, reason):
    got = reason_to_drop(motion, captions, QualityConfig())
    assert got is None if reason is None else reason in (got or "")


def test_reversed_limits_are_refused():
    with pytest.raises(CorpusError, match="below min_seconds"):
        QualityConfig(min_seconds=5.0, max_seconds=1.0).validate()
