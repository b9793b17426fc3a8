#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What the packages are made of, as SPDX 2.3 JSON (https://spdx.github.io/spdx-spec/v2.3/): each package with its sum, the Debian packages that
it depends on, the npm packages that are in the dashboard.

  scripts/sbom.py FOLDER_OF_PACKAGES > gridspace.spdx.json
"""
import hashlib
import json
import pathlib
import re
import subprocess
import sys

from debian_licence import licence_of

ROOT = pathlib.Path(__file__).resolve().parents[1]
NAMESPACE = "https://example.org/gridspace/spdx"


def identifier(kind, name, version):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", f"{kind}-{name}-{version}")


def field(deb, name):
    return subprocess.run(["dpkg-deb", "-f", deb, name], capture_output=True, text=True, check=True).stdout.strip()


def of_deb(deb):
    name, version, arch = (field(deb, f) for f in ("Package", "Version", "Architecture"))
    entry = {"SPDXID": identifier("Package", name, version), "name": name, "versionInfo": version, "packageFileName": deb.name, "filesAnalyzed": False,
             "downloadLocation": "NOASSERTION", "licenseConcluded": "Apache-2.0", "licenseDeclared": "Apache-2.0", "copyrightText": "2026 Gridspace contributors",
             "checksums": [{"algorithm": "SHA256", "checksumValue": hashlib.sha256(deb.read_bytes()).hexdigest()}],
             "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": f"pkg:deb/gridspace/{name}@{version}?arch={arch}"}]}
    return entry, [re.sub(r"[ (:|].*", "", d.strip()) for d in field(deb, "Depends").split(",") if d.strip()]


def other(kind, name, version, licence="NOASSERTION"):
    purl = f"pkg:npm/{name}@{version}" if kind == "npm" else f"pkg:deb/debian/{name}@{version}"
    return {"SPDXID": identifier(kind, name, version), "name": name, "versionInfo": version, "filesAnalyzed": False, "downloadLocation": "NOASSERTION",
            "licenseConcluded": "NOASSERTION", "licenseDeclared": licence, "copyrightText": "NOASSERTION",
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": purl}]}


def installed_version(package):
    asked = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True, check=False)
    return asked.stdout.strip() or "NOASSERTION"


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/packages")
    debs = sorted(folder.glob("*.deb"))
    if not debs:
        sys.exit(f"error: no package is in {folder}\n  ./gridspace package makes them")
    packages, relations, licences, ours = {}, [], {}, [of_deb(deb) for deb in debs]
    by_name = {entry["name"]: entry["SPDXID"] for entry, _ in ours}
    for entry, depends in ours:
        packages[entry["SPDXID"]] = entry
        relations.append(("SPDXRef-DOCUMENT", "DESCRIBES", entry["SPDXID"]))
        for name in depends:
            if name not in by_name:
                licence, not_of_spdx = licence_of(name)
                licences |= not_of_spdx
                needed = other("deb", name, installed_version(name), licence)
                packages[needed["SPDXID"]] = needed
            relations.append((entry["SPDXID"], "DEPENDS_ON", by_name.get(name) or needed["SPDXID"]))
    lock = json.loads((ROOT / "monitor/dashboard/package-lock.json").read_text())["packages"]
    for path, data in lock.items():
        if path and not data.get("dev") and "gridspace" in by_name:
            part = other("npm", path.rpartition("node_modules/")[2], data["version"], data.get("license", "NOASSERTION"))
            packages[part["SPDXID"]] = part
            relations.append((by_name["gridspace"], "CONTAINS", part["SPDXID"]))
    commit_time = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%cd", "--date=format-local:%Y-%m-%dT%H:%M:%SZ"], env={"TZ": "UTC", "PATH": "/usr/bin:/bin"},
                                 capture_output=True, text=True, check=False).stdout.strip()
    sums = hashlib.sha256("".join(sorted(packages)).encode()).hexdigest()[:16]
    print(json.dumps({"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "gridspace",
                      "documentNamespace": f"{NAMESPACE}/{sums}",
                      "creationInfo": {"created": commit_time or "1970-01-01T00:00:00Z", "creators": ["Tool: gridspace-sbom"]},
                      "packages": [packages[key] for key in sorted(packages)],
                      "hasExtractedLicensingInfos": [{"licenseId": key, "name": licences[key][0], "extractedText": licences[key][1]} for key in sorted(licences)],
                      "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}, indent=1))


if __name__ == "__main__":
    main()
