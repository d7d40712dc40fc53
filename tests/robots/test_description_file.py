"""A description that is wrong is refused, and the message says where and what would be right."""

import pytest
import yaml

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.robots import available_robots, get_robot, robot_refusal
from motiondiffuse_ros.robots.description_file import NEEDED, DescriptionFile
from motiondiffuse_ros.robots.model_search import VARIABLE

LIMBS = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")


def small_robot() -> str:
    """A robot of boxes whose zero pose is the T-pose."""

    def link(name: str, at: str, axis: str, size: str, inside: str = "") -> str:
        return (
            f'<body name="{name}" pos="{at}"><joint name="{name}_joint" axis="{axis}" '
            f'range="-2 2"/><geom type="box" size="{size}"/>{inside}</body>'
        )

    def side(name: str, y: float) -> str:
        ankle = link(f"{name}_ankle", "0 0 -0.4", "0 1 0", "0.1 0.04 0.02")
        knee = link(f"{name}_knee", "0 0 -0.4", "0 1 0", "0.03 0.03 0.1", ankle)
        hip = link(f"{name}_hip", f"0 {y} -0.1", "0 1 0", "0.03 0.03 0.1", knee)
        wrist = link(f"{name}_wrist", f"0 {2 * y} 0", "0 1 0", "0.02 0.02 0.02")
        elbow = link(f"{name}_elbow", f"0 {2 * y} 0", "0 0 1", "0.02 0.02 0.02", wrist)
        shoulder = link(f"{name}_shoulder", f"0 {2 * y} 0.4", "1 0 0", "0.02 0.02 0.02", elbow)
        return hip + shoulder

    joints = [f"{s}_{limb}_joint" for s in ("left", "right") for limb in LIMBS]
    motors = "".join(f'<position joint="{j}" kp="50" forcerange="-50 50"/>' for j in joints)
    return (
        '<mujoco><worldbody><body name="trunk" pos="0 0 1"><freejoint/>'
        f'<geom type="box" size="0.05 0.05 0.2"/>{side("left", 0.15)}{side("right", -0.15)}'
        f"</body></worldbody><actuator>{motors}</actuator></mujoco>"
    )


def fields() -> dict:
    bodies = {name: name for name in NEEDED} | {"pelvis": "trunk", "spine3": "trunk"}
    return {"model": "robot.xml", "bodies": bodies, "speed_limits": {"*_joint": 10}}


def written(folder, **changes):
    (folder / "robot.xml").write_text(small_robot())
    path = folder / "my_robot.yaml"
    path.write_text(yaml.safe_dump({k: v for k, v in (fields() | changes).items() if v != ...}))
    return path


def test_a_robot_of_ones_own_is_a_model_and_a_file(tmp_path):
    path = written(tmp_path)
    robot = get_robot(str(path))
    assert robot.name == str(path)
    assert len(robot.joint_names) == 12
    assert set(robot.velocity_limits) == {10.0}
    assert set(robot.torque_limits) == {50.0}
    # it stands on its floor: ankle 0.9 m below the base, the sole 2 cm lower
    assert robot.model.qpos0[2] == pytest.approx(0.92)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"model": ...}, "model must be a file such as"),
        ({"modle": "x"}, "unknown field 'modle'; the fields are model, bodies"),
        ({"bodies": ["a"]}, "bodies must map canonical joints to bodies"),
        ({"bodies": {"pelvis": "trunk"}}, "bodies: spine3 is missing; needed are pelvis, spine3"),
        (
            {"bodies": fields()["bodies"] | {"tail": "x"}},
            "bodies: unknown canonical joint 'tail'; they are pelvis",
        ),
        (
            {"bodies": fields()["bodies"] | {"left_knee": "shin"}},
            r"bodies.left_knee: no body 'shin' in .*robot.xml; they are trunk",
        ),
        (
            {"bodies": fields()["bodies"] | {"left_knee": ["left_knee", 1]}},
            r"bodies.left_knee must be a body or \[body, x, y, z\]",
        ),
        ({"t_pose": {"nose_joint": 1}}, "t_pose: no joint 'nose_joint'; they are left_hip_joint"),
        ({"rest": {"left_hip_joint": "up"}}, "rest.left_hip_joint must be a finite number"),
        ({"rest": {"left_hip_joint": float("nan")}}, "rest.left_hip_joint must be a finite"),
        ({"speed_limits": {"*wheel*": 1}}, r"speed_limits: '\*wheel\*' names no joint"),
        ({"speed_limits": {"*": 0}}, r"speed_limits.\* must be above 0 rad/s"),
        ({"speed_limits": {"left_*": 3}}, "joint 'right_hip_joint' has no speed limit"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, changes, words):
    with pytest.raises(RobotError, match=words):
        get_robot(str(written(tmp_path, **changes)))


@pytest.mark.parametrize(
    "text",
    ["[1, 2", "- a\n- b\n", "!!python/object/apply:os.system ['true']", "\x00"],
)
def test_what_is_not_a_description_is_refused_in_one_line(tmp_path, text):
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(RobotError) as caught:
        DescriptionFile.read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_broken_model_is_the_descriptions_fault(tmp_path):
    path = written(tmp_path)
    (tmp_path / "robot.xml").write_text("<mujoco><worldbody><geom/></worldbody></mujoco>")
    with pytest.raises(RobotError, match=r"my_robot.yaml: "):
        get_robot(str(path))


def test_a_missing_model_lists_the_ways_to_get_one(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "elsewhere"))
    with pytest.raises(RobotError) as caught:
        get_robot(str(written(tmp_path, model="acme/robot.xml")))
    for way in (VARIABLE, "mujoco_menagerie", "pip install", str(tmp_path / "elsewhere")):
        assert way in str(caught.value)


def test_names_and_files_are_told_apart_without_loading(tmp_path):
    assert all(robot_refusal(name) == "" for name in available_robots())
    assert robot_refusal(str(written(tmp_path))) == ""
    assert "or the path of a YAML" in robot_refusal("atlas")
    assert "no robot description at" in robot_refusal(str(tmp_path / "gone.yaml"))
