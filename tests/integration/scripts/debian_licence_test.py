#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""scripts/debian_licence.py: SPDX expressions of copyright files as Debian packages have them."""
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, os.environ["GRIDSPACE_SOURCE_DIR"] + "/scripts")
from debian_licence import licence_of  # noqa: E402

FORMAT = "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: x\n"


class DebianLicence(unittest.TestCase):
    def licence(self, text):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "libx1", "copyright")
            file.parent.mkdir()
            file.write_text(text)
            return licence_of("libx1:amd64", pathlib.Path(folder))

    def test_takes_the_licence_of_most_files_and_not_that_of_others(self):
        text = FORMAT + "\nFiles: debian/*\nCopyright: d\nLicense: GPL-2+\n\nFiles: *\nCopyright: a\nLicense: Expat\n Permission is granted.\n"
        self.assertEqual(self.licence(text), ("MIT", {}))

    def test_writes_choices_and_versions_as_spdx_does(self):
        for said, expected in (("GPL-2+ or BSD-3-clause", "GPL-2.0-or-later OR BSD-3-Clause"), ("LGPL-2.1", "LGPL-2.1-only"), ("Apache-2.0 and Zlib", "Apache-2.0 AND Zlib")):
            self.assertEqual(self.licence(f"{FORMAT}\nFiles: *\nCopyright: a\nLicense: {said}\n")[0], expected)

    def test_gives_the_text_of_what_spdx_does_not_know(self):
        text = FORMAT + "\nFiles: *\nCopyright: a\nLicense: SMU\n\nLicense: SMU\n Do what you like.\n"
        self.assertEqual(self.licence(text), ("LicenseRef-SMU", {"LicenseRef-SMU": ("SMU", "SMU\nDo what you like.")}))

    def test_asserts_nothing_where_a_person_has_to_read(self):
        self.assertEqual(self.licence("This is the Debian prepackaged version of x.\nLicense: GPL\n"), ("NOASSERTION", {}))
        self.assertEqual(self.licence(FORMAT), ("NOASSERTION", {}))
        self.assertEqual(licence_of("is-not-installed"), ("NOASSERTION", {}))


if __name__ == "__main__":
    unittest.main()
