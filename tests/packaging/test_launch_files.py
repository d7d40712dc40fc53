"""Launch files start what exists, with parameters that the nodes have."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from motiondiffuse_ros.ros.parameters import PLANNER_PARAMETERS
from motiondiffuse_ros.ros.sim_parameters import SIM_PARAMETERS

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "launch").glob("*.launch.xml"))
PARAMETERS = {"motiondiffuse_node": PLANNER_PARAMETERS, "motiondiffuse_sim": SIM_PARAMETERS}


def tree(file: Path) -> ET.Element:
    return ET.parse(file).getroot()


def test_there_is_one_for_the_node_the_demo_and_the_g1():
    stems = {file.name.partition(".")[0] for file in FILES}
    assert stems == {"motiondiffuse", "demo", "g1"}


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.name)
def test_every_node_is_an_installed_executable_with_declared_parameters(file):
    nodes = list(tree(file).iter("node"))
    assert nodes
    for node in nodes:
        assert node.get("pkg") == "motiondiffuse_ros"
        executable = node.attrib["exec"]
        script = ROOT / "scripts" / executable
        assert script.is_file()
        assert script.stat().st_mode & 0o111
        for parameter in node.iter("param"):
            assert parameter.attrib["name"] in PARAMETERS[executable]


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.name)
def test_every_variable_is_a_declared_argument_with_a_description(file):
    arguments = tree(file).findall("arg")
    assert all(a.get("description") for a in arguments)
    used = set(re.findall(r"\$\(var (\w+)\)", file.read_text()))
    assert used == {a.attrib["name"] for a in arguments}


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.name)
def test_included_files_exist_and_declare_what_they_are_given(file):
    for include in tree(file).iter("include"):
        name = include.attrib["file"].rpartition("/")[2]
        declared = {a.attrib["name"] for a in tree(ROOT / "launch" / name).findall("arg")}
        assert {a.attrib["name"] for a in include.findall("arg")} <= declared


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.name)
def test_launch_itself_reads_them(file):
    frontend = pytest.importorskip("launch.frontend", reason="launch is not among the ROS wheels")
    pytest.importorskip("launch_ros")
    entity, parser = frontend.Parser.load(str(file))
    assert parser.parse_description(entity).entities
