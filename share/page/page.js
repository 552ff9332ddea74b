/* SPDX-License-Identifier: MIT-0 */
/* The last part of the script of a page of plgen --page: the page runs the engine of engine.js frame by frame, and
 * draws what sketch.js and scope.js make of it; controls.js changes it. */

class Page {
  constructor(model, engine) {
    this.model = model;
    this.engine = engine;
    this.history = new History(engine.columns);
    this.running = false;
    this.owed = 0;                                  // Steps that time has passed for
    this.changes = 0;                               // Of params
    this.channels = this.findChannels();
    this.byName = new Map(this.channels.map((c) => [c.name, c]));
    this.sketch = new Sketch(this);
    this.scope = new Scope(this);
    this.plane = new Plane(this);
    this.spectrum = new Spectrum(this);
    this.response = new ResponsePlot(this);
    this.set = this.usualSettings();
    this.tick = (now) => this.tickAt(now);
    this.controls = new Controls(this);
    this.controls.restore();
    this.colours();
    this.begin();
    this.listen();
    this.run(true);
  }

  /* What can be shown: outputs, and states that no output is named after. */
  findChannels() {
    const m = this.model, named = new Set(m.outputs.map((o) => o.name));
    const all = m.outputs.map((o, i) => ({...o, column: 1 + i}));
    m.states.forEach((s, i) => { if (!named.has(s.name)) all.push({...s, column: 1 + this.engine.outputs + i}); });
    return all.map((c) => ({...c, label: withUnit(c), factor: c.factor || 1}));
  }

  usualSettings() {
    const show = this.channels.slice(0, 3).map((c) => c.name), speed = this.usualSpeed();
    const drive = this.response.drives[0];
    return {speed, window: Number((10 * speed).toPrecision(1)), show, x: show[0],
            y: this.channels[Math.min(1, this.channels.length - 1)].name, of: show[0], to: show[0],
            by: drive && drive.name};
  }

  /* Model seconds in a second: 1, unless its steps are so short or so long that nothing would be seen. */
  usualSpeed() {
    const perFrame = 1 / 60 / this.model.h;
    const speed = perFrame > 1000 ? 1000 / perFrame : perFrame < 0.3 ? 0.3 / perFrame : 1;
    return Number(speed.toPrecision(1));
  }

  /* A column as it is now */
  value(column) { return this.history.at(this.history.count - 1, column); }

  /* ---- the run ---- */

  run(on) {
    this.running = on && !this.failed;
    this.controls.play.textContent = this.running ? "Pause" : "Run";
    this.last = 0;
    this.wake();
  }

  touch() {
    this.dirty = true;
    this.wake();
  }

  /* The loop stands still while nothing runs and nothing is to be drawn, or the page is hidden. */
  wake() { if (!this.frame && !document.hidden) this.frame = requestAnimationFrame(this.tick); }

  single() {
    this.run(false);
    this.advance(1);
    this.touch();
  }

  forgetPast() {
    this.engine.reset();
    this.begin();
  }

  /* Begins the pictures anew; the run goes on where it is. */
  begin() {
    const steps = this.set.window / this.model.h;
    this.history.clear(Math.max(1, Math.ceil(steps / this.history.room)));
    this.failed = false;
    this.controls.wrong.textContent = "";
    this.sketch.forget();
    this.engine.wasm.look(0);
    this.history.add(this.engine.rows, 0, this.engine.wasm.time());
    this.controls.showStart();
    this.touch();
  }

  advance(n) {
    const e = this.engine, h = this.model.h;
    let status = 0;
    while (n > 0 && !status) {
      const part = Math.min(n, e.most), before = e.count;
      status = e.run(part);
      for (let k = 0; k < part; k++) this.history.add(e.rows, k, (before + k + 1) * h);
      n -= part;
    }
    if (status) this.fail(status);
  }

  fail(status) {
    const why = STATUS.filter(([bit]) => status & bit).map(([, what]) => what).join("; ");
    this.failed = true;
    this.run(false);
    this.controls.wrong.textContent = "t = " + text(this.engine.wasm.time()) + " s: " + (why || "status " + status);
  }

