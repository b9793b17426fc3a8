// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The reports of finished runs, as a user opens them from the disk.
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { check, check_accessible, check_diagram, look, open, picture, run_to_end, shot, start, until, until_drawn } from "./harness.mjs";

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
    await check_diagram(page, `${name}, ${look_}`);
    await shot(page, `${name}_${look_}`);
    await page.close();
  }
}

/** Powers of lines, made of the currents of transformers and voltages of buses, against those that the simulator tells of its own solution. */
async function flows(folder) {
  const page = await open(`${(await look(folder)).url}/#at=5.3`, "light", { width: 1440, height: 1500 });
  await check_diagram(page, "the dashboard");
  await until(page, () => /\d/.test(document.querySelector('.flows tr[data-branch="TL2"] .p')?.textContent ?? ""));
  const shown = await page.evaluate(() => Object.fromEntries([...document.querySelectorAll(".flows tr[data-branch]")].map(r => [r.dataset.branch, [".p", ".q"].map(c => Number(r.querySelector(c).textContent))])));
  await page.close();
  const told = await run_to_end("configs/scenarios/protection_lockstep.yaml", "--set", 'record.signals=["line.*.from.p_kw","line.*.from.q_kvar"]', "--set", "simulation.duration_s=5.3",
    "--set", "expect=~", "--set", "report=~", "--set", "events=~", "--set", "processes.monitor=~");
  const { url, child } = await look(told.folder);
  for (const line of ["TL1", "TL2", "TL3"]) {
    const names = ["p_kw", "q_kvar"].map(q => `line.${line}.from.${q}`);
    let series = [];
    for (const end = Date.now() + 60_000; (series.length < 2 || series.some(s => !s.v.length)) && Date.now() < end; ) // it may still be read
      series = (await (await fetch(`${url}/api/v1/signals/query?names=${names}&t0=5.28&t1=5.3&px=4000`)).json()).series ?? [];
    const mean = series.map(s => s.v.reduce((a, b) => a + b, 0) / s.v.length);
    check(`P and Q of ${line} are the simulator's own`, mean.length === 2 && mean.every((v, k) => Math.abs(v - shown[line][k]) < 0.02 * Math.hypot(...mean) + 0.006), `${shown[line]} and ${mean}`);
  }
  child.kill("SIGTERM");
}

export async function reports() {
  const day = await finished("configs/scenarios/ev_charging.yaml");
  const report = await open(day.page, "light", { width: 1000, height: 1900 });
  await report.waitForSelector("svg");
  await picture(report, "ev_charging_report");
  await report.close();
  await on_every_page("report_case_1", day.page, page => page.waitForSelector("svg"));

  const fault = await finished("configs/scenarios/protection_lockstep.yaml");
  await on_every_page("report_case_2", fault.page, async page => {
    const seen = await page.evaluate(() => [".breaker.opened", ".fault", ".relay"].map(c => [...document.querySelectorAll(`#one_line ${c}`)].map(e => e.dataset.name).sort().join()));
    check("its diagram shows the open breakers, the fault, and the relay at both transformers", seen.join(" ") === "CB3,CB4 fault relay2,relay2", seen.join(" "));
  });
  await flows(fault.folder);
  const dashboard = await open((await look(fault.folder)).url, "light", { width: 1440, height: 1500 });
  await dashboard.waitForSelector("p.verdict >> text=every expectation holds");
  await until(dashboard, () => /t0=/.test(location.hash));
  await dashboard.waitForSelector(".messages .first");
  await until_drawn(dashboard, ".plot", 4);
  await picture(dashboard, "dashboard");
  await dashboard.close();

  // The relay of a bay: zones and measured impedance, curves and points of operation.
  const bays = [
    ["feeder_distance", "#impedance_relay_b", page => picture(page, "feeder_distance_report", "#impedance_relay_b")],
    ["feeder_overcurrent", "#time_current", page => picture(page, "feeder_overcurrent_report", "#time_current")],
  ];
  for (const [scenario, figure, picture_of] of bays) {
    const run = await run_to_end(`configs/scenarios/${scenario}.yaml`);
    check(`${scenario} ends with exit code 0`, run.code === 0, run.code);
    await on_every_page(`report_${scenario}`, pathToFileURL(join(run.folder, "report/index.html")).href, page => page.waitForSelector(`${figure} svg`));
    const page = await open(pathToFileURL(join(run.folder, "report/index.html")).href, "light", { width: 1000, height: 900 });
    await picture_of(page);
    await page.close();
  }

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
