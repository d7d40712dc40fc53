"""The messages say the same as the Python code."""

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.msg import MotionSegment


def constants(message) -> dict:
    # rosidl keeps the constants of a message on its metaclass
    return {
        name: getattr(message, name)
        for name in dir(type(message))
        if name[0].isupper() and name.isupper()
    }


def test_action_result_has_the_error_codes_of_the_package():
    assert constants(GenerateMotion.Result) == {code.name: code.value for code in ErrorCode}


def test_segment_names_the_body_parts_of_the_package():
    assert set(constants(MotionSegment).values()) == set(PARTS)
    assert all(name.lower() == part for name, part in constants(MotionSegment).items())
