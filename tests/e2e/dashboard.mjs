// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The dashboard on real runs of the three case studies, live and recorded, as a user sees it, and the Foxglove protocol as an outside
// client sees it. Needs chromium and a build with the dashboard:
//   cd tests/e2e && ../../scripts/npm_packages.sh . && node dashboard.mjs ../../build/release [case_1|case_2|case_3|foxglove|assets|reports ...] [--renew-pictures]
// Screenshots go to tests/e2e/shots; with --renew-pictures (./gridspace docs --pictures) those of the documentation to docs/images too. Exit code 0: everything was as expected.
import { assets } from "./assets.mjs";
import { case_1 } from "./case_1.mjs";
import { case_2 } from "./case_2.mjs";
import { case_3 } from "./case_3.mjs";
import { foxglove } from "./foxglove.mjs";
import { check, errors, failures, finish, wanted } from "./harness.mjs";
import { reports } from "./reports.mjs";

const parts = { assets, case_1, case_2, case_3, foxglove, reports };
for (const [name, part] of Object.entries(parts)) {
  if (wanted.length && !wanted.includes(name)) continue;
  console.log(`-- ${name}`);
  await part().catch(e => check(`${name} comes to its end`, false, e.stack));
}
check("no error in the browser but the end of connections", errors.every(e => /WebSocket|ERR_CONNECTION/.test(e)), errors.join("; "));
await finish();
console.log(failures() ? `${failures()} failed` : "all as expected");
process.exit(failures() ? 1 : 0);
