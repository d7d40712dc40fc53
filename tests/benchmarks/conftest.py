"""What no prompt of a benchmark may be."""

import pytest

from motiondiffuse_ros.corpus.captions import mirror_caption, read_captions, shipped_caption_files
from motiondiffuse_ros.corpus.statements import all_statements
from motiondiffuse_ros.corpus.wordings import all_wordings


@pytest.fixture(scope="session")
def training_texts() -> set[str]:
    """Every text that training may show, mirrored ones included, in small letters."""
    captions = {text for texts in read_captions(shipped_caption_files()).values() for text in texts}
    texts = {text.lower().strip(" .") for text in (*captions, *all_statements(), *all_wordings())}
    return texts | {mirror_caption(text) for text in texts}
