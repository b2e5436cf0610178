// Builds the page and writes it, compressed, as a C++ source:  node build.mjs FOLDER PAGE_DATA.cpp
//
// FOLDER is shared by all builds of this source tree: when its stamp says that the page was built from the same
// sources, nothing is built again. Packages are installed when the lock file is not the one they were installed from.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, extname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const web = dirname(fileURLToPath(import.meta.url));
const [folder, output] = process.argv.slice(2);
const types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
};

function filesIn(top) {
  return readdirSync(top, { withFileTypes: true })
    .flatMap((entry) => (entry.isDirectory() ? filesIn(join(top, entry.name)) : [join(top, entry.name)]))
    .sort();
}

function digest(files) {
  const hash = createHash("sha256");
  for (const file of files) hash.update(relative(web, file)).update("\0").update(readFileSync(file)).update("\0");
  return hash.digest("hex");
}

function readOr(path, fallback) {
  return existsSync(path) ? readFileSync(path, "utf8") : fallback;
}

function run(program, args) {
  try {
    execFileSync(program, args, { cwd: web, stdio: ["ignore", "pipe", "pipe"], encoding: "utf8" });
  } catch (error) {
    console.error(`${program} ${args.join(" ")} failed:\n${error.stdout ?? ""}${error.stderr ?? error.message}`);
    console.error("The viewer's page needs node 18 or later, npm, and (the first time) npm's registry.");
    console.error("Without them, configure with -DTACTUM_PAGE=OFF: everything but the viewer's page is then there.");
    process.exit(1);
  }
}

function installPackages() {
  const lock = digest([join(web, "package-lock.json")]);
  const stamp = join(web, "node_modules", ".installed-from");
  if (readOr(stamp, "") === lock) return;
  run("npm", ["ci", "--no-audit", "--no-fund", "--ignore-scripts"]);
  writeFileSync(stamp, lock);
}

function buildPage() {
  const sources = [
    ...filesIn(join(web, "src")),
    ...filesIn(join(web, "public")),
    ...["index.html", "package-lock.json", "vite.config.js", "tsconfig.json", "build.mjs"].map((name) => join(web, name)),
  ];
  const stamp = join(folder, "built-from");
  const wanted = digest(sources);
  if (readOr(stamp, "") === wanted) return;
  installPackages();
  run(process.execPath, [join(web, "node_modules/typescript/bin/tsc"), "--noEmit"]);
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  run(process.execPath, [join(web, "node_modules/vite/bin/vite.js"), "build", "--outDir", join(folder, "files"), "--emptyOutDir"]);
  writeFileSync(stamp, wanted);
}

/** The page's files as C++ arrays; index.html first. */
function embed() {
  const top = join(folder, "files");
  const files = filesIn(top).sort((a, b) => Number(b.endsWith("index.html")) - Number(a.endsWith("index.html")));
  let total = 0;
  let arrays = "";
  let entries = "";
  files.forEach((file, i) => {
    const bytes = gzipSync(readFileSync(file), { level: 9 });
    total += bytes.length;
    const numbers = Array.from(new Int8Array(bytes.buffer, bytes.byteOffset, bytes.length)).join(",");
    arrays += `constexpr char kFile${i}[] = {${numbers}};\n`;
    entries += `      {"${relative(top, file)}", "${types[extname(file)]}", {kFile${i}, sizeof kFile${i}}},\n`;
  });
  writeFileSync(
    output,
    `// Made from viewer/web by build.mjs: ${total} bytes compressed.\n#include "viewer/server/page.h"\n\nnamespace tactum {\n` +
      `namespace {\n${arrays}}  // namespace\n\nstd::span<const PageFile> page_files() {\n` +
      `  static constexpr PageFile kFiles[] = {\n${entries}  };\n  return kFiles;\n}\n\n}  // namespace tactum\n`,
  );
}

buildPage();
embed();
