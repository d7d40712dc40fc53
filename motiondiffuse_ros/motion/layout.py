"""How a feature vector is laid out: named blocks, whose they are, and their mirror image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.parts import part_joints
from motiondiffuse_ros.motion.rotations import Array, Indices
from motiondiffuse_ros.motion.skeleton import CANONICAL

SCALAR = (1.0,)
ODD_SCALAR = (-1.0,)
VECTOR = (-1.0, 1.0, 1.0)
"""Signs of a vector under reflection of x, which is left in the y-up frame of the features."""
PLANAR = (-1.0, 1.0)
"""Signs of the x and z of a vector."""
COLUMNS = (1.0, -1.0, -1.0, -1.0, 1.0, 1.0)
"""Signs of a rotation's first two columns: those of M R M, where M = diag(-1, 1, 1) reflects."""

ROOT = (0,)


@dataclass(frozen=True)
class Block:
    """A block of the feature vector: entries of equal width, each belonging to a joint.

    Attributes:
        name: Its name.
        joints: The canonical joint of each entry, which decides what part owns it.
        signs: What a reflection does to each number of an entry; as many as an entry is wide.
        twins: For each entry the one on the other side of the body; None goes by the joints.
    """

    name: str
    joints: tuple[int, ...]
    signs: tuple[float, ...]
    twins: tuple[int, ...] | None = None

    @property
    def size(self) -> int:
        """Count of numbers."""
        return len(self.joints) * len(self.signs)

    def twin_entries(self) -> tuple[int, ...]:
        """Return for each entry the one on the other side."""
        if self.twins is not None:
            return self.twins
        return tuple(self.joints.index(CANONICAL.mirror_index[j]) for j in self.joints)


class Layout:
    """Blocks one after the other.

    A representation derives from this and has its `groups`, `part_indices` and `mirror`.
    """

    def __init__(self, *blocks: Block) -> None:
        self._blocks: dict[str, tuple[Block, slice]] = {}
        end = 0
        for block in blocks:
            self._blocks[block.name] = (block, slice(end, end + block.size))
            end += block.size
        self.dim = end

    def groups(self) -> dict[str, slice]:
        """Return the named blocks of the feature vector."""
        return {name: where for name, (_, where) in self._blocks.items()}

    def join(self, values: Mapping[str, NDArray[Any]]) -> Array:
        """Lay blocks [T, ...] side by side: [T, dim] float32."""
        columns = [np.reshape(values[name], (len(values[name]), -1)) for name in self._blocks]
        return np.concatenate(columns, axis=1).astype(np.float32)

    def split(self, features: Array) -> dict[str, Array]:
        """Return the blocks of features [T, dim] as float64: [T, width] or [T, entries, width]."""
        out = {}
        for name, (block, where) in self._blocks.items():
            flat = np.asarray(features[:, where], dtype=np.float64)
            shape = (len(block.joints), len(block.signs))
            out[name] = flat if shape[0] == 1 else flat.reshape(-1, *shape)
        return out

    def part_indices(self, part: str) -> Indices:
        """Return the indices a part owns; the root's own blocks go with the pelvis, so the legs."""
        joints = part_joints(part)
        owned = [
            np.arange(where.start, where.stop).reshape(-1, len(block.signs))[
                np.isin(block.joints, joints)
            ]
            for block, where in self._blocks.values()
        ]
        return np.concatenate([o.ravel() for o in owned])

    def mirror(self) -> tuple[Indices, Array]:
        """Return (index, sign) [dim] such that `features[:, index] * sign` is the mirror image."""
        index = np.arange(self.dim)
        sign = np.ones(self.dim, dtype=np.float32)
        for block, where in self._blocks.values():
            entries = index[where].reshape(-1, len(block.signs))
            index[where] = entries[list(block.twin_entries())].ravel()
            sign[where] = np.tile(block.signs, len(block.joints))
        return index, sign
