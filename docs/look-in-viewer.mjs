// Opens a log in Foxglove Studio 1.48 in a Chromium without a window, and writes a picture of it.
// docs/viewer.md says what it needs and how to call it.

import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, resolve } from "node:path";
import { parseArgs } from "node:util";
import { createRequire } from "node:module";

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    at: { type: "string", default: "0.1" }, // seconds into the log
    start: { type: "string", default: "2025-01-01T00:00:00Z" }, // when the log starts
    scheme: { type: "string", default: "dark" },
    size: { type: "string", default: "1600x1000" },
    wait: { type: "string", default: "25" }, // seconds until everything has been drawn
    chromium: { type: "string", default: "/usr/bin/chromium" },
  },
});
const [log, layout, picture] = positionals;
if (!picture) {
  console.error("usage: look-in-viewer.mjs LOG.mcap LAYOUT.json PICTURE.png|jpg [--at SECONDS] …");
  process.exit(2);
}

// Packages are looked for where the command is called.
const packages = resolve("node_modules");
const puppeteer = createRequire(`${packages}/`)("puppeteer-core");

const page = `<!doctype html><meta charset="utf-8">
<style>html, body, #root { height: 100%; margin: 0 }</style><div id="root"></div>
<script src="/node_modules/react/umd/react.production.min.js"></script>
<script src="/node_modules/react-dom/umd/react-dom.production.min.js"></script>
<script>
  window.react = React; window["react-dom"] = ReactDOM;
  window.process = { env: {} }; window.global = window;
</script>
<script src="/node_modules/@foxglove/studio-base/assets/index.js"></script>
<script type="module">
  const query = new URLSearchParams(location.search);
  await initI18n();
  const data = await (await fetch("/layout.json")).json();
  const kept = { id: "tandem", name: "tandem", permission: "CREATOR_WRITE",
    baseline: { data, savedAt: new Date().toISOString() } };
  const spaces = new Map();
  const space = (name) => {
    if (!spaces.has(name)) spaces.set(name, new Map([["tandem", kept]]));
    return spaces.get(name);
  };
  const layoutStorage = {
    list: async (name) => [...space(name).values()],
    get: async (name, id) => space(name).get(id),
    put: async (name, layout) => { space(name).set(layout.id, layout); return layout; },
    delete: async (name, id) => { space(name).delete(id); },
    importLayouts: async () => {},
  };
  const settings = new Map(Object.entries({ colorScheme: query.get("scheme"), timezone: "UTC",
    "telemetry.telemetryEnabled": false, "telemetry.crashReportingEnabled": false,
    "ui.open-dialog-startup": false, hideSignInPrompt: true }));
  const appConfiguration = { get: (key) => settings.get(key),
    set: async (key, value) => { settings.set(key, value); },
    addChangeListener() {}, removeChangeListener() {} };
  ReactDOM.render(React.createElement(App, { deepLinks: [location.href], appConfiguration,
    layoutStorage, extensionLoaders: [], dataSources: [new RemoteDataSourceFactory()],
    enableGlobalCss: true }), document.getElementById("root"));
</script>`;

const kinds = { ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm" };

function answer(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  if (pathname === "/") {
    response.writeHead(200, { "Content-Type": "text/html" });
    return response.end(page);
  }
  const own = { "/log.mcap": log, "/layout.json": layout };
  const file = own[pathname] ?? resolve(`.${pathname}`);
  if (!(own[pathname] || file.startsWith(packages)) || !existsSync(file)) {
    response.writeHead(404);
    return response.end();
  }
  const size = statSync(file).size;
  const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? "");
  const first = Number(range?.[1] ?? 0);
  const last = range?.[2] ? Math.min(Number(range[2]), size - 1) : size - 1;
  response.writeHead(range ? 206 : 200, {
    "Content-Type": kinds[extname(file)] ?? "application/octet-stream",
    "Content-Length": last - first + 1,
    "Accept-Ranges": "bytes",
    ...(range && { "Content-Range": `bytes ${first}-${last}/${size}` }),
  });
  if (request.method === "HEAD") return response.end();
  return createReadStream(file, { start: first, end: last }).pipe(response);
}

const server = createServer(answer).listen(0, "127.0.0.1");
await new Promise((ready) => server.once("listening", ready));
const home = `http://127.0.0.1:${server.address().port}`;
const time = new Date(Date.parse(options.start) + 1000 * Number(options.at)).toISOString();
const query = new URLSearchParams({ ds: "remote-file", "ds.url": `${home}/log.mcap`,
  layoutId: "tandem", time, scheme: options.scheme });

const [width, height] = options.size.split("x").map(Number);
const browser = await puppeteer.launch({
  executablePath: options.chromium,
  protocolTimeout: 300_000,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const sleep = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));
try {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height });
  tab.on("pageerror", (error) => console.error(String(error)));
  await tab.goto(`${home}/?${query}`, { timeout: 300_000 });
  await sleep(Number(options.wait));
  // What the viewer itself has to complain about stands under this heading.
  const problems = await tab.evaluate(async () => {
    [...document.querySelectorAll("button")].find((b) => b.innerText === "Problems")?.click();
    await new Promise((done) => setTimeout(done, 500));
    return document.body.innerText.split("\nProblems\n")[1]?.slice(0, 400) ?? "no heading";
  });
  console.log(problems.startsWith("No problems found") ? "no problems found" : problems);
  await tab.mouse.click(24, 24); // closes the sidebar
  // The hint about settings covers a plot until it is closed.
  await tab.evaluate(() => {
    const hint = [...document.querySelectorAll("div")].findLast((d) => /^Open settings to/.test(d.innerText));
    hint?.parentElement?.querySelector("button")?.click();
  });
  await tab.mouse.move(width / 2, height - 4);
  await sleep(5);
  const type = /\.jpe?g$/.test(picture) ? { type: "jpeg", quality: 85 } : {};
  await tab.screenshot({ path: picture, ...type });
} finally {
  await browser.close();
  server.close();
}
