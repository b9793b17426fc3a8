// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the end-to-end tests share: runs of the real programs, pages of a real browser, and a count of what was not as expected.
import { chromium } from "playwright-core";
import { spawn } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
export const root = resolve(here, "../..");
const renews = process.argv.includes("--renew-pictures");
export const [given, ...wanted] = process.argv.slice(2).filter(word => !word.startsWith("--"));
export const build = resolve(given ?? join(root, "build/release"));
export const shots = join(here, "shots");
mkdirSync(shots, { recursive: true });

const result = { failures: 0, errors: [] };
export const failures = () => result.failures;
export const errors = result.errors; // of the browser

export function check(what, good, found = "") {
  console.log(`${good ? "ok    " : "FAILED"}  ${what}${good || found === "" ? "" : `: found ${found}`}`);
  result.failures += good ? 0 : 1;
}
/** Something that was measured and is not judged: it depends on the machine. */
export const figure = (what, value) => console.log(`figure  ${what}: ${value}`);

const children = [];

/** Starts a scenario and waits until its monitor is told. */
export async function start(scenario, ...more) {
  const folder = join(mkdtempSync(join(tmpdir(), "gridspace-e2e-")), "run");
  const child = spawn(join(build, "bin/gridspace"), ["run", join(root, scenario), "--out", folder, ...more], { cwd: root });
  let said = "";
  const ended = new Promise(done => child.on("exit", code => done(code)));
  children.push({ child, ended });
  const url = await new Promise((done, fail) => {
    const read = data => {
      said += data;
      const found = /monitor: (https?:\/\/\S+)/.exec(said);
      if (found && said.includes("are ready")) done(found[1]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    child.on("exit", () => fail(new Error("the run ended before it was ready:\n" + said)));
  });
  return { url, folder, child, ended };
}

/** Runs a scenario that has no monitor to its end. */
export async function run_to_end(scenario, ...more) {
  const folder = join(mkdtempSync(join(tmpdir(), "gridspace-e2e-")), "run");
  const child = spawn(join(build, "bin/gridspace"), ["run", join(root, scenario), "--out", folder, ...more], { cwd: root, stdio: "ignore" });
  return { folder, code: await new Promise(done => child.on("exit", done)) };
}

/** `gridspace monitor FOLDER`: its process and address. */
export async function look(folder) {
  const child = spawn(join(build, "bin/gridspace"), ["monitor", folder], { cwd: root });
  children.push({ child, ended: new Promise(done => child.on("exit", done)) });
  return new Promise((done, fail) => {
    child.stdout.on("data", data => done({ url: String(data).trim(), child }));
    child.on("exit", code => fail(new Error(`gridspace monitor ended with ${code}`)));
  });
}

/** The process of a run with this name, outside of its PID namespace. */
export function pid_of(folder, name) {
  for (const entry of readdirSync("/proc")) {
    if (!/^\d+$/.test(entry)) continue;
    try {
      if (readFileSync(`/proc/${entry}/cmdline`, "utf8").includes(join(folder, "processes", `${name}.yaml`))) return Number(entry);
    } catch { /* it has just ended */ }
  }
  throw new Error(`process ${name} is not there`);
}

const patience_ms = 120_000; // nothing that works takes that long
const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!browserPath) throw new Error("chromium is not installed (apt install chromium)");
const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox"], timeout: patience_ms });

export async function open(url, theme, viewport = { width: 1440, height: 900 }) {
  const page = await browser.newPage({ viewport, colorScheme: theme });
  page.setDefaultTimeout(patience_ms);
  page.on("pageerror", e => errors.push(e.stack ?? e.message));
  page.on("console", m => { if (m.type() === "error") errors.push(m.text()); });
  await page.goto(url);
  return page;
}

/** Asks the page until the answer is yes; the page's own rules forbid the evaluation of text, which waitForFunction needs. */
export async function until(page, question, argument) {
  for (const end = Date.now() + patience_ms; !(await page.evaluate(question, argument)); ) {
    if (Date.now() > end) throw new Error(`waited ${patience_ms / 1000} s for: ${question}`);
    await new Promise(done => setTimeout(done, 100));
  }
}

/** Waits until the first picture inside `selector` has so many different colours: an empty one has two or three. */
export const until_drawn = (page, selector, least) => until(page, ([s, n]) => {
  const canvas = document.querySelector(`${s} canvas`);
  if (!canvas) return false;
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const found = new Set();
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200) found.add(`${data[i] >> 4},${data[i + 1] >> 4},${data[i + 2] >> 4}`);
  return found.size >= n;
}, [selector, least]);

export const shot = (page, name, fullPage = true) => page.screenshot({ path: join(shots, `${name}.png`), fullPage });

/** A picture of the documentation, docs/images/NAME.png, of what the window shows or a part of the page; --renew-pictures puts it there. */
export async function picture(page, name, part = "") {
  await (part ? page.locator(part).screenshot({ path: join(shots, `${name}.png`) }) : shot(page, name, false));
  if (renews) copyFileSync(join(shots, `${name}.png`), join(root, "docs/images", `${name}.png`));
}

const axe = readFileSync(join(here, "node_modules/axe-core/axe.min.js"), "utf8");

/** No finding of axe-core that it calls serious or critical; and nothing is wider than the window. */
export async function check_accessible(page, what) {
  await page.evaluate(axe);
  const found = await page.evaluate(async () => (await globalThis.axe.run()).violations.filter(v => ["serious", "critical"].includes(v.impact))
    .map(v => `${v.id} (${v.nodes.length}): ${v.nodes.slice(0, 3).map(n => n.target.join(" ")).join("; ")}`));
  check(`${what}: axe-core finds nothing serious`, found.length === 0, found.join(" | "));
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  check(`${what}: it needs no sideways scrolling`, wide <= 0, wide);
}

/** Of the texts of the one-line diagram, as the browser has drawn them, no two lie on each other. */
export async function check_diagram(page, what) {
  await page.waitForSelector(".oneline .bus");
  const found = await page.evaluate(() => {
    const texts = [...document.querySelectorAll(".oneline text")].map(e => ({ says: e.textContent, box: e.getBoundingClientRect() })).filter(t => t.box.width > 0);
    const one = document.querySelector(".oneline .bus text"), slack = one.getBoundingClientRect().height / 4; // a box has room for accents
    const over = (a, b) => a.left < b.right - 0.5 && b.left < a.right - 0.5 && a.top + slack < b.bottom && b.top + slack < a.bottom;
    return texts.flatMap((a, i) => texts.slice(i + 1).filter(b => over(a.box, b.box)).map(b => `${a.says} on ${b.says}`)).concat(texts.length ? [] : ["no text at all"]);
  });
  check(`${what}: no two labels of the one-line diagram lie on each other`, found.length === 0, found.join("; "));
}

/** Processes and topics of the scenario that the graph must show. */
export async function check_graph(page, processes, topics, streams = []) {
  for (const name of processes) {
    await page.waitForSelector(`.node.process[aria-label*="alive"] text:text-is("${name}")`);
    check(`the graph shows process ${name}`, true);
  }
  for (const [kind, names] of [["topic", topics], ["stream", streams]])
    for (const name of names) {
      await page.waitForSelector(`.node.${kind} text:text-is("${name}")`);
      check(`the graph shows ${kind} ${name}`, true);
    }
  check("no edge is broken", await page.locator(".arrow.bad").count() === 0);
}

export async function finish() {
  for (const it of children) {
    it.child.kill("SIGTERM");
    await it.ended;
  }
  await browser.close();
}
