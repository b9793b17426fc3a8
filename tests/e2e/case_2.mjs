// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Case study 2, fast and short: the fault, the trip and the breakers on the diagram, live; then the same from the recording.
import { check, check_accessible, check_graph, look, open, shot, start, until, until_drawn } from "./harness.mjs";

/** What one sees who opens the address and does nothing. */
async function opens_at_its_first_event(url) {
  for (const [name, theme, viewport] of [["case_2_opened_light", "light"], ["case_2_opened_dark", "dark"], ["case_2_opened_phone", "light", { width: 390, height: 844 }]]) {
    const page = await open(url, theme, viewport);
    await until(page, () => /at=0\.5&|at=0\.5$/.test(location.hash) && /t0=/.test(location.hash));
    await page.waitForSelector(".oneline .fault");
    await page.waitForSelector("p.verdict >> text=of 14 expectations failed"); // they are about a fault at 5.5 s
    await page.waitForSelector('.panel.verdict >> text=12.78 .. 13.18');
    await until_drawn(page, ".plot", 4);
    await page.waitForSelector(".messages .first");
    check(`${name}: it opens at the fault, with the verdict, values and bands, and GOOSE by message`, true);
    await check_accessible(page, name);
    await shot(page, name);
    await page.close();
  }
}

export async function case_2() {
  // Slow enough that a page sees the breakers open while the run is under way.
  const run = await start("configs/scenarios/protection_lockstep.yaml", "--set", "events.fault.at_s=0.5", "--set", "simulation.duration_s=1", "--set", "clock.speed=0.02");
  const live = await open(run.url, "light");
  await check_graph(live, ["sim", "mu21", "mu22", "relay2", "breaker2"], ["TL_21", "TL_22", "TL2_Trip"], ["SMV21", "SMV22", "TRIP2"]);
  await until(live, () => document.querySelectorAll(".breaker.closed").length === 6);
  check("all breakers are closed on the one-line diagram", true);
  await until(live, () => document.querySelectorAll(".breaker.opened").length === 2);
  const open_ones = await live.evaluate(() => [...document.querySelectorAll(".breaker.opened")].map(b => b.textContent.slice(0, 3)).sort().join());
  check("CB3 and CB4 open on the one-line diagram while the run runs", open_ones === "CB3,CB4", open_ones);
  const first = await live.evaluate(() => document.querySelector('.plot select[aria-label="signals of this plot"]').value);
  check("the first plot shows the faulted line", /TL2|CT2[12]/.test(first), first);
  await until_drawn(live, ".plot", 4);
  check("its three phases are drawn", true);
  await live.waitForSelector(".panel.verdict >> text=holds so far");
  await live.waitForSelector(".panel.verdict >> text=By what is recorded up to");
  check("expectations have values and stand so or so while the run runs", /\d/.test(await live.evaluate(() => [...document.querySelectorAll(".panel.verdict td.number")].map(c => c.textContent).join(" "))));
  await shot(live, "case_2_live_light");
  const code = await run.ended;
  check("the run ends as it should", code === 0 || code === 1, code); // its expectations are about a fault at 5.5 s
  await live.close();

  const recorded = await look(run.folder);
  await opens_at_its_first_event(recorded.url);
  const again = await open(`${recorded.url}/#at=0.49`, "dark");
  await again.waitForSelector(".transport");
  await until(again, () => document.querySelectorAll(".breaker.closed").length === 6);
  check("before the fault all breakers are closed", (await again.locator(".oneline .fault").count()) === 0);
  await again.click('[aria-label="to the next event"]');
  await again.waitForSelector(".oneline .fault");
  check("the next event is the fault, and the diagram shows it", true);
  await again.fill('[aria-label="instant"]', "0.9");
  await until(again, () => document.querySelectorAll(".breaker.opened").length === 2);
  check("later CB3 and CB4 are open", true);
  await again.waitForSelector('section[aria-label="Wire timing"] >> text=SMV21');
  check("the wire panel lists the streams", true);
  await shot(again, "case_2_recorded_dark");
  // One axis of time for all events; a click shows the moment everywhere.
  const trip = again.locator('.timeline .mark[aria-label*="trip"]').first();
  await trip.focus();
  await again.keyboard.press("Enter");
  await until(again, () => /at=0\.50/.test(location.hash) && /t0=/.test(location.hash));
  check("an event of the timeline, chosen by the keyboard, becomes the moment that everything shows", true);
  await until(again, () => document.querySelector(".plot canvas") !== null);
  await shot(again, "case_2_trip_dark");
  await again.close();
  const light = await open(`${recorded.url}/#at=0.51&t0=0.49&t1=0.53`, "light");
  await light.waitForSelector(".plot canvas");
  await until(light, () => document.querySelectorAll(".breaker.opened").length === 0 && document.querySelectorAll(".oneline .fault").length > 0);
  await shot(light, "case_2_trip_light");
  await light.close();
}
