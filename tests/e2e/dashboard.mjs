// The dashboard on real runs of case studies 1 and 2, live and recorded, as a user sees it. Needs chromium and a build with the dashboard:
//   cd tests/e2e && npm ci && node dashboard.mjs ../../build/release
// Screenshots go to tests/e2e/shots. Exit code 0: everything was as expected.
import { chromium } from "playwright-core";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, "../..");
const build = resolve(process.argv[2] ?? join(root, "build/release"));
const shots = join(here, "shots");
mkdirSync(shots, { recursive: true });
const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!browserPath) throw new Error("chromium is not installed (apt install chromium)");

let failures = 0;
function check(what, good, found = "") {
  console.log(`${good ? "ok    " : "FAILED"}  ${what}${good || found === "" ? "" : `: found ${found}`}`);
  failures += good ? 0 : 1;
}

/** Starts a scenario and waits until its monitor is told. */
async function start(scenario, ...more) {
  const folder = join(mkdtempSync(join(tmpdir(), "gridspace-e2e-")), "run");
  const child = spawn(join(build, "bin/gridspace"), ["run", join(root, scenario), "--out", folder, ...more], { cwd: root });
  let said = "";
  const ended = new Promise(done => child.on("exit", code => done(code)));
  const url = await new Promise((done, fail) => {
    const read = data => {
      said += data;
      const found = /monitor: (http:\/\/\S+)/.exec(said);
      if (found && said.includes("are ready")) done(found[1]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    child.on("exit", () => fail(new Error("the run ended before it was ready:\n" + said)));
  });
  return { url, folder, child, ended };
}

/** Asks the page until the answer is yes; the page's own rules forbid the evaluation of text, which waitForFunction needs. */
async function until(page, question, argument) {
  for (const end = Date.now() + 30_000; !(await page.evaluate(question, argument)); ) {
    if (Date.now() > end) throw new Error(`waited 30 s for: ${question}`);
    await new Promise(done => setTimeout(done, 100));
  }
}

/** The process of a run with this name, outside of its PID namespace. */
function pid_of(folder, name) {
  for (const entry of readdirSync("/proc")) {
    if (!/^\d+$/.test(entry)) continue;
    try {
      if (readFileSync(`/proc/${entry}/cmdline`, "utf8").includes(join(folder, "processes", `${name}.yaml`))) return Number(entry);
    } catch { /* it has just ended */ }
  }
  throw new Error(`process ${name} is not there`);
}

const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox"] });
const errors = [];
async function open(url, theme) {
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: theme });
  page.on("pageerror", e => errors.push(e.message));
  page.on("console", m => { if (m.type() === "error") errors.push(m.text()); });
  await page.goto(url);
  return page;
}

/** `gridspace monitor FOLDER`: its process and address. */
async function look(folder) {
  const child = spawn(join(build, "bin/gridspace"), ["monitor", folder], { cwd: root });
  const url = await new Promise((done, fail) => {
    child.stdout.on("data", data => done(String(data).trim()));
    child.on("exit", code => fail(new Error(`gridspace monitor ended with ${code}`)));
  });
  return { url, child, ended: new Promise(done => child.on("exit", done)) };
}

