"""Where the public originals of the shipped captions are, and fetching what is one file."""

from __future__ import annotations

import urllib.request
import zipfile
from dataclasses import dataclass
from pathlib import Path

from motiondiffuse_ros.errors import CorpusError


@dataclass(frozen=True)
class Original:
    """A public data set.

    Attributes:
        title: Its name.
        licence: Terms, in a line.
        page: Where it is described and offered.
        archive: A zip of the whole set, or None if it must be fetched by hand.
        instructions: What to do after, or instead.
    """

    title: str
    licence: str
    page: str
    archive: str | None
    instructions: str


ORIGINALS: dict[str, Original] = {
    "cmu": Original(
        "Carnegie Mellon University Graphics Lab Motion Capture Database",
        "free for all uses; the data itself may not be resold; acknowledge mocap.cs.cmu.edu "
        "(NSF EIA-0196217)",
        "https://sites.google.com/a/cgspeed.com/cgspeed/motion-capture/daz-friendly-release",
        None,
        "Download the Daz-friendly BVH conversion (several zip files) from the page, unpack them "
        "into one folder of SS_TT.bvh files, and run\n"
        "  motiondiffuse corpus build --cmu FOLDER --out corpus/",
    ),
    "bandai-namco": Original(
        "Bandai-Namco Research Motiondataset",
        "CC BY-NC 4.0: non-commercial, and so is what is trained on it",
        "https://github.com/BandaiNamcoResearchInc/Bandai-Namco-Research-Motiondataset",
        "https://github.com/BandaiNamcoResearchInc/Bandai-Namco-Research-Motiondataset/"
        "archive/refs/heads/master.zip",
        "Then run\n  motiondiffuse corpus build --bandai-namco FOLDER --out corpus/",
    ),
}


def fetch(name: str, out: Path) -> str:
    """Download and unpack a data set if it is one archive; return what to do next.

    Args:
        name: Key of `ORIGINALS`.
        out: Folder to unpack into.

    Raises:
        CorpusError: If the name is unknown or the download fails; says where to get it by hand.
    """
    if name not in ORIGINALS:
        raise CorpusError(f"unknown data set '{name}'; known: {', '.join(ORIGINALS)}")
    original = ORIGINALS[name]
    lines = [original.title, f"licence: {original.licence}", f"page: {original.page}"]
    if original.archive is not None:
        folder = out / name
        _download(original, folder)
        lines.append(f"unpacked into {folder}")
    return "\n".join([*lines, original.instructions])


def _download(original: Original, folder: Path) -> None:
    assert original.archive is not None
    folder.mkdir(parents=True, exist_ok=True)
    archive = folder / "download.zip"
    try:
        urllib.request.urlretrieve(original.archive, archive)
        with zipfile.ZipFile(archive) as packed:
            packed.extractall(folder)
    except (OSError, zipfile.BadZipFile) as error:
        raise CorpusError(
            f"{original.title}: could not be downloaded ({error}); get it by hand from "
            f"{original.page} and unpack it into {folder}"
        ) from error
    finally:
        archive.unlink(missing_ok=True)
