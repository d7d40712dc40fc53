"""MCAP files that hold one plan: its messages for other tools, and a `Record` for replay."""

from __future__ import annotations

import io
import json
import os
import struct
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import IO

from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.writer import Writer
from safetensors import SafetensorError
from safetensors.numpy import load, save

from motiondiffuse_ros.errors import InputError, RecordingError, RecordingNotWritten
from motiondiffuse_ros.recording.record import Record

RECORD, ARRAYS, EDITED = "record.json", "arrays.safetensors", "edited_motion"
"""Attachments."""

HASHES = "motiondiffuse"
"""Metadata record with the SHA-256 of each attachment."""

MAX_BYTES = 2**30
"""Of a file that is read."""


@dataclass(frozen=True)
class Topic:
    """One message of a plan, for other tools.

    Attributes:
        name: Of the topic.
        type: As pkg/msg/Name.
        schema: Definition of the type, in ROS's form.
        message: CDR.
    """

    name: str
    type: str
    schema: str = field(repr=False)
    message: bytes = field(repr=False)


def write_recording(
    path: Path, record: Record, topics: Sequence[Topic] = (), time: int = 0
) -> None:
    """Write a recording; under its name there is all of it or what was there before.

    Args:
        path: Of the file; folders are made.
        record: For replay.
        topics: Messages for other tools.
        time: At which all of it is stamped [ns].

    Raises:
        RecordingNotWritten: If there is no room, or no leave to write.
    """
    temporary: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # another ending, so that nobody takes it for a recording
        with tempfile.NamedTemporaryFile(
            dir=path.parent, prefix=f".{path.name}.", suffix=".part", delete=False
        ) as file:
            temporary = Path(file.name)
            _write(file.file, record, topics, time)
            file.flush()
            os.fsync(file.fileno())
            os.fchmod(file.fileno(), 0o644)
        temporary.replace(path)
    except OSError as error:
        raise RecordingNotWritten(
            f"recording {path}: cannot be written ({error.strerror or error})"
        ) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def read_recording(path: Path) -> Record:
    """Read what replay needs of a recording.

    Raises:
        RecordingError: If the file cannot be read, is too large, truncated, altered, or no
            recording of a plan; names the file.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise RecordingError(f"recording {path}: cannot be read ({error.strerror})") from error
    if len(content) > MAX_BYTES:
        raise RecordingError(f"recording {path}: larger than {MAX_BYTES >> 20} MiB")
    try:
        attached = _attachments(content)
        arrays = load(attached[ARRAYS])
        return Record.from_dict(json.loads(attached[RECORD]), arrays, attached.get(EDITED, b""))
    except InputError as error:
        raise RecordingError(f"recording {path}: {error}") from error
    except (
        *(McapError, SafetensorError, struct.error, EOFError, OSError, StopIteration),
        *(ValueError, KeyError, TypeError, RecursionError, OverflowError, MemoryError),
    ) as error:
        said = " ".join(str(error).split())[:120]
        raise RecordingError(f"recording {path}: truncated or damaged ({said})") from error


def _write(file: IO[bytes], record: Record, topics: Sequence[Topic], time: int) -> None:
    writer = Writer(file)
    writer.start(profile="ros2", library="motiondiffuse_ros")
    for topic in topics:
        schema = writer.register_schema(topic.type, "ros2msg", topic.schema.encode())
        channel = writer.register_channel(topic.name, "cdr", schema)
        writer.add_message(channel, log_time=time, data=topic.message, publish_time=time)
    attached = {
        RECORD: ("application/json", json.dumps(record.to_dict(), indent=1).encode()),
        ARRAYS: ("application/octet-stream", save(_plain(record))),
    }
    if record.edited:
        attached[EDITED] = ("application/octet-stream", record.edited)
    for name, (kind, data) in attached.items():
        writer.add_attachment(time, time, name, kind, data)
    hashes = {name: sha256(data).hexdigest() for name, (_, data) in attached.items()}
    writer.add_metadata(HASHES, hashes)
    writer.finish()


def _plain(record: Record) -> dict:
    # safetensors writes the memory as it lies, whatever the strides say
    return {name: values.copy(order="C") for name, values in record.values.items()}


def _attachments(content: bytes) -> dict[str, bytes]:
    """Return the attachments by name, each with the hash that the metadata gives it."""
    # all of it is in memory: a length that lies cannot ask for more than there is
    reader = SeekingReader(io.BytesIO(content), record_size_limit=MAX_BYTES)
    summary = reader.get_summary()
    if summary is None or len(summary.attachment_indexes) > 3:
        raise RecordingError("an MCAP file, but not the recording of a plan")
    attached = {item.name: item.data for item in reader.iter_attachments()}
    hashes = next((m.metadata for m in reader.iter_metadata() if m.name == HASHES), None)
    if hashes is None or not {RECORD, ARRAYS} <= set(attached):
        raise RecordingError("an MCAP file, but not the recording of a plan")
    for name in {*hashes, *attached}:
        found = sha256(attached.get(name, b"")).hexdigest()
        if hashes.get(name) != found:
            raise RecordingError(f"{name} in it was altered (SHA-256 {found[:12]}…)")
    return attached
