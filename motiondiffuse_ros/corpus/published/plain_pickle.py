"""Reading pickles that hold plain data, without running what else a pickle may hold.

Some data sets are published as pickles, which can name any function to be called when they are
read. Here only what numpy arrays and Python's own containers and numbers are made of is let
through. Used when importing; nothing is unpickled at run time.
"""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np

from motiondiffuse_ros.corpus.published.files import require
from motiondiffuse_ros.errors import CorpusError

# numpy has moved these between modules, under names that do not change
_NUMPY = {
    "_reconstruct": np.zeros(1).__reduce__()[0],
    "scalar": np.float64(0.0).__reduce__()[0],  # type: ignore[index]
    "_frombuffer": np.zeros(1).__reduce_ex__(5)[0],
    "ndarray": np.ndarray,
    "dtype": np.dtype,
}
_NUMPY_MODULES = {
    "numpy",
    *(f"numpy.{core}.{name}" for core in ("core", "_core") for name in ("multiarray", "numeric")),
}


def read_plain_pickle(path: Path, what: str) -> Any:
    """Read a pickle of arrays, dicts, lists, strings and numbers.

    Raises:
        CorpusError: If the file is missing or broken, or holds anything else; names it.
    """
    try:
        with require(path, what).open("rb") as file:
            # Python 2's strings, as in files written by it, are read byte by byte
            return _PlainUnpickler(file, encoding="latin1").load()
    except CorpusError:
        raise
    except Exception as error:  # a broken pickle may raise anything
        raise CorpusError(f"{path}: not a pickle of plain data ({error}); {what}") from error


class _PlainUnpickler(pickle.Unpickler):
    def find_class(self, module_name: str, global_name: str) -> Any:
        if module_name in _NUMPY_MODULES and global_name in _NUMPY:
            return _NUMPY[global_name]
        if (module_name, global_name) == ("_codecs", "encode"):
            return _latin1
        if (module_name, global_name) == ("__builtin__", "bytes"):
            return _no_bytes
        raise pickle.UnpicklingError(
            f"it wants {module_name}.{global_name}; only numpy arrays and plain values are read"
        )


def _no_bytes() -> bytes:
    """Return what old pickles write so, in arrays that hold nothing."""
    return b""


def _latin1(text: str, encoding: str) -> bytes:
    """Encode as old pickles do for bytes; in no other encoding, some of which unpack or decode."""
    if encoding != "latin1":
        raise pickle.UnpicklingError(f"it wants the encoding {encoding}; only latin1 is known")
    return text.encode("latin1")
