// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Case study 1, live: graph, one-line diagram, waveforms, drawer, address, run control, a killed agent.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { check, check_accessible, check_graph, errors, figure, open, pid_of, shot, start, until, until_drawn } from "./harness.mjs";

export async function case_1() {
  const run = await start("configs/scenarios/ev_charging.yaml", "--set", "clock.speed=150", "--allow-control");
  const page = await open(run.url, "light");
  await page.waitForSelector("text=8 of 8 alive");
  const paint = await page.evaluate(() => performance.getEntriesByType("paint").find(p => p.name === "first-contentful-paint")?.startTime);
  figure("first contentful paint on localhost, case 1", `${paint?.toFixed(0)} ms`);
  await check_graph(page, ["sim", "ev1", "ev2", "ev3", "ev4", "mcca"], ["bus_measurements", "requests", "decisions"]);
  for (const bus of ["B1", "B2", "B3", "B4"]) {
    await until(page, b => [...document.querySelectorAll(".bus")].some(n => new RegExp(`${b} [01]\\.\\d{3}`).test(n.textContent)), bus);
    check(`the one-line diagram shows the voltage of ${bus}`, true);
  }
  await page.waitForSelector(".plot canvas");
  await until_drawn(page, ".plot", 4);
  check("the waveforms are drawn in several colours", true);
  await shot(page, "case_1_live_light");
  await page.locator('.node.topic text:text-is("requests")').locator("..").focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".drawer >> text=ChargingRequest");
  await page.waitForSelector(".drawer >> text=current_a");
  check("a topic opened by the keyboard shows its newest samples and its IDL", true);
  await shot(page, "case_1_topic", false);
  await page.keyboard.press("Escape");
  await page.fill('input[type="search"]', "mcca");
  await until(page, () => location.hash.includes("find=mcca"));
  check("the address remembers what was chosen", true);
  const dark = await open(await page.evaluate(() => location.href), "dark");
  await dark.waitForSelector(".node.found");
  await dark.waitForSelector(".plot canvas");
  await shot(dark, "case_1_live_dark");
  check("another page at that address shows the same, in the dark", true);
  await check_accessible(dark, "case 1, live, dark");
  await dark.close();
  const phone = await open(run.url, "light", { width: 390, height: 844 });
  await phone.waitForSelector(".plot canvas");
  await check_accessible(phone, "case 1, live, on a phone");
  await shot(phone, "case_1_narrow");
  await phone.close();

  const secret = readFileSync(join(run.folder, "control.token"), "utf8").trim();
  page.on("dialog", d => void d.accept(d.type() === "prompt" ? "not the token" : undefined).catch(() => {}));
  await page.click('button:has-text("pause")');
  await page.waitForSelector('[role="alert"] >> text=token');
  check("a wrong token is refused, and the page says so", true);
  errors.splice(0, errors.length, ...errors.filter(e => !/401/.test(e))); // the browser logs the refusal
  await page.evaluate(t => sessionStorage.setItem("gridspace control token", t), secret);
  await page.click('button:has-text("pause")');
  await page.waitForSelector("text=continue");
  // The log says where the run is halted; the clock is not published at ticks that nobody needs.
  const halts = () => page.evaluate(async () => (await (await fetch("/api/v1/events")).json()).events.filter(e => e.event === "paused").map(e => e.time_s));
  const [halted] = await halts();
  await page.click('button:has-text("step")');
  await until(page, async () => (await (await fetch("/api/v1/events")).json()).events.filter(e => e.event === "paused").length === 2);
  check("a paused run takes one step", (await halts())[1] === halted + 1, await halts());
  // What is shown is where the run stands, although these ticks are not published.
  const shown = await page.evaluate(async () => (await (await fetch("/api/v1/run")).json()).time_s);
  figure("a paused run stands at, and the page says", `${halted + 1} s, ${shown} s`);
  await page.waitForSelector("text=continue");
  await page.click('button:has-text("continue")');
  await until(page, async t => (await (await fetch("/api/v1/run")).json()).time_s > t + 20, halted);
  check("and goes on", true);

  process.kill(pid_of(run.folder, "ev2"), "SIGKILL");
  const code = await run.ended;
  check("a killed agent ends the run with exit code 4", code === 4, code);
  await page.waitForSelector("text=run is over");
  check("the page says that the run is over", true);
  await page.waitForSelector(".node.process.lost");
  const red = await page.evaluate(() => {
    const node = [...document.querySelectorAll(".node.process.lost")].find(n => n.textContent.includes("ev2"));
    return node ? getComputedStyle(node.querySelector("rect")).stroke : "nothing";
  });
  check("the killed agent has turned red in the graph", red === "rgb(196, 22, 47)", red);
  check("and nobody else has", await page.locator(".node.process.lost").count() === 1);
  check("the list of processes says it too", await page.locator(".state.lost").count() === 1);
  await shot(page, "case_1_killed");
  await page.close();
}
