"""One plan in one MCAP file, with everything that is needed to plan it again."""

from motiondiffuse_ros.recording.file import Topic, read_recording, write_recording
from motiondiffuse_ros.recording.record import Record, record_of
from motiondiffuse_ros.recording.replay import difference, doubts, planner_of, replay

__all__ = [
    "Record",
    "Topic",
    "difference",
    "doubts",
    "planner_of",
    "read_recording",
    "record_of",
    "replay",
    "write_recording",
]
