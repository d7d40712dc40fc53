import os
import pickle
from pathlib import Path

import numpy as np
import pytest

from motiondiffuse_ros.corpus.published.plain_pickle import read_plain_pickle
from motiondiffuse_ros.errors import CorpusError


class _Command:
    def __init__(self, target: Path) -> None:
        self.target = target

    def __reduce__(self):
        return os.mkdir, (str(self.target),)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_plain_data_of_every_protocol_is_read(tmp_path, protocol):
    data = {
        "pose": [np.arange(6.0).reshape(2, 3), np.zeros((0, 3), np.float32)],
        "fortran": np.asfortranarray(np.arange(6).reshape(2, 3)),
        "ragged": np.array([np.zeros(2), np.ones(3)], dtype=object),
        "scalar": np.float32(2.5),
        "plain": ("a", b"\xff", 1, 2.0, None, True),
    }
    path = tmp_path / "data.pkl"
    path.write_bytes(pickle.dumps(data, protocol))
    read = read_plain_pickle(path, "")
    assert read["plain"] == data["plain"]
    np.testing.assert_array_equal(read["pose"][0], data["pose"][0])
    np.testing.assert_array_equal(read["fortran"], data["fortran"])
    np.testing.assert_array_equal(read["ragged"][1], np.ones(3))
    assert read["pose"][1].shape == (0, 3)
    assert read["scalar"] == 2.5


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_nothing_else_is_called(tmp_path, protocol):
    path, target = tmp_path / "data.pkl", tmp_path / "made"
    path.write_bytes(pickle.dumps({"pose": [_Command(target)]}, protocol))
    with pytest.raises(CorpusError, match=r"data\.pkl: .*mkdir; only numpy arrays"):
        read_plain_pickle(path, "")
    assert not target.exists()


@pytest.mark.parametrize("name", ["load", "core.multiarray.fromfile", "lib.format.read_array"])
def test_other_functions_of_numpy_are_refused(tmp_path, name):
    module, _, function = f"numpy.{name}".rpartition(".")
    path = tmp_path / "data.pkl"
    path.write_bytes(f"c{module}\n{function}\n(S'x'\ntR.".encode())
    with pytest.raises(CorpusError, match="only numpy arrays"):
        read_plain_pickle(path, "")


def test_missing_and_broken_files_are_named(tmp_path):
    path = tmp_path / "data.pkl"
    with pytest.raises(CorpusError, match=r"data\.pkl: missing; it holds poses"):
        read_plain_pickle(path, "it holds poses")
    path.write_bytes(pickle.dumps(np.zeros(9))[:-9])
    with pytest.raises(CorpusError, match=r"data\.pkl: not a pickle of plain data"):
        read_plain_pickle(path, "it holds poses")
