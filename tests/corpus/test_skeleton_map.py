import pytest
import yaml

from motiondiffuse_ros.corpus.skeleton_map import SkeletonMap, shipped_skeleton_maps
from motiondiffuse_ros.errors import CorpusError


def test_shipped_maps_load():
    assert {m.name for m in shipped_skeleton_maps()} == {"bandai_namco", "canonical", "cmu"}


LEGS = {f"{s}_{j}": f"{s}_{j}" for s in ("left", "right") for j in ("hip", "knee", "ankle")}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"joints": {**LEGS, "pelvis": "p", "tail": "t"}}, "tail"),
        ({"joints": {"pelvis": "p"}}, "left_hip"),
        ({"speed": 3}, "unknown keys.*speed"),
    ],
)
def test_bad_maps_are_refused_with_the_key(tmp_path, change, says):
    data = {"name": "mine", "joints": {**LEGS, "pelvis": "p"}, **change}
    path = tmp_path / "map.yaml"
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(CorpusError, match=says):
        SkeletonMap.from_yaml(path)


def test_missing_map_is_refused(tmp_path):
    with pytest.raises(CorpusError, match="cannot be read"):
        SkeletonMap.from_yaml(tmp_path / "none.yaml")
