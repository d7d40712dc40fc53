"""Every error this package raises on purpose, and the codes that reach ROS and the shell."""

from __future__ import annotations

from enum import IntEnum

LONGEST_MESSAGE = 600
"""Messages quote input, which may be of any length; longer ones lose their middle [characters]."""


class ErrorCode(IntEnum):
    """Result codes of the `GenerateMotion` action, in ranges of one hundred by room."""

    SUCCESS = 0
    INVALID_REQUEST = 100
    INVALID_MOTION_FILE = 110
    INVALID_CORPUS = 120
    INVALID_CHECKPOINT = 200
    INVALID_TEXT_ENCODER = 210
    SAMPLING_FAILED = 220
    INVALID_ROBOT = 300
    PHYSICS_FAILED = 310
    CANCELED = 400
    SUPERSEDED = 410
    NOT_ACTIVE = 420
    INTERNAL = 500


class MotionDiffuseError(Exception):
    """Base of all errors of this package.

    The message is one line that says what was wrong, where, and what would be right.
    """

    code = ErrorCode.INTERNAL

    def __str__(self) -> str:
        """Return the message as one printable line of bounded length."""
        text = super().__str__()
        if len(text) > LONGEST_MESSAGE:
            half = LONGEST_MESSAGE // 2 - 2
            text = f"{text[:half]} … {text[-half:]}"
        if not text.isprintable():
            text = "".join(c if c.isprintable() else " " for c in text)
        return text


class InputError(MotionDiffuseError):
    """The caller's input was refused before any work started (exit code 2 on the shell)."""

    code = ErrorCode.INVALID_REQUEST


class RequestError(InputError):
    """A motion request that cannot be honoured as written."""


class MotionFileError(InputError):
    """A motion file (BVH, npz) that cannot be read."""

    code = ErrorCode.INVALID_MOTION_FILE


class CorpusError(InputError):
    """A corpus folder, caption file or skeleton map that cannot be used."""

    code = ErrorCode.INVALID_CORPUS


class CheckpointError(InputError):
    """Weights that are missing, truncated, altered or of another kind."""

    code = ErrorCode.INVALID_CHECKPOINT


class TextEncoderError(InputError):
    """A text encoder whose files are missing or not the ones a checkpoint was trained with."""

    code = ErrorCode.INVALID_TEXT_ENCODER


class RobotError(InputError):
    """An unknown robot or joint, or a robot description that does not load."""

    code = ErrorCode.INVALID_ROBOT


class RecordingError(InputError):
    """A recording that cannot be read, or that this installation cannot plan again."""


class RecordingNotWritten(MotionDiffuseError):
    """A recording that could not be written; nothing is left under its name."""


class SamplingError(MotionDiffuseError):
    """The sampler produced values that are not finite."""

    code = ErrorCode.SAMPLING_FAILED


class PhysicsError(MotionDiffuseError):
    """The simulation could not be run to a verdict."""

    code = ErrorCode.PHYSICS_FAILED


class Cancelled(MotionDiffuseError):
    """The caller withdrew the request while it was being worked on."""

    code = ErrorCode.CANCELED
