"""What a motion does, as yes or no: rules for prompts that need neither eyes nor a network.

Every rule takes a motion that starts over the origin facing +x (y is left) and is a plain function
of joint positions, so that it can be argued with. Distances in m, speeds in m/s, angles in degrees.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot

Check = Callable[[Motion], bool]


@dataclass(frozen=True)
class Rule:
    """A condition on a motion.

    Attributes:
        words: What must hold.
        holds: Whether it does.
    """

    words: str
    holds: Check

    def __and__(self, other: Rule) -> Rule:
        """Return the rule that both hold."""
        return Rule(f"{self.words}, {other.words}", lambda m: self.holds(m) and other.holds(m))


_OTHER = {"left": "right", "right": "left"}


def travel(motion: Motion) -> np.ndarray:
    """Return the way from the first root position to the last [3]."""
    return motion.root[-1] - motion.root[0]


def path_length(motion: Motion) -> float:
    """Return the length of the root's way over the floor."""
    return float(np.linalg.norm(np.diff(motion.root[:, :2], axis=0), axis=1).sum())


def height(motion: Motion, joint: str) -> np.ndarray:
    """Return the height of a joint [T]."""
    return motion.joint(joint)[:, 2]


def joint_speed(motion: Motion, joint: str) -> np.ndarray:
    """Return the speed of a joint relative to the pelvis, smoothed over three frames [T - 2]."""
    place = motion.joint(joint) - motion.root
    return np.linalg.norm(place[2:] - place[:-2], axis=1) * motion.fps / 2.0


def turned(motion: Motion) -> float:
    """Return how far the heading turned from start to end, to the left, degrees."""
    heading = np.unwrap(rot.twist_angle(motion.rotations[:, 0], 2))
    return float(np.degrees(heading[-1] - heading[0]))


def goes_ahead(least: float, most: float = np.inf) -> Rule:
    """Ends ahead of the start, and further ahead than aside."""
    return Rule(
        f"ends over {least} m ahead, less aside",
        lambda m: least < travel(m)[0] < most and abs(travel(m)[1]) < travel(m)[0],
    )


def goes_back(least: float) -> Rule:
    """Ends behind the start, and further behind than aside."""
    return Rule(
        f"ends over {least} m behind, less aside",
        lambda m: travel(m)[0] < -least and abs(travel(m)[1]) < -travel(m)[0],
    )


def goes_aside(side: str, least: float = 0.3) -> Rule:
    """Ends beside the start, and further aside than ahead or behind."""
    sign = 1.0 if side == "left" else -1.0
    return Rule(
        f"ends over {least} m to the {side}, less ahead",
        lambda m: sign * travel(m)[1] > max(least, abs(travel(m)[0])),
    )


def speed_is(least: float, most: float = np.inf) -> Rule:
    """The mean speed along the way lies between two bounds."""
    words = f"{least} m/s or faster" if most == np.inf else f"{least} to {most} m/s"
    return Rule(words, lambda m: least <= path_length(m) / m.duration <= most)


def stays(most: float = 0.6) -> Rule:
    """Ends near the start."""
    return Rule(f"ends within {most} m", lambda m: float(np.linalg.norm(travel(m)[:2])) < most)


def turns(side: str, least: float, most: float = np.inf) -> Rule:
    """The heading ends turned to one side."""
    sign = 1.0 if side == "left" else -1.0
    return Rule(f"turns {side} by over {least:.0f}°", lambda m: least < sign * turned(m) < most)


def turns_either_way(least: float) -> Rule:
    """The heading ends turned."""
    return Rule(f"turns by over {least:.0f}°", lambda m: abs(turned(m)) > least)


def keeps_heading(most: float = 45.0) -> Rule:
    """The heading ends near where it was."""
    return Rule(f"turns by under {most:.0f}°", lambda m: abs(turned(m)) < most)


def hand_up(side: str) -> Rule:
    """One wrist over its shoulder for half a second, the other one never over its own."""

    def holds(m: Motion) -> bool:
        up = height(m, f"{side}_wrist") > height(m, f"{side}_shoulder")
        other = _OTHER[side]
        idle = height(m, f"{other}_wrist") < height(m, f"{other}_shoulder")
        return up.sum() >= 0.5 * m.fps and bool(idle.all())

    return Rule(f"{side} wrist over its shoulder, the other not", holds)


def both_hands_up() -> Rule:
    """Both wrists over the head at once for a quarter of a second."""

    def holds(m: Motion) -> bool:
        head = height(m, "head")
        up = (height(m, "left_wrist") > head) & (height(m, "right_wrist") > head)
        return up.sum() >= 0.25 * m.fps

    return Rule("both wrists over the head", holds)


def limb_leads(joint: str, least: float) -> Rule:
    """A left or right joint reaches a speed, and a higher one than its counterpart."""
    side, part = joint.split("_", 1)
    other = f"{_OTHER[side]}_{part}"

    def holds(m: Motion) -> bool:
        fast = joint_speed(m, joint).max()
        return fast > least and fast > 1.2 * joint_speed(m, other).max()

    return Rule(f"{side} {part} over {least} m/s and faster than the other", holds)


