// Bundles the dashboard into OUT (first argument; dist otherwise), each file also compressed: the monitor carries both.
import { build } from "esbuild";
import { gzipSync } from "node:zlib";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const out = process.argv[2] ?? "dist";
mkdirSync(out, { recursive: true });
await build({
  entryPoints: { app: "src/main.tsx" },
  bundle: true,
  minify: true,
  target: "es2021",
  jsx: "automatic",
  jsxImportSource: "preact",
  legalComments: "eof",
  outdir: out,
  logLevel: "warning",
});
copyFileSync("src/index.html", join(out, "index.html"));
let total = 0;
for (const file of ["index.html", "app.js", "app.css"]) {
  const packed = gzipSync(readFileSync(join(out, file)), { level: 9 });
  writeFileSync(join(out, file + ".gz"), packed);
  total += packed.length;
}
if (total > 250_000) {
  console.error(`the dashboard is ${total} octets compressed; 250000 is what it may be`);
  process.exit(1);
}
