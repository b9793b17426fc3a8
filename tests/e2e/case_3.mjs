// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Case study 3: verdicts, alarm and forged samples, live and from the recording.
import { check, check_graph, look, open, shot, start, until, until_drawn } from "./harness.mjs";

const cell = (page, stream, column) => page.evaluate(([s, c]) => {
  const row = [...document.querySelectorAll('section[aria-label="detector of relay2"] tbody tr')].find(r => r.cells[0].textContent.startsWith(s));
  return row?.cells[c].textContent ?? "";
}, [stream, column]);

async function check_verdicts(page, when) {
  await page.waitForSelector('section[aria-label="Intrusion detection"] >> text=relay2');
  await until(page, () => {
    const rows = [...document.querySelectorAll('section[aria-label="detector of relay2"] tbody tr')];
    return rows.length === 2 && Number(rows[0].cells[6].textContent) >= 5 && rows[0].cells[7].textContent.includes("%");
  });
  check(`${when}: the detector has judged samples of both streams`, Number((await cell(page, "SMV22", 1)).replace(/,/g, "")) > 100, await cell(page, "SMV22", 1));
  check(`${when}: SMV21 is the forged stream`, Number(await cell(page, "SMV21", 6)) > 0 && Number(await cell(page, "SMV22", 6)) === 0, await cell(page, "SMV22", 6));
  const detected = parseFloat(await cell(page, "SMV21", 7));
  check(`${when}: most fakes are detected`, detected >= 90, detected);
  const share = parseFloat(await cell(page, "SMV21", 5));
  check(`${when}: the share of false positives of the open loop is told`, share >= 0 && share < 5, share);
}

export async function case_3() {
  const run = await start("configs/scenarios/fdi_ids_short.yaml", "--set", "clock.speed=0.04");
  const live = await open(run.url, "light");
  await check_graph(live, ["sim", "mu21", "mu22", "relay2", "breaker2", "attacker"], ["ids_verdicts", "attack_labels"], ["SMV21", "SMV22", "TRIP2"]);
  await check_verdicts(live, "live");
  await until(live, () => document.querySelector('section[aria-label="detector of relay2"] [role="status"]')?.textContent.length > 0);
  await until_drawn(live, ".ids", 4);
  check("live: received, forecast and accepted waveforms are drawn", true);
  await shot(live, "case_3_live_light");
  await run.ended;
  await live.close();

  const recorded = await look(run.folder);
  const page = await open(recorded.url, "dark");
  await page.waitForSelector(".transport");
  await until(page, () => /at=/.test(location.hash));
  await page.focus('[aria-label="instant"]');
  await page.keyboard.press("End");
  await check_verdicts(page, "recorded");
  check("recorded: all 40 fakes are counted", Number(await cell(page, "SMV21", 6)) === 40, await cell(page, "SMV21", 6));
  await page.waitForSelector('.timeline .mark.alarm, .timeline .mark.fault');
  await page.click('[aria-label="to the next flagged sample"]');
  await until(page, () => /t0=/.test(location.hash));
  check("a flagged sample is shown closely", true);
  await page.waitForTimeout(600); // for the picture alone
  await shot(page, "case_3_recorded_dark");
  await page.close();
  const light = await open(`${recorded.url}/#${"ids=relay2.SMV21.a"}`, "light");
  await light.waitForSelector(".ids canvas");
  await light.click('[aria-label="to the flagged sample before"]');
  await light.waitForTimeout(600);
  await light.locator(".ids").scrollIntoViewIfNeeded();
  await shot(light, "case_3_recorded_light");
  await light.close();
}