def moves_fast(joints: tuple[str, ...], least: float) -> Rule:
    """One of some joints reaches a speed relative to the pelvis."""
    return Rule(
        f"{' or '.join(j.replace('_', ' ') for j in joints)} over {least} m/s",
        lambda m: max(joint_speed(m, j).max() for j in joints) > least,
    )


def hands_meet() -> Rule:
    """The wrists come near each other again and again."""

    def holds(m: Motion) -> bool:
        apart = np.linalg.norm(m.joint("left_wrist") - m.joint("right_wrist"), axis=1)
        near = apart < 0.25
        return int((near[1:] & ~near[:-1]).sum()) >= 2

    return Rule("wrists within 25 cm at least twice", holds)


def arms_spread() -> Rule:
    """Both wrists far out to the sides at shoulder height at once."""

    def holds(m: Motion) -> bool:
        apart = np.linalg.norm(m.joint("left_wrist") - m.joint("right_wrist"), axis=1)
        level = [abs(height(m, f"{s}_wrist") - height(m, f"{s}_shoulder")) < 0.35 for s in _OTHER]
        return bool(((apart > 1.1) & level[0] & level[1]).any())

    return Rule("wrists over 1.1 m apart at shoulder height", holds)


def foot_up(side: str, least: float) -> Rule:
    """One foot gets high, and higher than the other."""

    def holds(m: Motion) -> bool:
        own = height(m, f"{side}_foot").max()
        return own > least and own > height(m, f"{_OTHER[side]}_foot").max()

    return Rule(f"{side} foot over {least} m and higher than the other", holds)


def jumps(times: int = 1) -> Rule:
    """Both feet well off the floor at once while the pelvis is above its height at the start."""

    def holds(m: Motion) -> bool:
        feet = np.minimum(height(m, "left_foot"), height(m, "right_foot"))
        rest = np.median(feet[: max(3, m.frames // 10)])
        up = (feet > rest + 0.08) & (m.root[:, 2] > m.root[0, 2] + 0.03)
        return int((up[1:] & ~up[:-1]).sum()) >= times

    return Rule(f"both feet 8 cm off the floor, {times} time(s)", holds)


def jumping_jacks(times: int = 2) -> Rule:
    """Arms go up while legs go apart, after both were down and together.

    How far the feet leave the floor says less: in recorded ones toes rise by 5 cm.
    """

    def holds(m: Motion) -> bool:
        wrists = np.array([height(m, f"{side}_wrist") for side in _OTHER])
        shoulders = np.array([height(m, f"{side}_shoulder") for side in _OTHER])
        apart = np.linalg.norm(m.joint("left_ankle") - m.joint("right_ankle"), axis=1)
        opened = (wrists > height(m, "head")).all(axis=0) & (apart > 0.5)
        closed = (wrists < shoulders).all(axis=0) & (apart < 0.4)
        passed = (opened.astype(int) - closed)[opened | closed]
        return int((np.diff(passed) > 0).sum()) >= times

    return Rule(f"arms up and legs apart after both were down, {times} times", holds)


def steps_in_turn(times: int) -> Rule:
    """The feet are lifted by turns."""

    def holds(m: Motion) -> bool:
        left, right = height(m, "left_foot"), height(m, "right_foot")
        higher = np.sign(np.where(abs(left - right) > 0.06, left - right, 0.0))
        lifted = higher[higher != 0.0]
        return int((lifted[1:] != lifted[:-1]).sum()) >= times

    return Rule(f"feet lifted by turns, {times} changes", holds)


def nods_down(least: float) -> Rule:
    """The head sinks and comes up again."""

    def holds(m: Motion) -> bool:
        head = height(m, "head")
        lowest = int(np.argmin(head))
        return bool(head[0] - head[lowest] > least and head[lowest:].max() - head[lowest] > 0.1)

    return Rule(f"head {least} m down, then up", holds)


def pelvis_sinks(least: float) -> Rule:
    """The pelvis gets lower than it began."""
    return Rule(
        f"pelvis {least} m lower", lambda m: float(m.root[0, 2] - m.root[:, 2].min()) > least
    )


def hand_reaches_down(most: float) -> Rule:
    """A wrist comes near the floor."""
    return Rule(
        f"a wrist under {most} m",
        lambda m: min(height(m, "left_wrist").min(), height(m, "right_wrist").min()) < most,
    )


def on_toes() -> Rule:
    """The lower heel is far above the floor for most of the time."""

    def holds(m: Motion) -> bool:
        heel = np.minimum(height(m, "left_ankle"), height(m, "right_ankle"))
        return float((heel > 0.11).mean()) > 0.5

    return Rule("lower ankle over 11 cm for half the time", holds)


def is_still() -> Rule:
    """No joint moves faster than a sway, but for a tenth of the time."""

    def holds(m: Motion) -> bool:
        speed = np.linalg.norm(np.diff(m.positions, axis=0), axis=-1) * m.fps
        return float(np.percentile(speed.max(axis=1), 90)) < 0.3 and stays(0.3).holds(m)

    return Rule("every joint under 0.3 m/s for nine tenths of the time", holds)


def is_lively() -> Rule:
    """The body as a whole moves."""

    def holds(m: Motion) -> bool:
        speed = np.linalg.norm(np.diff(m.positions, axis=0), axis=-1) * m.fps
        return float(speed.mean()) > 0.4

    return Rule("mean joint speed over 0.4 m/s", holds)
