/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tests do with a page of plgen --page:
 *
 *     node page.js rows PAGE STEPS [SETTINGS]      its outputs as CSV, by the engine of its own script. SETTINGS is
 *                                                  JSON: {"params": {}, "start": {}, "inputs": {}}
 *     node page.js response PAGE STEPS             whether its frequency responses are those of STEPS steps under a
 *                                                  sine, or after a jump, enough of them for what decays
 *     node page.js equal A.csv B.csv               whether two tables have the same names and numbers, bit for bit
 *     node page.js text PAGE                       what its JSON has: title, then the model's text
 *     node page.js policy PAGE                     whether its policy has the sums of its script and its style
 *     node page.js samples PAGE STEPS SETTINGS     the samples of its inputs as CSV
 *     node page.js browse PAGE FILE [WIDTH PNG]    what the scripts of FILE come to, in a headless browser without a
 *                                                  network; then each line of its log
 *     node page.js bits PAGE...                    whether the browser's numbers have the bits of node's
 *     node page.js firefox PAGE...                 the same of Firefox
 *     node page.js playground PAGE PLGEN FOLDER    whether the generator in PAGE writes of each model of FOLDER what
 *                                                  PLGEN does, and runs it with the bits of its page; then in a browser
 *     node page.js frames PAGE                     name, kB, processor time [ms] and garbage [kB] of a frame of 1000
 *                                                  steps; what went wrong
 */
"use strict";
const fs = require("fs"), os = require("os"), path = require("path"), {spawn, spawnSync} = require("child_process");
const {gunzipSync} = require("zlib"), net = require("net");
const {createHash} = require("crypto");

function compressed(html, id) {
  const letters = html.match('<script type="text/plain" id="' + id + '">([^<]*)</script>')[1];
  return gunzipSync(Buffer.from(letters, "base64"));
}

function parts(file) {
  const html = fs.readFileSync(file, "utf8"), found = (pattern) => html.match(pattern)[1];
  const script = {exports: {}}, text = compressed(html, "script").toString();
  new Function("module", text)(script);
  return {
	model: JSON.parse(found(/<script type="application\/json" id="model">\n([\s\S]*?)<\/script>/)),
	wasm: compressed(html, "wasm"), text, script: script.exports
  };
}

/* Its engine, as one of the page makes it */
async function engineOf({model, wasm, script}) {
  return new script.Engine(model, (await WebAssembly.instantiate(wasm)).instance.exports);
}

