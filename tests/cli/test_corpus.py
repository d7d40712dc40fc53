import numpy as np
import pytest
from synthetic import drifting, standing

from motiondiffuse_ros.cli.corpus import main
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.errors import CorpusError, InputError
from motiondiffuse_ros.motion.bvh import write_bvh
from motiondiffuse_ros.motion.features import HumanML3D


@pytest.fixture
def humanml3d(tmp_path):
    folder = tmp_path / "HumanML3D"
    for part in ("new_joint_vecs", "texts"):
        (folder / part).mkdir(parents=True)
    for split, name in (("train", "000001"), ("val", "000002"), ("test", "000003")):
        (folder / f"{split}.txt").write_text(f"{name}\n")
        features = HumanML3D().encode(drifting(standing(60), 1.0))
        np.save(folder / "new_joint_vecs" / f"{name}.npy", features)
        (folder / "texts" / f"{name}.txt").write_text("a person walks#a/DET#0.0#0.0\n")
    return folder


def test_a_published_data_set_becomes_a_corpus(humanml3d, tmp_path, capsys):
    assert main(["build", "--humanml3d", str(humanml3d), "--out", str(tmp_path / "c")]) == 0
    corpus = Corpus.load(tmp_path / "c")
    assert [c.split for c in corpus.clips] == ["train", "val", "test"]
    assert corpus.representation.name == "humanml3d"
    assert "humanml3d" in capsys.readouterr().out


def test_representations_are_not_mixed(humanml3d, tmp_path):
    (tmp_path / "own").mkdir()
    write_bvh(standing(30), tmp_path / "own" / "walk_001.bvh")
    arguments = ["build", "--humanml3d", str(humanml3d), "--bvh", str(tmp_path / "own")]
    with pytest.raises(CorpusError, match="own: pose_state at 20 Hz, humanml3d: humanml3d at 20"):
        main(arguments)
    with pytest.raises(CorpusError, match=r"kit_ml: kit_ml at 12\.5 Hz"):
        main([*arguments[:3], "--kit-ml", str(humanml3d)])


def test_babel_needs_amass(tmp_path):
    with pytest.raises(InputError, match="--babel and --amass go together"):
        main(["build", "--babel", str(tmp_path)])


def test_nothing_to_build_from_lists_what_there_is():
    with pytest.raises(CorpusError, match=r"--cmu.*--humanml3d"):
        main(["build"])
