# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace scl import`: a station file becomes a run whose frames are what the file promises, as tshark reads them."""
import json
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as xml

from harness import EXPECTATION, OK, SOURCE, USAGE, ScenarioTest, gridspace

STATION = SOURCE / "configs/scl/small_station.scd"
SCL = "{http://www.iec.ch/61850/2003/SCL}"


def promised():
    """By control block: what the file says of its frames. Read here with another XML parser, without Gridspace."""
    root, out = xml.parse(STATION).getroot(), {}
    for ied in root.iter(SCL + "IED"):
        for device in ied.iter(SCL + "LDevice"):
            for kind, address in (("GSEControl", "GSE"), ("SampledValueControl", "SMV")):
                for control in device.iter(SCL + kind):
                    name, inst = ied.get("name"), device.get("inst")
                    where = next(e for ap in root.iter(SCL + "ConnectedAP") if ap.get("iedName") == name for e in ap.iter(SCL + address)
                                 if e.get("cbName") == control.get("name") and e.get("ldInst") == inst)
                    p = {e.get("type"): e.text for e in where.iter(SCL + "P")}
                    members = len(next(d for d in device.iter(SCL + "DataSet") if d.get("name") == control.get("datSet")))
                    out[control.get("name")] = {
                        "mac": p["MAC-Address"].replace("-", ":").lower(), "appid": int(p["APPID"], 16), "vlan": int(p["VLAN-ID"], 16),
                        "priority": int(p["VLAN-PRIORITY"]), "conf_rev": int(control.get("confRev")), "members": members,
                        "ld": name + inst, "data_set": f"{name}{inst}/LLN0${control.get('datSet')}", "id": control.get("appID") or control.get("smvID")}
    return out