async function rows(file, steps, settings) {
  const page = parts(file), {model} = page, set = JSON.parse(settings || "{}"), engine = await engineOf(page);
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

async function samples(file, steps, settings) {
  const page = parts(file), engine = await engineOf(page), inputs = page.model.inputs;
  inputs.forEach((u, i) => Object.assign(engine.signals[i], JSON.parse(settings).inputs[u.name]));
  console.log(inputs.map((u) => u.name).join(","));
  for (let k = 0; k <= steps; k++) console.log(inputs.map((u, i) => engine.sample(i, k)).join(","));
}

/* The amplitude of output 0 under a sine of an input, by least squares over the second half of the steps */
function underSine(engine, drive, f, steps) {
  const h = engine.model.h, sums = [0, 0, 0, 0, 0];
  const only = (i) => ({kind: "sine", level: 0, rate: f, size: Number(i === drive.input)});
  engine.signals.forEach((s, i) => Object.assign(s, only(i)));
  engine.reset();
  for (let k = 1; k <= steps; k++) {
	engine.run(1);
	if (k < steps / 2) continue;
	const c = Math.cos(2 * Math.PI * f * k * h), s = Math.sin(2 * Math.PI * f * k * h), y = engine.rows[1];
	[c * c, c * s, s * s, c * y, s * y].forEach((x, i) => { sums[i] += x; });
  }
  const [cc, cs, ss, cy, sy] = sums, size = cc * ss - cs * cs;
  return Math.hypot(cy * ss - sy * cs, sy * cc - cy * cs) / size;
}

/* |sum over k >= 1 of h y_k e^{-2 pi i f k h}| after a jump of a state, less what there is without it */
function afterJump(engine, drive, f, steps) {
  const h = engine.model.h, run = (by) => {
	engine.start.set(engine.given);
	engine.start[drive.state] += by;
	engine.reset();
	return Float64Array.from({length: steps}, () => {
	  engine.run(1);
	  return engine.rows[1];
	});
  };
  const moved = run(1), plain = run(0);
  let re = 0, im = 0;
  moved.forEach((y, k) => {
	re += h * (y - plain[k]) * Math.cos(2 * Math.PI * f * (k + 1) * h);
	im += h * (y - plain[k]) * Math.sin(2 * Math.PI * f * (k + 1) * h);
  });
  return Math.hypot(re, im);
}

async function response(file, steps) {
  const page = parts(file), {StepResponse, drivesOf} = page.script, engine = await engineOf(page), h = page.model.h;
  const made = new StepResponse(engine, 50);
  let good = true;
  for (const drive of drivesOf(page.model))
	for (const part of [0.002, 0.02, 0.1, 0.3]) {
	  engine.reset();
	  made.measure(drive, 1, 1, 1e-3 / h);
	  const f = part / h, a = made.amplitudeAt(f);
	  const b = (drive.input === undefined ? afterJump : underSine)(engine, drive, f, steps);
	  console.log(drive.name + ", " + f + " Hz: " + a + ", stepped " + b);
	  good = good && Math.abs(a - b) <= 1e-6 * Math.abs(b);
	}
  return good;
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

/* Commands to a headless browser and what it says go through two pipes, each message with a 0 behind it. */
class Browser {
  constructor() {
	this.folder = fs.mkdtempSync(path.join(os.tmpdir(), "page."));
	this.process = spawn(process.env.CHROMIUM || "chromium", ["--headless=new", "--no-sandbox", "--disable-gpu",
	  "--hide-scrollbars", "--no-first-run", "--remote-debugging-pipe", "--enable-precise-memory-info",
	  "--autoplay-policy=no-user-gesture-required", "--user-data-dir=" + this.folder, "about:blank"],
	  {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
	this.waiting = new Map();
	this.log = [];
	let unread = "";
	this.process.stdio[4].on("data", (data) => {
	  const messages = (unread + data).split("\0");
	  unread = messages.pop();
	  messages.map((m) => JSON.parse(m)).forEach((m) => {
		if (m.id) this.waiting.get(m.id)(m.result || m);
		else if (/^(Log.entryAdded|Runtime.(consoleAPICalled|exceptionThrown))$/.test(m.method))
		  this.log.push(JSON.stringify(m.params));
	  });
	});
  }

  send(method, params) {
	return new Promise((resolve) => {
	  const id = this.waiting.size + 1;
	  this.waiting.set(id, resolve);
	  const message = {id, method, params: params || {}, sessionId: this.sessionId};
	  this.process.stdio[3].write(JSON.stringify(message) + "\0");
	});
  }

  /* Without a network; a page of its own, so that the last one is gone */
  async open(width) {
	const {targetId} = await this.send("Target.createTarget", {url: "about:blank"});
	this.sessionId = (await this.send("Target.attachToTarget", {targetId, flatten: true})).sessionId;
    for (const domain of ["Runtime", "Log", "Page", "Network", "Performance"]) await this.send(domain + ".enable");
	await this.send("Network.emulateNetworkConditions", {offline: true, latency: 0, downloadThroughput: 0,
	  uploadThroughput: 0});
	await this.send("Emulation.setDeviceMetricsOverride", {width, height: Number(process.env.HEIGHT || 900),
	  deviceScaleFactor: 1, mobile: false});
	const dark = {features: [{name: "prefers-color-scheme", value: process.env.DARK ? "dark" : "light"}]};
	await this.send("Emulation.setEmulatedMedia", dark);
  }

  /* Until the model has taken steps, or (as part of a report) is there */
  async visit(file) {
	const url = "file://" + path.resolve(file.replace(/#.*/, "")) + (file.match(/#.*/) || "");
	await this.send("Page.navigate", {url});
	for (let turn = 0; turn < 400; turn++) {
	  if (await this.value("window.page ? page.engine.count > 20 || page.failed : "
		+ "document.querySelector('iframe, .wrong') !== null") === true) return;
	  await new Promise((resolve) => setTimeout(resolve, 50));
	}
  }

  async value(script) {
	const made = await this.send("Runtime.evaluate", {expression: script, awaitPromise: true, returnByValue: true,
	  allowUnsafeEvalBlockedByCSP: false});
	return made.exceptionDetails ? JSON.stringify(made.exceptionDetails) : made.result.value;
  }

  async close() {
	const gone = new Promise((resolve) => this.process.on("exit", resolve));
	this.sessionId = undefined;
	await this.send("Browser.close");
	await gone;
	fs.rmSync(this.folder, {recursive: true, force: true});
  }
}

/* Scripts: blocks of a file, each with a line "# its name" before it */
async function browse(file, scripts, width, picture) {
  const browser = new Browser();
  await browser.open(Number(width || 1400));
  await browser.visit(file);
  for (const script of fs.readFileSync(scripts, "utf8").split(/^# .*\n/m).slice(1))
	console.log(await browser.value(script));
  if (picture) {
	const shot = await browser.send("Page.captureScreenshot", {format: "png"});
	fs.writeFileSync(picture, Buffer.from(shot.data, "base64"));
  }
  browser.log.forEach((entry) => console.log("log: " + entry));
  await browser.close();
}

/* A sum of the bits of all columns of so many steps from the start */
const sumOfBits = `(engine, steps) => {
  engine.reset();
  let sum = 0;
  for (let k = 0; k < steps; k += 250) {
	if (engine.run(250)) return "status";
	const words = new Uint32Array(engine.rows.buffer, engine.rows.byteOffset, 2 * 250 * engine.columns);
	for (let i = 0; i < words.length; i++) sum = Math.imul(sum, 31) + words[i] | 0;
  }
  return sum;
}`;

async function bits(files) {
  const browser = new Browser(), sum = eval(sumOfBits);
  let good = files.length > 0;
  await browser.open(1400);
  for (const file of files) {
	await browser.visit(file);
	const there = await browser.value("page.run(false), (" + sumOfBits + ")(page.engine, 2000)");
	const here = sum(await engineOf(parts(file)), 2000);
	console.log(path.basename(file, ".html") + ": " + there + ", node " + here);
	good = good && Number.isInteger(here) && there === here;
  }
  await browser.close();
  return good;
}

/* Of 200 frames of 1000 steps, ten from each start: processor time of a frame [ms], and what it leaves on the heap
 * [kB] */
async function frames(file) {
  const browser = new Browser(), run = (n) => browser.value(`page.run(false); for (let k = 0; k < ${n}; k++) {
	if (k % 10 === 0) page.engine.reset();
	page.running = true;
	page.advance(1000);
	page.draw(performance.now());
  }
  page.failed ? page.controls.wrong.textContent : ""`);
  const metric = async (name) =>
	(await browser.send("Performance.getMetrics")).metrics.find((m) => m.name === name).value;
  await browser.open(1400);
  await browser.visit(file);
  const said = await run(50);
  await browser.send("HeapProfiler.collectGarbage");
  const [time, heap] = [await metric("ThreadTime"), await metric("JSHeapUsedSize")];
  await run(200);
  const [later, more] = [await metric("ThreadTime"), await metric("JSHeapUsedSize")];
  console.log([path.basename(file, ".html"), (fs.statSync(file).size / 1000).toFixed(0),
               ((later - time) * 1000 / 200).toFixed(1), ((more - heap) / 200000).toFixed(2), said].join(" "));
  await browser.close();
}

/* In Firefox, headless and offline, by its Marionette: messages are LENGTH:JSON, commands [0, id, name, params].
 * Whether all columns after 2000 steps have the bits of node's */
async function firefox(files) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "page.")), waiting = new Map();
  fs.writeFileSync(path.join(folder, "user.js"), 'user_pref("network.proxy.type", 1);\n'
	+ 'user_pref("network.proxy.socks", "127.0.0.1");\nuser_pref("network.proxy.socks_port", 9);\n'
	+ 'user_pref("marionette.port", 28281);\n');
  const process = spawn("firefox-esr", ["--headless", "--marionette", "--profile", folder], {stdio: "ignore",
	env: {...globalThis.process.env, HOME: folder}});
  const connect = async () => {
	for (let turn = 0; turn < 600; turn++) {
	  const to = net.connect(28281, "127.0.0.1");
      if (await new Promise((done) => to.once("connect", () => done(true)).once("error", () => done(false)))) return to;
	  await new Promise((done) => setTimeout(done, 100));
	}
	throw new Error("Firefox does not answer");
  };
  const socket = await connect();
  let unread = Buffer.alloc(0);
  socket.on("data", (data) => {
	unread = Buffer.concat([unread, data]);
	for (;;) {
      const colon = unread.indexOf(":"), end = colon + 1 + Number(unread.subarray(0, Math.max(colon, 0)).toString());
	  if (colon < 0 || unread.length < end) return;
	  const message = JSON.parse(unread.subarray(colon + 1, end));
	  unread = unread.subarray(end);
	  if (Array.isArray(message)) waiting.get(message[1])(message[2] ? {error: message[2]} : message[3]);
	}
  });
  const send = (name, params) => new Promise((done) => {
	const id = waiting.size + 1, text = JSON.stringify([0, id, name, params]);
	waiting.set(id, done);
	socket.write(Buffer.byteLength(text) + ":" + text);
  });
  const value = async (script) => {
    const made = await send("WebDriver:ExecuteScript", {script: "const page = (window.wrappedJSObject || window).page;" + script,
                                                        args: []});
	return made.error ? JSON.stringify(made.error) : made.value;
  };
  let good = files.length > 0;
  await send("WebDriver:NewSession", {});
  for (const file of files) {
	await send("WebDriver:Navigate", {url: "file://" + path.resolve(file)});
	for (let turn = 0; turn < 400 && await value("return page ? page.engine.count > 20 : false") !== true; turn++)
	  await new Promise((done) => setTimeout(done, 50));
	const there = await value("page.run(false); page.forgetPast(); page.advance(2000);"
      + "const all = []; for (let i = 1; i < page.engine.columns; i++) all.push(String(page.value(i))); return all;");
	const engine = await engineOf(parts(file));
	for (let k = 0; k < 8; k++) engine.run(250);
    const last = 249 * engine.columns, here = Array.from(engine.rows.subarray(last + 1, last + engine.columns), String);
    console.log(path.basename(file, ".html") + ": " + here.join(" ") + ", in Firefox " + [].concat(there).join(" "));
	good = good && here.join() === [].concat(there).join();
  }
  const gone = new Promise((done) => process.on("exit", done));
  await send("Marionette:Quit", {flags: ["eForceQuit"]});
  await gone;
  fs.rmSync(folder, {recursive: true, force: true});
  return good;
}

/* In node; then, with the frame that the model runs in and a mistake, in a browser without a network */
async function playground(file, plgen, folder) {
  const script = {exports: {}}, sum = eval(sumOfBits), html = fs.readFileSync(file, "utf8");
  const page = path.join(fs.mkdtempSync(path.join(os.tmpdir(), "page.")), "page.html");
  new Function("module", compressed(html, "script").toString())(script);
  const wasm = new WebAssembly.Module(compressed(html, "plgen"));
  const files = JSON.parse(html.match(/id="models">([^]*?)<\/script>/)[1]), said = {};
  const native = (...words) => spawnSync(plgen, words, {cwd: folder, encoding: "utf8"});
  let good = true;
  const judge = (holds, what) => { console.log((holds ? "" : "not ") + what); good = good && holds; };
  for (const name of fs.readdirSync(folder).filter((name) => name.endsWith(".spec"))) {
	const all = {...files, [name]: fs.readFileSync(path.join(folder, name), "utf8")}, run = [];
	const code = native(name), here = new script.exports.Generator(wasm, all);
	here.run(name);
	judge(code.stdout === here.text(1) && code.stderr === here.text(2), name + ": what plgen writes");
	const there = new script.exports.Generator(wasm, all), status = native("--page", page, name).status;
	const ended = there.run("--page", "page.html", name);
	judge(ended === status, name + ": status " + status);
	if (status || ended) continue;
	const own = parts(page);
	run.push(sum(await engineOf(own), 500), sum(new own.script.Engine(own.model, there.model), 500));
	said[name] = run[1];
	judge(run[0] === run[1], name + ": " + run[1] + ", of its page " + run[0]);
  }
  const browser = new Browser(), inside = "document.getElementById('shown').contentWindow.page";
  await browser.open(1400);
  await browser.visit(file);
  for (let turn = 0; turn < 600 && await browser.value(inside + " ? " + inside + ".engine.count > 20 : false") !== true;
	turn++) await new Promise((resolve) => setTimeout(resolve, 50));
  const shown = await browser.value(inside + ".run(false), (" + sumOfBits + ")(" + inside + ".engine, 500)");
  judge(shown === said["two_masses.spec"], "in a browser " + shown);
  const place = await browser.value("spec.value = 'model x\\ncoord x\\nx\\'\\' + y = 0\\nstep 1\\n', playground.run(), "
	+ "[said.textContent.split('\\n')[0], spec.selectionStart, "
	+ "document.querySelectorAll('#lines .wrong').length].join()");
  judge(/:3:7: error: .*,22,1$/.test(place), "a mistake: " + place);
  browser.log.forEach((entry) => judge(false, entry));
  if (process.env.PICTURE)
    fs.writeFileSync(process.env.PICTURE, Buffer.from((await browser.send("Page.captureScreenshot")).data, "base64"));
  await browser.close();
  return good;
}

function policy(file) {
  const html = fs.readFileSync(file, "utf8"), found = (pattern) => html.match(pattern)[1];
  const sum = (text) => "'sha256-" + createHash("sha256").update(text).digest("base64") + "'";
  const expected = "default-src 'none'; script-src " + sum(found(/<script>([^]*?)<\/script>\n<\/body>/)) + " "
	+ sum(compressed(html, "script")) + " 'wasm-unsafe-eval'; style-src " + sum(found(/<style>([^]*?)<\/style>/))
	+ "; base-uri 'none'; form-action 'none'";
  console.log(expected);
  return expected === found(/Content-Security-Policy" content="([^"]*)"/);
}

const [command, ...rest] = process.argv.slice(2);
if (command === "rows") rows(rest[0], Number(rest[1]), rest[2]);
else if (command === "response") response(rest[0], Number(rest[1])).then((good) => process.exit(good ? 0 : 1));
else if (command === "equal") process.exit(equal(rest[0], rest[1]) ? 0 : 1);
else if (command === "policy") process.exit(policy(rest[0]) ? 0 : 1);
else if (command === "samples") samples(rest[0], Number(rest[1]), rest[2]);
else if (command === "browse") browse(...rest);
else if (command === "bits") bits(rest).then((good) => process.exit(good ? 0 : 1));
else if (command === "firefox") firefox(rest).then((good) => process.exit(good ? 0 : 1));
else if (command === "playground") playground(...rest).then((good) => process.exit(good ? 0 : 1));
else if (command === "frames") frames(rest[0]);
else console.log(parts(rest[0]).model.title + "\n" + parts(rest[0]).model.spec);
