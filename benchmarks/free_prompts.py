"""Prompts as people type them, each with what must then be seen.

None of them is a caption of the corpus or a statement (tests/benchmarks checks the shipped ones),
and none was used to choose weights or settings. Rules are not made to fit what comes, but one was
changed after it was seen to fail on recorded motion: jumping jacks were asked to leave the floor by
8 cm twice, which of the training clips' 17 windows of them, but for those of one subject, 1 does.
"""

from __future__ import annotations

from benchmarks.kinematic_rules import (
    Rule,
    arms_spread,
    both_hands_up,
    foot_up,
    goes_ahead,
    goes_aside,
    goes_back,
    hand_reaches_down,
    hand_up,
    hands_meet,
    is_lively,
    is_still,
    jumping_jacks,
    jumps,
    keeps_heading,
    limb_leads,
    moves_fast,
    nods_down,
    on_toes,
    pelvis_sinks,
    speed_is,
    stays,
    steps_in_turn,
    turns,
    turns_either_way,
)

_WRISTS = ("left_wrist", "right_wrist")

FREE_PROMPTS: dict[str, Rule] = {
    # where to
    "walk ahead for a while": goes_ahead(1.5) & speed_is(0.4, 2.0),
    "someone walks straight ahead": goes_ahead(2.0) & keeps_heading(),
    "a man strolls along": goes_ahead(1.0) & speed_is(0.3, 1.6),
    "take two steps forward": goes_ahead(0.4, 4.0),
    "move backwards on foot": goes_back(0.8),
    "take a step back": goes_back(0.3),
    "go backward slowly": goes_back(0.3) & speed_is(0.1, 1.2),
    "sidestep to the right": goes_aside("right"),
    "shuffle sideways to the left": goes_aside("left"),
    "a woman moves to her left side": goes_aside("left"),
    "take a few steps to the right": goes_aside("right"),
    # how fast
    "walk rather slowly": goes_ahead(0.5) & speed_is(0.15, 0.9),
    "walk as fast as you can": goes_ahead(2.0) & speed_is(1.2, 3.0),
    "a person jogs forward": goes_ahead(4.0) & speed_is(1.5, 5.0),
    "run ahead": goes_ahead(5.0) & speed_is(2.0),
    "someone sprints ahead": goes_ahead(7.0) & speed_is(2.5),
    "just stand there": is_still(),
    "wait and do nothing": is_still(),
    "tiptoe forward": goes_ahead(0.5) & on_toes(),
    "sneak forward quietly": goes_ahead(0.5) & speed_is(0.1, 1.2),
    "shuffle along like an old man": goes_ahead(0.5) & speed_is(0.1, 1.1),
    "walk along full of energy": goes_ahead(1.5) & speed_is(0.7, 3.0),
    "march the way soldiers do": steps_in_turn(4),
    "march on the spot": steps_in_turn(4) & stays(),
    # turns
    "turn left": turns("left", 40.0),
    "turn to the right": turns("right", 40.0),
    "turn all the way around": turns_either_way(110.0),
    "walk and then turn left": turns("left", 30.0) & speed_is(0.3, 2.0),
    "walk forward and make a right turn": turns("right", 30.0) & speed_is(0.3, 2.0),
    "walk in a circle": turns_either_way(150.0) & speed_is(0.3, 2.0),
    "walk in a circle to the left": turns("left", 120.0) & speed_is(0.3, 2.0),
    "run in a curve to the right": turns("right", 30.0) & speed_is(1.5),
    # hands
    "say hello with a wave": moves_fast(_WRISTS, 0.7) & stays(),
    "wave at me with your right hand": hand_up("right") & stays(),
    "someone waves with their left arm": hand_up("left") & stays(),
    "wave goodbye with both hands": both_hands_up() & stays(),
    "raise your right arm": hand_up("right") & stays(),
    "lift the left hand over the head": hand_up("left") & stays(),
    "reach both hands up high": both_hands_up() & stays(),
    "hands up": both_hands_up() & stays(),
    "clap your hands": hands_meet() & stays(),
    "hold your arms out to the sides": arms_spread() & stays(),
    "punch with the right fist": limb_leads("right_wrist", 1.5),
    "a boxer throws a left punch": limb_leads("left_wrist", 1.5),
    "throw a ball": moves_fast(_WRISTS, 2.0),
    "swing your arms": moves_fast(_WRISTS, 1.0) & stays(1.0),
    "conduct an orchestra": moves_fast(_WRISTS, 0.7) & stays(),
    # legs
    "kick with the right foot": limb_leads("right_foot", 2.0) & foot_up("right", 0.3),
    "kick a ball with your left leg": limb_leads("left_foot", 2.0) & foot_up("left", 0.3),
    "jump once": jumps(),
    "jump up and down": jumps(2),
    "leap ahead once": jumps() & goes_ahead(0.4),
    "do jumping jacks": jumping_jacks(),
    "hop on one leg": jumps(2),
    # posture
    "bow before the audience": nods_down(0.15) & stays(),
    "a person bows politely": nods_down(0.15) & stays(),
    "squat down": pelvis_sinks(0.25) & stays(),
    "crouch": pelvis_sinks(0.2),
    "sit down": pelvis_sinks(0.25),
    "kneel on the floor": pelvis_sinks(0.3),
    "pick something up from the floor": hand_reaches_down(0.4),
    "bend down and touch your toes": hand_reaches_down(0.35),
    # whole body
    "dance to the music": is_lively(),
    "swing a golf club": moves_fast(_WRISTS, 2.0) & stays(1.0),
}
