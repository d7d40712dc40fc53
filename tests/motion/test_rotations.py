import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.frames import (
    quaternions_to_y_up,
    quaternions_to_z_up,
    vectors_to_y_up,
)

vectors = arrays(np.float64, (5, 3), elements=st.floats(-1.8, 1.8))


def _scipy(q):
    return Rotation.from_quat(q, scalar_first=True)


@given(vectors, vectors, vectors)
def test_product_and_action_are_those_of_scipy(a, b, v):
    p, q = rot.from_rotation_vector(a), rot.from_rotation_vector(b)
    np.testing.assert_allclose(
        rot.rotate(rot.multiply(p, q), v), (_scipy(p) * _scipy(q)).apply(v), atol=1e-9
    )
    np.testing.assert_allclose(rot.to_matrix(p), _scipy(p).as_matrix(), atol=1e-9)


@given(vectors)
def test_rotation_vectors_round_trip(v):
    # 1.8 sqrt(3) < pi: inside the ball where the logarithm is unique
    np.testing.assert_allclose(rot.to_rotation_vector(rot.from_rotation_vector(v)), v, atol=1e-7)


@given(vectors, st.floats(-3.1, 3.1))
def test_twist_is_what_was_put_about_the_axis(v, angle):
    swing = rot.from_rotation_vector(v * [1.0, 1.0, 0.0] * 0.5)
    twisted = rot.multiply(rot.about_axis(2, np.full(5, angle)), swing)
    np.testing.assert_allclose(rot.twist_angle(twisted, 2), angle, atol=1e-6)


@given(vectors, vectors)
def test_frame_change_is_a_rotation_and_has_an_inverse(a, v):
    q = rot.from_rotation_vector(a)
    np.testing.assert_allclose(
        vectors_to_y_up(rot.rotate(q, v)),
        rot.rotate(quaternions_to_y_up(q), vectors_to_y_up(v)),
        atol=1e-9,
    )
    np.testing.assert_array_equal(quaternions_to_z_up(quaternions_to_y_up(q)), q)


def test_forward_left_up_become_forward_left_up():
    forward, left, up = np.eye(3)
    np.testing.assert_array_equal(vectors_to_y_up(forward), [0, 0, 1])
    np.testing.assert_array_equal(vectors_to_y_up(left), [1, 0, 0])
    np.testing.assert_array_equal(vectors_to_y_up(up), [0, 1, 0])


def test_shortest_arc_takes_one_direction_to_the_other():
    a, b = np.array([1.0, 2.0, 0.5]), np.array([-0.3, 1.0, 2.0])
    turned = rot.rotate(rot.shortest_arc(a, b), a)
    np.testing.assert_allclose(turned / np.linalg.norm(a), b / np.linalg.norm(b), atol=1e-12)
