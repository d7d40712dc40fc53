"""Files: what goes in comes out, and nothing else is taken for a recording."""

import json
import resource
from contextlib import contextmanager

import numpy as np
import pytest
from mcap.writer import Writer

from motiondiffuse_ros.errors import RecordingError, RecordingNotWritten
from motiondiffuse_ros.recording import Topic, read_recording, write_recording

TOPIC = Topic("/greeting", "std_msgs/msg/String", "string data\n", b"\0\1\0\0\3\0\0\0hi\0")


@pytest.fixture
def file(record, tmp_path):
    path = tmp_path / "new" / "plan.mcap"
    write_recording(path, record, [TOPIC], 5)
    return path


def test_what_goes_in_comes_out(file, record):
    found = read_recording(file)
    assert json.dumps(found.to_dict()) == json.dumps(record.to_dict())
    assert found.settings == record.settings
    assert set(found.values) == set(record.values)
    for name, values in record.values.items():
        assert found.values[name].dtype == values.dtype
        np.testing.assert_array_equal(found.values[name], values)
    assert [path.name for path in file.parent.iterdir()] == ["plan.mcap"]


def test_the_record_says_what_the_plan_was_made_from(record, plan):
    assert record.given.seed is None
    assert record.request.seed == plan.seed
    assert record.hashes["weights/model.safetensors"] == plan.weights_sha256
    assert {name.split("/")[0] for name in record.hashes} == {
        *("weights", "text encoder", "critic", "robot"),
    }
    assert {"motiondiffuse_ros", "code", "torch", "numpy", "mujoco"} <= set(record.surroundings)


def test_a_truncated_file_is_refused_wherever_it_ends(file):
    content = file.read_bytes()
    for length in (*range(0, 64), *np.linspace(64, len(content) - 1, 60).astype(int)):
        file.write_bytes(content[:length])
        with pytest.raises(RecordingError, match=r"plan\.mcap: ") as refusal:
            read_recording(file)
        assert len(str(refusal.value).splitlines()) == 1


def test_an_altered_file_is_refused_or_reads_the_same(file, record):
    content = file.read_bytes()
    random = np.random.default_rng(0)
    refused = 0
    for place in random.integers(0, len(content), 150):
        altered = bytearray(content)
        altered[place] ^= 1 << int(random.integers(8))
        file.write_bytes(altered)
        try:
            found = read_recording(file)
        except RecordingError:
            refused += 1
        else:  # it was in the messages for other tools, or in an index
            assert json.dumps(found.to_dict()) == json.dumps(record.to_dict())
    assert refused > 50


def test_other_files_are_refused(tmp_path):
    with pytest.raises(RecordingError, match="No such file"):
        read_recording(tmp_path / "none.mcap")
    with pytest.raises(RecordingError, match="directory"):
        read_recording(tmp_path)
    foreign = tmp_path / "foreign.mcap"
    with foreign.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        writer.finish()
    with pytest.raises(RecordingError, match="not the recording of a plan"):
        read_recording(foreign)


@contextmanager
def room_for(size):
    """Let this process write no file beyond a size, as on a disk that is full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_where_there_is_no_room_the_file_that_was_there_stays(file, record):
    before = file.read_bytes()
    with room_for(len(before) // 2), pytest.raises(RecordingNotWritten, match="cannot be written"):
        write_recording(file, record)
    assert [path.name for path in file.parent.iterdir()] == ["plan.mcap"]
    assert file.read_bytes() == before


def test_a_file_in_place_of_the_folder_is_named(record, tmp_path):
    (tmp_path / "folder").write_text("")
    with pytest.raises(RecordingNotWritten, match=r"folder/plan\.mcap"):
        write_recording(tmp_path / "folder" / "plan.mcap", record)
