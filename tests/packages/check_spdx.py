#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard input is a document of SPDX 2.3 as its JSON schema and its clauses on relationships want it. With --schema FILE also by the
schema of the specification (https://github.com/spdx/spdx-spec, schemas/spdx-schema.json of 2.3); it is not part of this tree."""
import argparse
import json
import re
import sys

REQUIRED = {"spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo", "packages", "relationships"}
OF_PACKAGE = {"SPDXID", "name", "downloadLocation", "filesAnalyzed", "versionInfo"}


def findings(document):
    """What is wrong, as sentences."""
    yield from (f"{key} is missing" for key in sorted(REQUIRED - document.keys()))
    if document.get("spdxVersion") != "SPDX-2.3" or document.get("dataLicense") != "CC0-1.0":
        yield "it is not SPDX-2.3 under CC0-1.0"
    if not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document.get("creationInfo", {}).get("created", "")):
        yield "creationInfo.created is no instant in UTC"
    identifiers = [p.get("SPDXID", "") for p in document.get("packages", [])]
    yield from (f"{i} stands twice" for i in sorted({i for i in identifiers if identifiers.count(i) > 1}))
    for package in document.get("packages", []):
        yield from (f"{package.get('name')}: {key} is missing" for key in sorted(OF_PACKAGE - package.keys()))
        if not re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package.get("SPDXID", "")):
            yield f"{package.get('SPDXID')} is no identifier"
    explained = {licence["licenseId"] for licence in document.get("hasExtractedLicensingInfos", [])}
    for package in document.get("packages", []):
        used = set(re.findall(r"LicenseRef-[A-Za-z0-9.-]+", package.get("licenseDeclared", "")))
        yield from (f"{package.get('name')}: {one} is said and not explained" for one in sorted(used - explained))
    known = {*identifiers, document.get("SPDXID")}
    for relation in document.get("relationships", []):
        yield from (f"{relation[end]} is related and not there" for end in ("spdxElementId", "relatedSpdxElement") if relation[end] not in known)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--schema")
    arguments = parser.parse_args()
    document = json.load(sys.stdin)
    found = list(findings(document))
    if arguments.schema:
        import jsonschema

        with open(arguments.schema, encoding="utf-8") as schema:
            found += [f"{'/'.join(map(str, e.path))}: {e.message}" for e in jsonschema.Draft7Validator(json.load(schema)).iter_errors(document)]
    broken = dict(document, packages=document.get("packages", [])[1:])  # the check can fail
    if not list(findings(broken)):
        found.append("a document without its first package was not found wrong")
    print("\n".join(found), end="\n" if found else "")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
