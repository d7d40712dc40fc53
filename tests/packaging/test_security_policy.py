"""The policy has the form that `ros2 security` takes: that of SROS2's policy schema, 0.2.0."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

POLICY = Path(__file__).parents[2] / "security" / "policies" / "motiondiffuse.policy.xml"

FORM = {
    "policy": ({"version"}, set(), {"enclaves"}),
    "enclaves": (set(), set(), {"enclave"}),
    "enclave": ({"path"}, set(), {"profiles"}),
    "profiles": (set(), {"type"}, {"profile"}),
    "profile": ({"ns", "node"}, set(), {"topics", "services", "actions"}),
    "topics": (set(), {"publish", "subscribe"}, {"topic"}),
    "services": (set(), {"reply", "request"}, {"service"}),
    "actions": (set(), {"call", "execute"}, {"action"}),
}
"""Of each element: attributes it has, attributes it may have, elements of which it holds some."""

EXPRESSIONS = {"topic", "service", "action"}


def faults(element: ElementTree.Element) -> list[str]:
    """Return where an element and what is in it leave the form."""
    tag, given = element.tag, set(element.attrib)
    if tag in EXPRESSIONS:
        text = element.text or ""
        good = not given and len(element) == 0 and text.startswith("/") and text == text.strip()
        return [] if good else [f"{tag} '{text}' {given}"]
    required, optional, children = FORM[tag]
    found = []
    if not required <= given <= required | optional:
        found.append(f"{tag} has the attributes {given}")
    if tag in {"topics", "services", "actions"}:
        found += [f"{tag}: {k}={v}" for k, v in element.items() if v not in {"ALLOW", "DENY"}]
    if len(element) == 0:
        found.append(f"{tag} is empty")
    for child in element:
        found += faults(child) if child.tag in children else [f"{child.tag} in {tag}"]
    return found


def test_the_policy_has_the_form_of_the_schema():
    root = ElementTree.parse(POLICY).getroot()
    assert (root.tag, root.get("version")) == ("policy", "0.2.0")
    assert faults(root) == []
    paths = [enclave.attrib["path"] for enclave in root.iter("enclave")]
    assert len(set(paths)) == len(paths)
    assert all(path.startswith("/") for path in paths)


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ('publish="ALLOW"', 'publish="allow"'),
        ('publish="ALLOW"', 'reply="ALLOW"'),
        ('ns="/" ', ""),
        ("<profiles>", '<profiles mode="x">'),
        ("<topic>/diagnostics</topic>", "<service>/diagnostics</service>"),
        ("<topic>/diagnostics</topic>", "<topic> /diagnostics </topic>"),
    ],
)
def test_other_forms_are_noticed(good, bad):
    text = POLICY.read_text(encoding="utf-8")
    assert good in text
    assert faults(ElementTree.fromstring(text.replace(good, bad, 1))) != []