  /* A frame takes at most 12 ms of steps; what is owed beyond is dropped, so the model runs slower and stays smooth. */
  tickAt(now) {
    this.frame = 0;
    if (this.running) {
      const passed = this.last ? Math.min(now - this.last, 100) / 1000 : 1 / 60, begun = performance.now();
      this.last = now;
      this.owed += passed * this.set.speed / this.model.h;
      while (this.owed >= 1 && this.running) {
        const n = Math.min(Math.floor(this.owed), 256);
        this.advance(n);
        this.owed -= n;
        if (performance.now() - begun > 12) this.owed = Math.min(this.owed, 1);
      }
    }
    if (this.running || this.dirty) this.draw(now);
    this.dirty = false;
    if (this.running) this.wake();
  }

  /* ---- the pictures ---- */

  colours() {
    const style = getComputedStyle(document.body), of = (name) => style.getPropertyValue(name).trim();
    this.ink = of("--ink");
    this.faint = of("--faint");
    this.paper = of("--paper");
    this.curve = ["--c1", "--c2", "--c3", "--c4", "--c5", "--c6"].map(of);
    this.dirty = true;
  }

  /* Texts are made five times in a second, what is over frequency twice and when a param was changed. */
  draw(now) {
    this.fresh = !this.running || !(now - this.textAt < 200);
    this.sketch.draw();
    this.scope.draw();
    this.plane.draw();
    if (!this.running || this.changes !== this.changesDrawn || !(now - this.spectrumAt < 500)) {
      this.spectrum.draw();
      if (this.response.drives.length) this.response.draw();
      this.spectrumAt = now;
      this.changesDrawn = this.changes;
    }
    if (this.fresh) {
      this.controls.now.textContent = "t = " + this.engine.wasm.time().toFixed(3) + " s"
        + (this.history.events ? ", events: " + this.history.events : "");
      this.textAt = now;
      this.scope.readCursor();
    }
  }

  /* The canvas in the screen's own dots, cleared */
  fit(canvas, height) {
    const dots = window.devicePixelRatio || 1, width = canvas.clientWidth || 300;
    if (canvas.width !== Math.round(width * dots) || canvas.height !== Math.round(height * dots)) {
      canvas.width = Math.round(width * dots);
      canvas.height = Math.round(height * dots);
    }
    const g = canvas.context || (canvas.context = canvas.getContext("2d"));
    g.setTransform(dots, 0, 0, dots, 0, 0);
    g.clearRect(0, 0, width, height);
    g.lineWidth = 1.5;
    g.lineJoin = "round";
    g.font = "12px system-ui,sans-serif";
    canvas.wide = width;
    canvas.high = height;
    return g;
  }

  listen() {
    document.addEventListener("visibilitychange", () => { this.last = 0; this.wake(); });
    document.addEventListener("keydown", (event) => {
      if (event.target !== document.body || event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.key === " ") this.run(!this.running);
      else if (event.key === ".") this.single();
      else return;
      event.preventDefault();
    });
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      this.controls.take(event.dataTransfer.files[0]);
    });
    window.addEventListener("beforeprint", () => this.controls.printNumbers());
    window.addEventListener("resize", () => this.touch());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.colours(); this.wake(); });
  }
}

/* ---- the start ---- */

/* The page's first script has `inflated`: what stands in the page compressed. In the playground a page has no code. */
async function open() {
  const model = JSON.parse(document.getElementById("model").textContent);
  try {
    const here = document.getElementById("wasm").textContent;
    const run = here ? (await WebAssembly.instantiate(await inflated("wasm"))).instance.exports : window.parent.model;
    window.page = new Page(model, new Engine(model, run));
  } catch (error) {
    document.body.append(element("p", {role: "alert", className: "wrong", textContent: "The model does not run in this "
      + "browser: " + error.message}));
  }
}

if (typeof module === "undefined") open();
else module.exports = {Engine, StepResponse, drivesOf};