class SclImport(ScenarioTest):
    def imported(self, *arguments, file=STATION, code=OK, name="station.yaml"):
        done = gridspace("scl", "import", file, "--out", self.folder / name, *arguments)
        self.assertEqual(done[0], code, done)
        return self.folder / name, *done[1:]

    def tshark(self, file, filter_, *fields):
        if shutil.which("tshark") is None:
            self.skipTest("tshark is not there")
        command = ["tshark", "-r", str(file), "-Y", filter_, "-T", "fields", "-E", "separator=|", *[w for f in fields for w in ("-e", f)]]
        text = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
        return {tuple(line.split("|")) for line in text.splitlines()}

    def test_a_run_publishes_what_the_file_promises_and_every_subscription_is_alive(self):
        scenario, report, _ = self.imported()
        self.assertIn("IEDs played (3 of 4)", report)
        run = self.run_to_end("run", scenario=scenario)  # its expectations: every stream is heard, and nothing contradicts
        file, wanted = run.folder / "bus.pcapng.gz", promised()
        for block in ("Trip", "Position"):
            w = wanted[block]
            seen = self.tshark(file, f"goose.gocbRef == \"{w['ld']}/LLN0$GO${block}\"", "eth.dst", "vlan.id", "vlan.priority", "goose.appid", "goose.datSet",
                               "goose.goID", "goose.confRev", "goose.numDatSetEntries", "goose.simulation")
            self.assertEqual({(m, int(v), int(p), int(a, 0), d, g, int(c), int(n), s in ("1", "True")) for m, v, p, a, d, g, c, n, s in seen},
                             {(w["mac"], w["vlan"], w["priority"], w["appid"], w["data_set"], w["id"], w["conf_rev"], w["members"], False)})
        w = wanted["MSVCB01"]
        seen = self.tshark(file, "sv", "eth.dst", "vlan.id", "vlan.priority", "sv.appid", "sv.noASDU", "sv.svID", "sv.confRev", "sv.smpSynch")
        self.assertEqual({(m, int(v), int(p), int(a, 0), n) for m, v, p, a, n, *_ in seen}, {(w["mac"], w["vlan"], w["priority"], w["appid"], "2")})
        self.assertEqual({(i, c) for *_, i, c, _ in seen}, {(f"{w['id']},{w['id']}", f"{w['conf_rev']},{w['conf_rev']}")})
        self.assertEqual(self.tshark(file, "_ws.malformed", "frame.number"), set())
        counts = sorted(int(n) for pair in self.tshark(file, "sv", "sv.smpCnt", "frame.number") for n in pair[0].split(","))
        self.assertEqual(len(set(counts)), 4000)  # 80 samples of each of 50 periods: smpCnt comes to its end and begins anew
        self.assertEqual(max(counts), 3999)

    def test_a_publisher_that_is_not_the_one_subscribed_to_is_told(self):  # the control of the expectations above
        scenario, *_ = self.imported()
        run = self.run_to_end("other", ["--set", "streams.OTHER={like: PROT1_Trip, app_id: 0x8022}", "--set", "processes.PROT1.mappings.PROT1_Trip.to.stream=OTHER"],
                              scenario, EXPECTATION)
        failed = {one["name"] for one in json.loads("".join(run.printed))["expectations"] if not one["pass"]}
        self.assertEqual(failed, {"heard_3", "agreed_3"})

    def test_a_change_of_a_value_is_a_new_state_that_the_subscriber_sees(self):
        scenario, *_ = self.imported()
        run = self.run_to_end("changed", ["--set", "processes.BRK1.mappings.BRK1_Position.changes=[{at_s: 0.5, set: {XCBR1_Pos_stVal: open}}]", "--set",
                                          "expect.opens={time_of: subscription.PROT1_in.BRK1_Position.value.XCBR1_Pos_stVal == open, unit: ms, between: [500, 501]}",
                                          "--set", "expect.state={last_of: subscription.PROT1_in.BRK1_Position.st_num, is: 2}"], scenario)
        self.assertTrue((run.folder / "bus.pcapng.gz").exists())

    def test_a_publisher_that_dies_is_lost_to_its_subscribers(self):
        scenario, *_ = self.imported()
        self.run_to_end("dead", ["--set", "events={dies: {at_s: 0.5, kill: MU1}}", "--set", "expect.heard_1=~", "--set",
                                 "expect.lost={time_of: subscription.PROT1_in.MU1_MSVCB01.alive < 0.5, since: dies, unit: ms, between: [0, 10]}"], scenario)

    def test_only_streams_as_before(self):
        code, out, errors = gridspace("scl", "import", STATION, "--streams-only")
        self.assertEqual(code, OK)
        self.assertIn("MU1_MSVCB01:", out)
        self.assertNotIn("processes:", out)
        self.assertIn("small_station.scd:", errors)

    def test_export_of_what_was_imported_is_the_same_file_again(self):
        """What a frame carries stays for good; names of members and of data sets that no frame carries settle with the second turn."""
        scenario, texts = self.imported()[0], []
        for turn in ("once", "twice", "thrice"):
            done = gridspace("scl", "export", scenario)
            self.assertEqual(done[0], OK, done)
            texts.append(re.sub(r'<Header id="\w+"', "<Header", done[1]))
            scenario, *_ = self.imported(file=self.write(turn + ".cid", done[1]), name=turn + ".yaml")
        self.assertEqual(texts[1], texts[2])
        on_the_wire = [re.sub(r' desc="[^"]*"|(?<=DataSet name=)"MU1_\w+"|(?<=datSet=)"MU1_\w+"', "", text) for text in texts[:2]]
        self.assertEqual(*on_the_wire)

    def test_mistakes_are_told_and_nothing_is_written_over(self):
        scenario, *_ = self.imported()
        for arguments, words in [([], "is there already"), (["--overwrite", "--strict"], "2 things were left out"), (["--overwrite", "--ied", "BRK"], "did you mean 'BRK1'?"),
                                 (["--overwrite", "--network", SOURCE / "configs/networks/smib.yaml"], "no `cts` or no `vts`")]:
            self.assertIn(words, self.imported(*arguments, code=USAGE)[2], arguments)
        for text, words in [("<SCL><IED></SCL>", "broken.scd:1:1: not XML"), ("<html/>", "'html', not SCL"), ("<SCL/>", "nothing of the file can be played"),
                            ("<!DOCTYPE a [<!ENTITY b 'c'>]><SCL/>", "broken.scd:1:1: the file has a document type")]:
            broken = self.write("broken.scd", text)
            self.assertIn(words, self.imported(file=broken, code=USAGE, name="broken.yaml")[2], text)
            self.assertFalse((self.folder / "broken.yaml").exists())

    def test_the_report_is_json_too(self):
        report = json.loads(self.imported("--json")[1])
        self.assertEqual([one["processes"] for one in report["ieds"]], [["MU1"], ["PROT1", "PROT1_in"], ["BRK1", "BRK1_in"]])
        self.assertEqual({one["kind"] for one in report["findings"]}, {"assumed", "left_out"})


if __name__ == "__main__":
    unittest.main()
