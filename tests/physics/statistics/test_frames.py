import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from motiondiffuse_ros.physics.statistics.frames import quantile

VALUES = arrays(float, st.integers(1, 40), elements=st.floats(-1e3, 1e3))


@given(VALUES, st.lists(st.floats(0.0, 100.0), min_size=1, max_size=4))
def test_quantiles_are_those_of_numpy(values, shares):
    expected = np.quantile(values, np.array(shares) / 100.0)
    np.testing.assert_allclose(quantile(values, *shares), expected, atol=1e-9)
