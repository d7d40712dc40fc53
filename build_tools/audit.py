"""Known vulnerabilities of what is installed, by pip-audit; says so where none could be looked up.

    python build_tools/audit.py PIP_AUDIT SITE_PACKAGES

Exit code 1 if there is one, 2 if no package could be looked up, as on a machine that reaches
nothing but a package mirror: that is not a clean audit.
"""

from __future__ import annotations

import json
import subprocess
import sys


def main(pip_audit: str, site_packages: str) -> int:
    """Audit a folder of packages."""
    command = [pip_audit, "--path", site_packages, "--format", "json", "--progress-spinner", "off"]
    run = subprocess.run(command, capture_output=True, text=True)
    try:
        packages = json.loads(run.stdout)["dependencies"]
    except (ValueError, KeyError):
        print(run.stderr.strip().splitlines()[-1:] or "no answer")
        print("no package could be looked up")
        return 2
    known = [package for package in packages if "skip_reason" not in package]
    found = [(p["name"], p["version"], v) for p in known for v in p.get("vulns", ())]
    for name, version, vulnerability in found:
        fixed = ", ".join(vulnerability["fix_versions"]) or "none"
        print(f"{name} {version}: {vulnerability['id']}, fixed in {fixed}")
    print(f"{len(known)} of {len(packages)} packages looked up, {len(found)} vulnerabilities")
    if not known:
        print("the vulnerability service was not reached: this says nothing about the packages")
        return 2
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
