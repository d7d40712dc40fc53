"""Draw the sheet of imported clips in docs/: the eye's test of the skeleton maps.

python -m benchmarks.import_sheet --data DIR   # DIR holds cmu/ and bandai-namco/
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import tyro

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.corpus.captions import captions_of, read_captions, shipped_caption_files
from motiondiffuse_ros.render import contact_sheet

CLIPS = (
    "cmu/02_01",
    "cmu/09_01",
    "cmu/13_11",
    "cmu/111_10",
    "cmu/111_17",
    "cmu/141_16",
    "bandai-namco/dataset-1_bow_active_001",
    "bandai-namco/dataset-1_kick_normal_001",
    "bandai-namco/dataset-1_walk-left_normal_001",
    "bandai-namco/dataset-2_raise-up-left-hand_normal_001",
    "bandai-namco/dataset-2_run_normal_001",
    "bandai-namco/dataset-2_walk-turn-right_normal_001",
)


@dataclass(frozen=True)
class Options:
    """What to draw."""

    data: Path
    """Folder with cmu/ and bandai-namco/."""
    out: Path = Path("docs/imported_clips.png")
    """The picture."""


def main() -> None:
    """Draw the sheet."""
    options = tyro.cli(Options)
    captions = read_captions(shipped_caption_files())
    rows = []
    for clip in CLIPS:
        name = Path(clip).name
        caption = captions_of(name, captions)[0]
        motion = load_motion(options.data / f"{clip}.bvh").canonicalised()
        rows.append((f"{name}: {caption}", motion))
    contact_sheet(rows, options.out)


if __name__ == "__main__":
    main()
