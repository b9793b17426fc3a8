# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Under which licence a Debian package is, by its machine-readable copyright file (DEP-5), as an SPDX expression."""
import pathlib
import re

DOCUMENTATION = pathlib.Path("/usr/share/doc")
# Short names of DEP-5 (https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/#license-short-name) that SPDX calls otherwise.
SPDX_NAMES = {"apache-2.0": "Apache-2.0", "expat": "MIT", "mit": "MIT", "x11": "X11", "zlib": "Zlib", "bsd-2-clause": "BSD-2-Clause", "bsd-3-clause": "BSD-3-Clause", "isc": "ISC",
              "boost-1.0": "BSL-1.0", "bsl-1.0": "BSL-1.0", "artistic": "Artistic-1.0-Perl", "cc0-1.0": "CC0-1.0", "python-2.0": "Python-2.0", "mpl-2.0": "MPL-2.0",
              "epl-1.0": "EPL-1.0", "epl-2.0": "EPL-2.0", "curl": "curl", "openssl": "OpenSSL", "public-domain": None}


def spdx_name(short):
    """('GPL-2.0-or-later', None) for 'GPL-2+'; ('LicenseRef-SMU', 'SMU') for what SPDX does not know."""
    if match := re.fullmatch(r"(GPL|LGPL|AGPL|GFDL)-?(\d(?:\.\d)?)(\+?)", short, re.IGNORECASE):
        version = match[2] if "." in match[2] else match[2] + ".0"
        return f"{match[1].upper()}-{version}-{'or-later' if match[3] else 'only'}", None
    if known := SPDX_NAMES.get(short.lower()):
        return known, None
    return "LicenseRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", short), short


def stanzas(text):
    """The paragraphs of the file as {field: value}, continuation lines included."""
    for paragraph in re.split(r"\n\s*\n", text):
        fields = {}
        for line in paragraph.splitlines():
            if match := re.match(r"([A-Za-z-]+):\s*(.*)", line):
                last = match[1].lower()
                fields[last] = match[2]
            elif fields and line[:1] in " \t":
                fields[last] += "\n" + line.strip()
        yield fields


def licence_of(package, folder=DOCUMENTATION):
    """(SPDX expression, {identifier: (name, text)} of the licences that SPDX does not know), of what holds for most files of the package
    ("Files: *"). ('NOASSERTION', {}) where the file is not machine-readable."""
    file = folder / package.partition(":")[0] / "copyright"
    try:
        found = list(stanzas(file.read_text(errors="replace")))
    except OSError:
        return "NOASSERTION", {}
    if not found or "format" not in found[0]:
        return "NOASSERTION", {}
    of_all = next((fields for fields in found if fields.get("files", "").split()[:1] == ["*"] and fields.get("license")), None)
    if of_all is None:
        return "NOASSERTION", {}
    texts = {fields["license"].splitlines()[0].strip(): fields["license"] for fields in found if "\n" in fields.get("license", "")}
    said, unknown = of_all["license"].splitlines()[0].strip(), {}
    words = []
    for word in re.split(r",?\s+(and|or)\s+", said):
        if word in ("and", "or"):
            words.append(word.upper())
            continue
        identifier, name = spdx_name(re.sub(r"\s+", "-", word.strip()))
        if name is not None:
            unknown[identifier] = (word.strip(), texts.get(word.strip()) or texts.get(said) or said)
        words.append(identifier)
    return " ".join(words), unknown
