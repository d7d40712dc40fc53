"""Feedback of goals, repeated where the work takes longer from one step to the next."""

from __future__ import annotations

import threading

from rclpy.action.server import ServerGoalHandle

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.planner import Progress


class GoalFeedback:
    """The latest feedback of each goal in work."""

    def __init__(self) -> None:
        """Begin with no goal."""
        self._latest: dict[bytes, tuple[ServerGoalHandle, GenerateMotion.Feedback]] = {}
        self._lock = threading.Lock()  # or a repetition may come after what is newer

    def tell(self, goal: ServerGoalHandle, progress: Progress) -> None:
        """Publish how far a goal is."""
        feedback = GenerateMotion.Feedback(
            stage=progress.stage, fraction=float(progress.fraction), preview=progress.preview
        )
        with self._lock:
            self._latest[_key(goal)] = (goal, feedback)
            goal.publish_feedback(feedback)  # pyright: ignore[reportArgumentType]

    def repeat(self) -> None:
        """Publish the latest feedback of every goal again."""
        with self._lock:
            for goal, feedback in self._latest.values():
                goal.publish_feedback(feedback)  # pyright: ignore[reportArgumentType]

    def end(self, goal: ServerGoalHandle) -> None:
        """Forget a goal."""
        with self._lock:
            self._latest.pop(_key(goal), None)


def _key(goal: ServerGoalHandle) -> bytes:
    return bytes(goal.goal_id.uuid)
