// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the page weighs, and that it needs nothing from elsewhere.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { build, check, figure } from "./harness.mjs";

const kMost = 250_000; // octets, compressed

export async function assets() {
  const files = ["index.html", "app.js", "app.css"].map(f => readFileSync(join(build, "dashboard/dist", f)));
  const total = files.reduce((sum, f) => sum + gzipSync(f, { level: 9 }).length, 0);
  figure("the page, compressed", `${(total / 1000).toFixed(1)} kB`);
  check(`the page is under ${kMost / 1000} kB compressed`, total < kMost, total);
  const strangers = files.flatMap(f => f.toString().match(/(?:src|href|url\()\s*=?\s*["']?https?:\/\/[^"')\s]+/g) ?? []);
  check("it loads nothing from elsewhere", strangers.length === 0, strangers.join());
}
