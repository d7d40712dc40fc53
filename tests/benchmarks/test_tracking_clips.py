"""The fixed list of clips for tracking."""

import json

from benchmarks.physics_tracking import CLIPS, PROMPTS, figures


def test_the_list_holds_what_was_agreed():
    clips = json.loads(CLIPS.read_text(encoding="utf-8"))
    assert {kind: len(names) for kind, names in clips.items()} == {
        "gesture": 10,
        "walk": 10,
        "turn": 5,
        "run": 5,
    }
    assert set(PROMPTS) == set(clips)
    names = [name for listed in clips.values() for name in listed]
    assert len(set(names)) == len(names)
    assert any(name.startswith("dataset-") for name in names)


def test_errors_are_of_what_succeeds():
    common = {"pd_success": False, "time_to_fall_s": 2.0, "seconds": 10.0, "core_seconds": 16.0}
    found = figures(
        [
            {"success": True, "mpjpe_mm": 50.0, **common},
            {"success": False, "mpjpe_mm": 300.0, **common},
        ]
    )
    assert found["success"] == 0.5
    assert found["mpjpe_mm"] == 50.0
    assert found["times_real_time"] == 5.0
    assert found["core_times_real_time"] == 8.0
