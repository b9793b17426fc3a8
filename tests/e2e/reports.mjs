// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The reports of finished runs, as a user opens them from the disk.
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { check, check_accessible, look, open, picture, shot, start, until, until_drawn } from "./harness.mjs";

const kPages = [["light", "light"], ["dark", "dark"], ["phone", "light", { width: 390, height: 844 }], ["phone_dark", "dark", { width: 390, height: 844 }]];

async function finished(scenario, ...more) {
  const run = await start(scenario, ...more);
  const code = await run.ended;
  check(`${scenario} ends with exit code 0`, code === 0, code);
  return { folder: run.folder, page: pathToFileURL(join(run.folder, "report/index.html")).href };
}

async function on_every_page(name, url, ready) {
  for (const [look_, theme, viewport] of kPages) {
    const page = await open(url, theme, viewport);
    await ready(page);
    await check_accessible(page, `${name}, ${look_}`);
    await shot(page, `${name}_${look_}`);
    await page.close();
  }
}

export async function reports() {
  const day = await finished("configs/scenarios/ev_charging.yaml");
  const report = await open(day.page, "light", { width: 1000, height: 1900 });
  await report.waitForSelector("svg");
  await picture(report, "ev_charging_report");
  await report.close();
  await on_every_page("report_case_1", day.page, page => page.waitForSelector("svg"));

  const fault = await finished("configs/scenarios/protection_lockstep.yaml");
  const dashboard = await open((await look(fault.folder)).url, "light", { width: 1440, height: 1500 });
  await dashboard.waitForSelector("p.verdict >> text=every expectation holds");
  await until(dashboard, () => /t0=/.test(location.hash));
  await dashboard.waitForSelector(".messages .first");
  await until_drawn(dashboard, ".plot", 4);
  await picture(dashboard, "dashboard");
  await dashboard.close();

  // Relays with percentage restraint beside a fault on the line of another.
  const lines = await finished("configs/scenarios/protection_three_lines.yaml");
  await on_every_page("report_three_lines", lines.page, page => page.waitForSelector('svg[aria-label^="Differential over restraint"]'));
  const recorded = await look(lines.folder);
  for (const [look_, theme, viewport] of kPages) {
    const page = await open(`${recorded.url}/#relay=relay2`, theme, viewport);
    await page.waitForSelector('.plane[aria-label^="differential over restraint current"] .phase');
    const away = await page.evaluate(() => document.querySelectorAll(".plane .digital").length);
    check("the relay view shows pickup, trip and two breakers that open", away === 4, away);
    await page.selectOption('[aria-label="relay"]', "relay1");
    await until(page, () => document.querySelectorAll(".plane .digital").length === 0 && document.querySelectorAll(".plane .characteristic").length === 1);
    check("and of a relay beside the fault neither", true);
    await page.selectOption('[aria-label="relay"]', "relay2");
    await page.waitForSelector(".plane .digital");
    await check_accessible(page, `the relay view, ${look_}`);
    await shot(page, `relay_view_${look_}`);
    if (look_ === "light") await picture(page, "relay_view", ".panel.relay");
    await page.close();
  }
}