const run = await start("configs/scenarios/ev_charging.yaml", "--set", "clock.speed=300", "--allow-control");
let protection = null, recorded = null;
try {
  const page = await open(run.url, "light");
  await page.waitForSelector("text=8 of 8 alive");
  for (const name of ["sim", "ev1", "ev2", "ev3", "ev4", "mcca"])
    check(`the graph shows process ${name}`, await page.locator(`.node.process[aria-label*="alive"] text:text-is("${name}")`).count() === 1);
  for (const name of ["bus_measurements", "requests", "decisions"])
    check(`the graph shows topic ${name}`, await page.locator(`.node.topic text:text-is("${name}")`).count() === 1);
  check("no edge is broken", await page.locator(".arrow.bad").count() === 0);
  for (const bus of ["B1", "B2", "B3", "B4"]) {
    await until(page, b => [...document.querySelectorAll(".bus")].some(n => new RegExp(`${b} [01]\\.\\d{3}`).test(n.textContent)), bus);
    check(`the one-line diagram shows the voltage of ${bus}`, true);
  }
  await page.waitForSelector(".plot canvas");
  const drawn = await page.evaluate(() => {
    const canvas = document.querySelector(".plot canvas");
    const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200) colours.add(`${data[i] >> 4},${data[i + 1] >> 4},${data[i + 2] >> 4}`);
    return colours.size;
  });
  check("the waveforms are drawn in several colours", drawn >= 4, drawn);
  await page.screenshot({ path: join(shots, "ev_light.png") });
  await page.locator('.node.topic text:text-is("requests")').locator("..").focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".drawer >> text=ChargingRequest");
  await page.waitForSelector(".drawer >> text=current_a");
  check("a topic opened by the keyboard shows its newest samples and its IDL", true);
  await page.screenshot({ path: join(shots, "ev_topic.png") });
  await page.keyboard.press("Escape");
  await page.fill('input[type="search"]', "mcca");
  await until(page, () => location.hash.includes("find=mcca"));
  check("the address remembers what was chosen", true);
  const dark = await open(await page.evaluate(() => location.href), "dark");
  await dark.waitForSelector(".node.found");
  await dark.waitForSelector(".plot canvas");
  await dark.screenshot({ path: join(shots, "ev_dark.png") });
  check("another page at that address shows the same, in the dark", true);

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
  await page.waitForSelector("text=continue");
  await page.click('button:has-text("continue")');
  await until(page, async t => (await (await fetch("/api/v1/run")).json()).time_s > t + 20, halted);
  check("and goes on", true);

  process.kill(pid_of(run.folder, "ev2"), "SIGKILL");
  const code = await run.ended;
  check("a killed agent ends the run with exit code 4", code === 4, code);
  await page.waitForSelector("text=run is over");
  check("the page says that the run is over", true);
  await page.screenshot({ path: join(shots, "ev_killed.png") });

  // Case study 2, fast and short: the fault, the trip, and the breakers on the diagram; then the same from the recording.
  protection = await start("configs/scenarios/protection_lockstep.yaml", "--set", "events.fault.at_s=0.5", "--set", "simulation.duration_s=1");
  const live = await open(protection.url, "light");
  for (const stream of ["SMV21", "SMV22", "TRIP2"])
    await live.waitForSelector(`.node.stream text:text-is("${stream}")`);
  check("the graph shows the streams on the wire", true);
  await protection.ended;
  recorded = await look(protection.folder);
  const again = await open(`${recorded.url}/#at=0.49`, "dark");
  await again.waitForSelector(".transport");
  await until(again, () => document.querySelectorAll(".breaker.closed").length === 6);
  check("before the fault all breakers are closed", (await again.locator(".fault").count()) === 0);
  await again.click('[aria-label="to the next event"]');
  await again.waitForSelector(".fault");
  check("the next event is the fault, and the diagram shows it", true);
  await again.fill('[aria-label="instant"]', "0.9");
  await until(again, () => document.querySelectorAll(".breaker.opened").length === 2);
  check("later CB3 and CB4 are open", true);
  await again.waitForSelector('section[aria-label="Wire timing"] >> text=SMV21');
  check("the wire panel lists the streams", true);
  await again.screenshot({ path: join(shots, "protection_recorded.png"), fullPage: true });
  check("no error in the browser but the end of the connection", errors.every(e => /WebSocket|ERR_CONNECTION/.test(e)), errors.join("; "));
} finally {
  for (const it of [run, protection, recorded]) {
    it?.child.kill("SIGTERM");
    await it?.ended;
  }
  await browser.close();
}
console.log(failures ? `${failures} failed` : "all as expected");
process.exit(failures ? 1 : 0);
