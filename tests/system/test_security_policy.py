"""The SROS2 policy allows what the nodes do, and nothing that they do not."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ros_graph import FAST, START

from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running

POLICY = Path(__file__).parents[2] / "security" / "policies" / "motiondiffuse.policy.xml"
ON_DEMAND = {
    "motiondiffuse": {"/clock", "/joint_states", "/parameter_events"},
    "sim": {"/tf"},
    "motiondiffuse_client": {
        *("/clock", "/motiondiffuse/text", "/motiondiffuse/request", "/motiondiffuse/plan"),
        *("/motiondiffuse/joint_trajectory", "/motiondiffuse/root_trajectory"),
        "/motiondiffuse/reference",
    },
}
"""What a node has only with some parameter or use."""

Names = dict[str, set[str]]


def allowed(profile: ElementTree.Element) -> Names:
    """Return the names of a profile by what may be done with them; actions as their parts."""
    names: Names = defaultdict(set)
    for group in profile:
        for what, permission in group.attrib.items():
            assert permission == "ALLOW"
            names[what] |= {(child.text or "").strip() for child in group}
    for action in names.pop("execute", ()):
        names["publish"] |= {f"{action}/_action/{t}" for t in ("feedback", "status")}
        names["reply"] |= {
            f"{action}/_action/{s}" for s in ("cancel_goal", "get_result", "send_goal")
        }
    for action in names.pop("call", ()):
        names["subscribe"] |= {f"{action}/_action/{t}" for t in ("feedback", "status")}
        names["request"] |= {
            f"{action}/_action/{s}" for s in ("cancel_goal", "get_result", "send_goal")
        }
    return names


def used(client: MotionClient, node: str) -> Names:
    """Return what a running node has on the graph, by what it does with it."""
    graph = client.node
    return {
        what: {name for name, _ in found(node, "/")}
        for what, found in (
            ("publish", graph.get_publisher_names_and_types_by_node),
            ("subscribe", graph.get_subscriber_names_and_types_by_node),
            ("reply", graph.get_service_names_and_types_by_node),
            ("request", graph.get_client_names_and_types_by_node),
        )
    }


@pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)
def test_the_policy_fits_the_running_nodes(graph):
    root = ElementTree.parse(POLICY).getroot()
    assert (root.tag, root.attrib) == ("policy", {"version": "0.2.0"})
    profiles = {p.attrib["node"]: allowed(p) for p in root.iter("profile")}
    assert set(profiles) == {*ON_DEMAND, "motiondiffuse_operator"}
    with (
        running("motiondiffuse_ros.ros.node", ros_arguments(**FAST), graph / "node.log"),
        running("motiondiffuse_ros.ros.sim_node", [], graph / "sim.log"),
        MotionClient() as client,
    ):
        client.wait_for_node(START)
        for node, optional in ON_DEMAND.items():
            granted = profiles[node]

            def fits(node: str = node, granted: Names = granted, optional: set = optional) -> bool:
                return all(
                    granted.get(what, set()) - optional <= names <= granted.get(what, set())
                    for what, names in used(client, node).items()
                )

            # names of other processes come one by one
            client.wait(fits, 20.0, f"a policy for {node} that is {used(client, node)}")
    operator = profiles["motiondiffuse_operator"]
    assert operator["request"] <= profiles["motiondiffuse"]["reply"]
    assert not operator["publish"] & profiles["motiondiffuse"]["subscribe"] - {"/parameter_events"}
