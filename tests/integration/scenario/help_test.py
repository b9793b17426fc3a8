#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Help: an example first, options by group, on one screen."""
import re
import unittest

from harness import OK, USAGE, gridspace

SCREEN = 40  # lines


def help_of(*path):
    code, out, err = gridspace(*path, "--help")
    assert (code, err) == (OK, ""), (path, err)
    return out


def verbs_below(*path):
    """Verbs that do something, each as a tuple of words."""
    names = re.findall(r"^  ([a-z][a-z-]*) {2,}\S", help_of(*path).partition("Usage:")[2], re.M)
    for name in names:
        yield from verbs_below(*path, name)
    if not names:
        yield path


class Help(unittest.TestCase):
    def test_every_verb_shows_an_example_before_its_options_and_fits_a_screen(self):
        verbs = list(verbs_below())
        self.assertGreater(len(verbs), 35)
        self.assertIn(("wire", "sv-pub"), verbs)
        for verb in verbs:
            with self.subTest(verb):
                text = help_of(*verb)
                first = text.partition("Usage:")[0]
                self.assertRegex(first, rf"(?m)^    (source <\()?gridspace {' '.join(verb)}\b")
                self.assertLessEqual(len(text.splitlines()), SCREEN)
                self.assertNotIn("\n\n\n", text)

    def test_options_are_in_groups_and_say_what_they_take(self):
        text = help_of("run")
        self.assertRegex(text, r"Change the scenario:\n  --set TEXT +override")
        self.assertRegex(text, r"Look into it:\n(.*\n)*  --log-level \{debug,info,warning,error\}")
        self.assertNotIn("REQUIRED", text)

    def test_who_types_nothing_is_shown_a_first_command(self):
        code, out, err = gridspace()
        self.assertEqual((code, out), (USAGE, ""))
        self.assertIn("gridspace run configs/scenarios/ev_charging.yaml", err)
        self.assertLessEqual(len(err.splitlines()), 20)


if __name__ == "__main__":
    unittest.main()
