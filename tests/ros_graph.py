"""What the tests with real ROS processes share."""

START = 120.0
"""For a node to load on a busy machine [s]."""

ANSWER = 120.0
"""For an answer of a node that runs [s]."""

FAST = {"steps": 6, "candidates": 1, "track": False}
"""Parameters for plans that are quick rather than good."""
