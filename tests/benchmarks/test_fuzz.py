"""Whatever comes in: a request that survives, or a refusal with a code and one line."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz import check_case


@settings(
    max_examples=400, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=st.integers(0, 2**63 - 1))
def test_no_input_gets_through_or_crashes(tmp_path, seed):
    check_case(seed, tmp_path)
