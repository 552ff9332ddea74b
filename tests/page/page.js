/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tests do with a page of plgen --page:
 *
 *     node page.js rows PAGE STEPS [SETTINGS]      its outputs as CSV, by the engine of its own script. SETTINGS is
 *                                                  JSON: {"params": {}, "start": {}, "inputs": {}}
 *     node page.js equal A.csv B.csv               whether two tables have the same names and numbers, bit for bit
 *     node page.js text PAGE                       what its JSON has: title, then the model's text
 *     node page.js policy PAGE                     whether its policy has the sums of its script and its style
 *     node page.js browse PAGE SCRIPT [WIDTH PNG]  what SCRIPT comes to, in a headless browser without a network, two
 *                                                  seconds after the page was opened; then each line of its log
 */
"use strict";
const fs = require("fs"), os = require("os"), path = require("path"), {spawn} = require("child_process");
const {createHash} = require("crypto");

function parts(file) {
  const html = fs.readFileSync(file, "utf8"), found = (pattern) => html.match(pattern)[1];
  const script = {exports: {}};
  new Function("module", found(/<script>([\s\S]*?)<\/script>\n<\/body>/))(script);
  return {
    model: JSON.parse(found(/<script type="application\/json" id="model">\n([\s\S]*?)<\/script>/)),
    wasm: found(/<script type="text\/plain" id="wasm">([^<]*)<\/script>/),
    script: script.exports
  };
}

async function rows(file, steps, settings) {
  const {model, wasm, script} = parts(file), set = JSON.parse(settings || "{}");
  const engine = new script.Engine(model, await script.compiled(wasm));
  model.params.forEach((p, i) => { engine.params[i] = (set.params || {})[p.name] ?? p.value; });
  model.states.forEach((s, i) => { engine.start[i] = (set.start || {})[s.name] ?? engine.given[i]; });
  model.inputs.forEach((u, i) => Object.assign(engine.signals[i], (set.inputs || {})[u.name]));
  if (engine.reset()) throw new Error("the params are refused");
  const shown = model.outputs.length ? model.outputs : model.states;
  const first = model.outputs.length ? 1 : 1 + engine.outputs;
  const line = (k, row) => console.log([k * model.h, ...shown.map((s, i) => engine.rows[row * engine.columns + first
    + i])].join(","));
  console.log(["t", ...shown.map((s) => s.name)].join(","));
  line(0, 0);
  for (let k = 0; k < steps; k += 300) {
    const n = Math.min(steps - k, 300), status = engine.run(n);
    for (let i = 0; i < n; i++) line(k + i + 1, i);
    if (status) throw new Error("status " + status);
  }
}

function equal(a, b) {
  const [one, other] = [a, b].map((file) => fs.readFileSync(file, "utf8").trim().split("\n").map((l) => l.split(",")));
  if (one.length !== other.length || one[0].join() !== other[0].join() || one.length < 3) {
    console.log(one.length + " rows of " + one[0], "and", other.length + " rows of " + other[0]);
    return false;
  }
  for (let k = 1; k < one.length; k++)
    for (let i = 1; i < one[0].length; i++)
      if (Number(one[k][i]) !== Number(other[k][i])) {
        console.log("row " + k + ", " + one[0][i] + ": " + one[k][i] + " and " + other[k][i]);
        return false;
      }
  console.log((one.length - 1) * (one[0].length - 1) + " numbers are equal");
  return true;
}

/* Commands to the browser and what it says go through two pipes, each message with a 0 behind it. */
async function browse(file, script, width, picture) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "page."));
  const browser = spawn(process.env.CHROMIUM || "chromium", ["--headless=new", "--no-sandbox", "--disable-gpu",
    "--hide-scrollbars", "--no-first-run", "--remote-debugging-pipe", "--user-data-dir=" + folder, "about:blank"],
    {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
  const waiting = new Map(), log = [];
  let unread = "";
  browser.stdio[4].on("data", (data) => {
    const messages = (unread + data).split("\0");
    unread = messages.pop();
    messages.map((m) => JSON.parse(m)).forEach((m) => {
      if (m.id) waiting.get(m.id)(m.result || m);
      else if (/^(Log.entryAdded|Runtime.(consoleAPICalled|exceptionThrown))$/.test(m.method))
        log.push(JSON.stringify(m.params));
    });
  });
  const send = (method, params, sessionId) => new Promise((resolve) => {
    const id = waiting.size + 1;
    waiting.set(id, resolve);
    browser.stdio[3].write(JSON.stringify({id, method, params: params || {}, sessionId}) + "\0");
  });
  const {targetId} = await send("Target.createTarget", {url: "about:blank"});
  const {sessionId} = await send("Target.attachToTarget", {targetId, flatten: true});
  for (const domain of ["Runtime", "Log", "Page", "Network"]) await send(domain + ".enable", {}, sessionId);
  await send("Network.emulateNetworkConditions", {offline: true, latency: 0, downloadThroughput: 0,
    uploadThroughput: 0}, sessionId);
  await send("Emulation.setDeviceMetricsOverride", {width: Number(width || 1400), height: 900, deviceScaleFactor: 1,
    mobile: false}, sessionId);
  const dark = {features: [{name: "prefers-color-scheme", value: process.env.DARK ? "dark" : "light"}]};
  await send("Emulation.setEmulatedMedia", dark, sessionId);
  await send("Page.navigate", {url: "file://" + path.resolve(file.replace(/#.*/, "")) + (file.match(/#.*/) || "")},
             sessionId);
  await new Promise((resolve) => setTimeout(resolve, 2000));
  const made = await send("Runtime.evaluate", {expression: script, awaitPromise: true, returnByValue: true}, sessionId);
  console.log(made.exceptionDetails ? JSON.stringify(made.exceptionDetails) : made.result.value);
  if (picture) {
    const shot = await send("Page.captureScreenshot", {format: "png"}, sessionId);
    fs.writeFileSync(picture, Buffer.from(shot.data, "base64"));
  }
  log.forEach((entry) => console.log("log: " + entry));
  const gone = new Promise((resolve) => browser.on("exit", resolve));
  await send("Browser.close");
  await gone;
  fs.rmSync(folder, {recursive: true, force: true});
}

function policy(file) {
  const html = fs.readFileSync(file, "utf8"), found = (pattern) => html.match(pattern)[1];
  const sum = (pattern) => "'sha256-" + createHash("sha256").update(found(pattern)).digest("base64") + "'";
  const expected = "default-src 'none'; script-src " + sum(/<script>([^]*?)<\/script>\n<\/body>/)
    + " 'wasm-unsafe-eval'; style-src " + sum(/<style>([^]*?)<\/style>/) + "; base-uri 'none'; form-action 'none'";
  console.log(expected);
  return expected === found(/Content-Security-Policy" content="([^"]*)"/);
}

const [command, ...rest] = process.argv.slice(2);
if (command === "rows") rows(rest[0], Number(rest[1]), rest[2]);
else if (command === "equal") process.exit(equal(rest[0], rest[1]) ? 0 : 1);
else if (command === "policy") process.exit(policy(rest[0]) ? 0 : 1);
else if (command === "browse") browse(...rest);
else console.log(parts(rest[0]).model.title + "\n" + parts(rest[0]).model.spec);
