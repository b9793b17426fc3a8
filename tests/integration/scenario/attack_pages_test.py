# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/reference/attacks: each kind has a page, each recipe is one that the program takes, and what a page says came of it is what
its scenario expects. The scenarios themselves are run by the tiers of scenarios."""
import json
import re
import unittest

from harness import OK, SOURCE, gridspace

FOLDER = SOURCE / "docs/reference/attacks"
ROW = re.compile(r"^\| ([^|]+?) \| (.*) \|$", re.M)
EXPECTED = {"trips lost": "trips_lost", "trips without a fault": "trips_false"}


def pages():
    return [page for page in sorted(FOLDER.glob("*.md")) if page.stem != "index"]


def rows(page):
    return dict(ROW.findall(page.read_text()))


def scenario_of(page):
    return (page.parent / re.search(r"\]\(([^)]+\.yaml)\)", rows(page)["scenario"]).group(1)).resolve()


def words(source, table):
    """The first words of a table of kinds in a source file."""
    text = (SOURCE / source).read_text()
    return re.findall(r'\{"(\w+)",', text[text.index(table):].split("};", 1)[0])


class AttackPages(unittest.TestCase):
    def test_each_kind_has_a_page(self):
        config = "agents/attacker/attack_config.cpp"
        kinds = words(config, "kGooseKinds") + words(config, "kFrameKinds")
        self.assertGreater(len(kinds), 14)
        recipes = " ".join(rows(page)["recipe"] for page in pages())
        for kind in kinds:
            self.assertIn(f"kind: {kind}", recipes)
        values = re.findall(r'is\("(\w+)", Kind::', (SOURCE / config).read_text())
        self.assertGreater(len(values), 8)
        for value in values:
            self.assertIn(f"{value}:", recipes)
        for action in ("kill", "pause", "restart"):
            self.assertIn(f"{action}: ", recipes)

    def test_the_index_names_all_of_them(self):
        index = (FOLDER / "index.md").read_text()
        for page in pages():
            self.assertIn(f"]({page.name}) | {rows(page)['recipe']} |", index, page.name)

    def test_each_recipe_stands_in_the_scenario_of_its_page(self):
        for page in pages():
            recipe = re.sub(r"\s", "", rows(page)["recipe"].strip("`"))
            text = re.sub(r"\s", "", scenario_of(page).read_text())
            self.assertIn(recipe, text, page.name)

    def test_each_scenario_is_valid_and_run_by_a_tier(self):
        plans = json.loads((SOURCE / "tests/scenarios/scenarios.json").read_text())
        for page in pages():
            scenario = scenario_of(page)
            self.assertEqual(plans[scenario.stem]["exit"], 0, page.name)
            code, said, wrong = gridspace("validate", scenario, timeout=60)
            self.assertEqual(code, OK, said + wrong)

    def test_what_a_page_says_is_what_its_scenario_expects(self):
        said = 0
        for page in pages():
            text = scenario_of(page).read_text()
            for name, signal in EXPECTED.items():
                if name in rows(page):
                    number = re.match(r"\d+", rows(page)[name]).group()
                    self.assertRegex(text, rf"last_of: consequence\.{signal}, is: {number}}}", page.name)
                    said += 1
        self.assertGreater(said, 40)


if __name__ == "__main__":
    unittest.main()
