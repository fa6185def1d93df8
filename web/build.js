// Bundles src/main.js with three.js into the one script that certreg's pages carry.
//   node build.js          writes certreg/report/assets/report.js
//   node build.js --check  fails if that file is not what this source makes

import { readFile, writeFile } from "node:fs/promises";

import { build } from "esbuild";

const OUT = new URL("../certreg/report/assets/report.js", import.meta.url);

const licence = await readFile(new URL("node_modules/three/LICENSE", import.meta.url), "utf8");
const { outputFiles } = await build({
  entryPoints: [new URL("src/main.js", import.meta.url).pathname],
  banner: { js: `/*! certreg (Apache-2.0) with three.js:\n${licence.trim()}\n*/` },
  bundle: true,
  charset: "ascii",
  format: "iife",
  legalComments: "none", // the whole licence stands in the banner
  minify: true,
  target: "es2022",
  write: false,
});
const text = outputFiles[0].text;
if (process.argv.includes("--check")) {
  if ((await readFile(OUT, "utf8")) !== text) {
    console.error("certreg/report/assets/report.js is not what web/src makes: run make report-asset");
    process.exit(1);
  }
} else {
  await writeFile(OUT, text);
}
