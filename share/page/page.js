/* SPDX-License-Identifier: MIT-0 */
/* The second part of the script of a page of plgen --page: views draw what the engine of engine.js keeps; controls
 * change it. */

/* ---- a page for it ---- */

const withUnit = (v) => v.unit ? v.name + " [" + v.unit + "]" : v.name;
const text = (value) => Number(value.toPrecision(5)).toString();
const element = (tag, properties, ...children) => {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
};
/* Lines through points, x in lengths of what is drawn, y in points across it */
const LINES = {
  rod: [[0, 0, 1, 0]],
  spring: [[0, 0, 0.2, 0, 0.25, -6, 0.35, 6, 0.45, -6, 0.55, 6, 0.65, -6, 0.75, 6, 0.8, 0, 1, 0]],
  damper: [[0, 0, 0.45, 0], [0.45, -5, 0.45, 5], [0.3, -7, 0.6, -7, 0.6, 7, 0.3, 7], [0.6, 0, 1, 0]],
  friction: [[0, 0, 0.48, 0], [0.48, -7, 0.48, 7], [0.52, -7, 0.52, 7], [0.52, 0, 1, 0]],
  stop: [[0, 0, 0.4, 0], [0.4, -7, 0.4, 7], [0.55, -7, 0.55, 7], [0.55, 0, 1, 0]],
  force: [[0, 0, 1, 0, 0.8, -4], [1, 0, 0.8, 4]],
  ground: [[0, 0, 1, 0], [0.2, 0, 0, 8], [0.4, 0, 0.2, 8], [0.6, 0, 0.4, 8], [0.8, 0, 0.6, 8], [1, 0, 0.8, 8]]
};
let labels = 0;
const labelled = (name, control, ...more) => {
  control.id = control.id || "c" + ++labels;
  return element("div", {className: "row"}, element("label", {htmlFor: control.id, textContent: name}), control,
                 ...more);
};

class Page {
  constructor(model, engine) {
    this.model = model;
    this.engine = engine;
    this.history = new History(engine.columns);
    this.running = false;
    this.owed = 0;
    this.held = -1;
    this.channels = this.findChannels();
    const few = this.channels.slice(0, 3).map((c) => c.name);
    this.set = {speed: this.usualSpeed(), window: 0, show: few, x: few[0], y: this.channels[Math.min(1,
      this.channels.length - 1)].name, of: few[0]};
    this.set.window = Number((10 * this.set.speed).toPrecision(1));
    this.byName = new Map(this.channels.map((c) => [c.name, c]));
    this.tick = (now) => this.tickAt(now);
    this.build();
    this.restore();
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

  /* Model seconds in a second: 1, unless its steps are so short or so long that nothing would be seen. */
  usualSpeed() {
    const perFrame = 1 / 60 / this.model.h;
    const speed = perFrame > 1000 ? 1000 / perFrame : perFrame < 0.3 ? 0.3 / perFrame : 1;
    return Number(speed.toPrecision(1));
  }

  /* ---- controls ---- */

  build() {
    const m = this.model;
    this.said = element("p", {role: "status", className: "said"});
    this.wrong = element("p", {role: "alert", className: "wrong"});
    this.now = element("output", {className: "now"});
    this.sketch = this.canvas("Animated sketch of the model; drag a body to give it an initial value");
    this.scope = this.canvas("Scope: outputs over time; arrow keys move the cursor");
    this.plane = this.canvas("Phase plane");
    this.spectrum = this.canvas("Amplitude spectrum");
    this.read = element("output", {className: "now"});
    this.peak = element("output", {className: "now"});
    this.numbers = element("div", {className: "numbers"});
    const section = (title, ...parts) => element("section", {}, element("h2", {textContent: title}), ...parts);
    document.body.append(
      element("header", {}, element("h1", {textContent: m.title}),
        element("p", {textContent: m.states.length + " states, step " + text(m.h) + " s; as plrun --math own"})),
      element("main", {}, this.buttons(), this.said, this.wrong,
        element("div", {className: "panes"},
          section("Sketch", this.sketch), section("Scope", this.scope, this.read, this.choices()),
          section("Phase plane", this.plane, labelled("Across", this.select("x")), labelled("Up", this.select("y"))),
          section("Spectrum", this.spectrum, labelled("Of", this.select("of")), this.peak), this.tunables(),
          this.inputs(), this.initials()),
        this.numbers,
        element("details", {}, element("summary", {textContent: "The model's text"}),
          element("pre", {textContent: m.spec}))));
  }

  canvas(label) { return element("canvas", {tabIndex: 0, role: "img", ariaLabel: label}); }

  button(name, action) { return element("button", {type: "button", textContent: name, onclick: action}); }

  buttons() {
    this.play = this.button("Run", () => this.run(!this.running));
    this.speed = element("input", {type: "range", min: -4, max: 3, step: 0.1});
    this.speed.oninput = () => this.change("speed", Number((10 ** this.speed.value).toPrecision(2)));
    this.window = element("input", {type: "range", min: -3, max: 4, step: 0.1});
    this.window.oninput = () => {
      this.change("window", Number((10 ** this.window.value).toPrecision(2)));
      this.begin();
    };
    this.speedText = element("output", {});
    this.windowText = element("output", {});
    const actions = [["Step", "single"], ["Reset", "forget"], ["Link", "link"], ["CSV", "save"], ["Sound", "sound"]];
    return element("div", {className: "bar"}, this.play,
      ...actions.map(([name, action]) => this.button(name, () => this[action]())), labelled("Speed", this.speed,
      this.speedText), labelled("Time shown", this.window, this.windowText), this.now);
  }

  change(name, value) {
    this.set[name] = value;
    this.showSettings();
    this.touch();
  }

  showSettings() {
    this.speed.value = Math.log10(this.set.speed);
    this.window.value = Math.log10(this.set.window);
    this.speedText.textContent = text(this.set.speed) + " \u00d7";
    this.windowText.textContent = text(this.set.window) + " s";
  }

  choices() {
    this.boxes = this.channels.map((c) => {
      const box = element("input", {type: "checkbox", value: c.name});
      box.onchange = () => this.change("show", this.boxes.filter((b) => b.checked).map((b) => b.value));
      return box;
    });
    const list = element("fieldset", {className: "choices"}, element("legend", {textContent: "Shown"}));
    this.boxes.forEach((box, i) => list.append(element("label", {}, box, " " + this.channels[i].label)));
    return list;
  }

  select(setting) {
    const s = element("select", {});
    this.channels.forEach((c) => s.append(element("option", {value: c.name, textContent: c.label})));
    s.onchange = () => this.change(setting, s.value);
    this[setting + "Select"] = s;
    return s;
  }

  pane(title, rows) {
    return rows.length ? element("section", {className: "controls"}, element("h2", {textContent: title}), ...rows) : "";
  }

  /* A number field beside a slider says and takes any value; both are in the param's own unit. */
  tunables() {
    this.sliders = [];
    return this.pane("Params", this.model.params.map((p, i) => {
      const factor = p.factor || 1, value = p.value / factor;
      const low = p.low !== undefined ? p.low / factor : value > 0 ? value / 4 : value < 0 ? 4 * value : -1;
      const high = p.high !== undefined ? p.high / factor : value > 0 ? 4 * value : value < 0 ? value / 4 : 1;
      const slider = element("input", {type: "range", min: low, max: high, step: "any", value, title: p.about});
      const field = element("input", {type: "number", step: "any", value, title: p.about});
      field.ariaLabel = p.name + ", as a number";
      slider.oninput = () => this.tune(i, Number(slider.value) * factor);
      field.onchange = () => this.tune(i, Number(field.value) * factor);
      this.sliders.push({slider, field, factor});
      return labelled(withUnit(p), slider, field);
    }));
  }

  tune(i, value) {
    const e = this.engine, before = e.params[i];
    if (!Number.isFinite(value)) return this.showParams();
    e.params[i] = value;
    if (e.tune()) {
      e.params[i] = before;
      this.wrong.textContent = this.model.params[i].name + " cannot be " + text(value);
      e.tune();
    } else this.wrong.textContent = "";
    this.showParams();
  }

  showParams() {
    this.sliders.forEach((s, i) => {
      s.slider.value = this.engine.params[i] / s.factor;
      s.field.value = Number((this.engine.params[i] / s.factor).toPrecision(12));
    });
    this.touch();
  }

  inputs() {
    this.signalRows = [];
    return this.pane("Inputs", this.model.inputs.map((input, i) => {
      const s = this.engine.signals[i], fields = {}, kind = element("select", {});
      [["hold", "constant"], ["step", "step"], ["sine", "sine"], ["noise", "noise"], ["record", "CSV file"]].forEach(
        ([value, name]) => kind.append(element("option", {value, textContent: name})));
      kind.onchange = () => { s.kind = kind.value; this.forgetPast(); };
      const field = (key, name) => {
        fields[key] = element("input", {type: "number", step: "any", value: s[key]});
        fields[key].oninput = () => { s[key] = Number(fields[key].value) || 0; };
        return labelled(name, fields[key]);
      };
      const file = element("input", {type: "file", accept: ".csv,text/csv"});
      file.onchange = () => file.files[0] && file.files[0].text().then((t) => this.record(t));
      this.signalRows.push({kind, fields});
      return element("fieldset", {}, element("legend", {textContent: withUnit(input)}), labelled("Signal", kind),
        field("level", "Level"), field("size", "Amplitude"),
        field("rate", "Frequency [Hz], or time of the step [s]"), labelled("Samples", file));
    }));
  }

  /* Columns by the names of inputs, a row for each step; without a line of names in the inputs' order. */
  record(csv) {
    const lines = csv.split(/\r?\n/).filter((l) => l.trim() && l[0] !== "#").map((l) => l.split(","));
    const inputs = this.model.inputs, named = lines.length > 0 && lines[0].some((w) => Number.isNaN(Number(w)));
    const head = named ? lines.shift().map((w) => w.trim()) : inputs.map((x) => x.name);
    let taken = 0;
    inputs.forEach((input, i) => {
      const column = head.indexOf(input.name);
      if (column < 0) return;
      const record = Float64Array.from(lines, (l) => Number(l[column]));
      if (!record.length || record.some((x) => !Number.isFinite(x))) {
        this.wrong.textContent = "the column of " + input.name + " has a row that is no number";
        return;
      }
      Object.assign(this.engine.signals[i], {record, kind: "record"});
      this.signalRows[i].kind.value = "record";
      taken++;
    });
    this.said.textContent = taken ? lines.length + " samples, one for each step" : "no column is named as an input";
    this.forgetPast();
  }

  initials() {
    const m = this.model;
    if (m.states.length > 64) return "";
    this.startFields = m.states.map((s, i) => {
      const field = element("input", {type: "number", step: "any"});
      field.onchange = () => this.place(i, Number(field.value) * (s.factor || 1));
      return field;
    });
    return this.pane("Initial values", m.states.map((s, i) => labelled(withUnit(s), this.startFields[i])));
  }

  place(i, value) {
    if (Number.isFinite(value)) this.engine.start[i] = value;
    this.forgetPast();
  }

  showStart() {
    (this.startFields || []).forEach((f, i) => {
      f.value = Number((this.engine.start[i] / (this.model.states[i].factor || 1)).toPrecision(12));
    });
  }

  /* ---- what buttons do ---- */

  run(on) {
    this.running = on && !this.failed;
    this.play.textContent = this.running ? "Pause" : "Run";
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

  forget() {
    this.engine.params.set(this.engine.nominal);
    this.engine.start.set(this.engine.given);
    this.engine.tuned = false;
    this.showParams();
    this.forgetPast();
    history.replaceState(null, "", location.pathname + location.search);
  }

  forgetPast() {
    this.engine.reset();
    this.begin();
  }

  /* Begins the pictures anew; the run goes on where it is. */
  begin() {
    const h = this.model.h, steps = this.set.window / h;
    this.history.clear(Math.max(1, Math.ceil(steps / this.history.room)));
    this.failed = false;
    this.wrong.textContent = "";
    this.largest = 1e-300;
    this.box = null;
    this.engine.wasm.look(0);
    this.history.add(this.engine.rows, 0, this.engine.wasm.time());
    this.showStart();
    this.touch();
  }

  /* Settings as text behind the page's address: what differs from the spec */
  link() {
    const e = this.engine, m = this.model, all = {p: {}, y: {}, u: {}, s: this.set};
    m.params.forEach((p, i) => { if (e.params[i] !== e.nominal[i]) all.p[p.name] = e.params[i]; });
    m.states.forEach((s, i) => { if (e.start[i] !== e.given[i]) all.y[s.name] = e.start[i]; });
    m.inputs.forEach((s, i) => { all.u[s.name] = {...e.signals[i], record: null}; });
    history.replaceState(null, "", "#" + encodeURIComponent(JSON.stringify(all)));
    const said = () => { this.said.textContent = "the page's address has the settings"; };
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(said, said);
    else said();
  }

  /* What a link does not have, or has wrongly, stays as it is. */
  restore() {
    let all = {};
    try {
      all = JSON.parse(decodeURIComponent(location.hash.slice(1) || "%7B%7D")) || {};
    } catch (error) { this.said.textContent = "the settings in the page's address cannot be read"; }
    const e = this.engine, m = this.model, number = (x) => typeof x === "number" && Number.isFinite(x);
    const taken = (list, values, to) => list.forEach((v, i) => {
      if (values && Object.hasOwn(values, v.name) && number(values[v.name])) to[i] = values[v.name];
    });
    taken(m.params, all.p, e.params);
    taken(m.states, all.y, e.start);
    m.inputs.forEach((input, i) => {
      const from = (all.u || {})[input.name] || {}, s = e.signals[i], row = this.signalRows[i];
      ["level", "size", "rate"].forEach((key) => { if (number(from[key])) s[key] = from[key]; });
      if (["hold", "step", "sine", "noise"].includes(from.kind)) s.kind = from.kind;
      row.kind.value = s.kind;
      Object.keys(row.fields).forEach((key) => { row.fields[key].value = s[key]; });
    });
    const s = all.s || {};
    ["speed", "window"].forEach((key) => { if (number(s[key]) && s[key] > 0) this.set[key] = s[key]; });
    ["x", "y", "of"].forEach((key) => {
      if (this.byName.has(s[key])) this.set[key] = s[key];
      this[key + "Select"].value = this.set[key];
    });
    if (Array.isArray(s.show)) this.set.show = s.show.filter((name) => this.byName.has(name));
    this.boxes.forEach((b) => { b.checked = this.set.show.includes(b.value); });
    if (e.reset()) {
      e.params.set(e.nominal);
      e.reset();
      this.said.textContent = "the model cannot have the params in the page's address";
    }
    this.showParams();
    this.showSettings();
  }

  save() {
    const h = this.history, line = (values) => values.join(",") + "\n";
    const rows = [line(["t", ...this.channels.map((c) => c.name)])];
    for (let k = h.first; k < h.count; k++)
      rows.push(line([h.when(k), ...this.channels.map((c) => h.at(k, c.column))]));
    const a = element("a", {href: URL.createObjectURL(new Blob(rows, {type: "text/csv"})),
                            download: this.model.name + ".csv"});
    a.click();
    setTimeout(() => URL.revokeObjectURL(a.href), 1000);
  }

  /* The time that is shown, as it would be heard; at most two seconds */
  sound() {
    const h = this.history, c = this.byName.get(this.set.of), rate = 1 / (this.model.h * h.stride);
    const length = Math.min(h.count - h.first, Math.floor(2 * rate)), first = h.count - length;
    const peak = this.findPeak(c);
    if (!(peak >= 20 && peak <= 20000 && rate > 2 * peak)) {
      this.said.textContent = c.name + " vibrates at " + text(peak) + " Hz: heard is what is from 20 to 20000 Hz, in "
        + "rows close enough (a shorter time shown)";
      return;
    }
    this.audio = this.audio || new AudioContext();
    const out = this.audio.createBuffer(1, Math.floor(length / rate * this.audio.sampleRate), this.audio.sampleRate);
    const to = out.getChannelData(0);
    let mean = 0, most = 0;
    for (let k = first; k < h.count; k++) mean += h.at(k, c.column) / length;
    for (let k = first; k < h.count; k++) most = Math.max(most, Math.abs(h.at(k, c.column) - mean));
    for (let i = 0; i < to.length; i++) {
      const at = first + i / this.audio.sampleRate * rate, k = Math.min(Math.floor(at), h.count - 2), part = at - k;
      to[i] = 0.8 * (h.at(k, c.column) * (1 - part) + h.at(k + 1, c.column) * part - mean) / (most || 1);
    }
    const source = this.audio.createBufferSource();
    source.buffer = out;
    source.connect(this.audio.destination);
    source.start();
    this.said.textContent = "sound of " + c.name + ": " + text(peak) + " Hz";
  }

  /* ---- the loop ---- */

  advance(n) {
    const e = this.engine, h = this.model.h;
    let status = 0;
    while (n > 0 && !status) {
      const part = Math.min(n, e.most), before = e.count;
      status = e.run(part);
      for (let k = 0; k < part; k++) this.history.add(e.rows, k, (before + k + 1) * h);
      this.shownRow = part - 1;
      n -= part;
    }
    if (status) this.fail(status);
  }

  fail(status) {
    const why = STATUS.filter(([bit]) => status & bit).map(([, what]) => what).join("; ");
    this.failed = true;
    this.run(false);
    this.wrong.textContent = "t = " + text(this.engine.wasm.time()) + " s: " + (why || "status " + status);
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

  colours() {
    const style = getComputedStyle(document.body), of = (name) => style.getPropertyValue(name).trim();
    this.ink = of("--ink");
    this.faint = of("--faint");
    this.paper = of("--paper");
    this.curve = ["--c1", "--c2", "--c3", "--c4", "--c5", "--c6"].map(of);
    this.dirty = true;
  }

  draw(now) {
    this.fresh = !this.running || !(now - this.textAt < 200);   // Texts are made five times in a second.
    this.drawSketch(this.fit(this.sketch, 220));
    this.drawScope(this.fit(this.scope, 260));
    this.drawPlane(this.fit(this.plane, 240));
    if (!this.running || !(now - this.spectrumAt < 500)) {
      this.drawSpectrum(this.fit(this.spectrum, 240));
      this.spectrumAt = now;
    }
    if (this.fresh) {
      this.now.textContent = "t = " + this.engine.wasm.time().toFixed(3) + " s"
        + (this.history.events ? ", events: " + this.history.events : "");
      this.textAt = now;
      this.readCursor();
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

  /* ---- the scope ---- */

  drawScope(g) {
    const names = this.set.show, h = this.history, wide = this.scope.wide, lane = this.scope.high / (names.length || 1);
    const end = Math.max(h.when(h.count - 1), this.set.window), start = end - this.set.window;
    g.fillStyle = g.strokeStyle = this.faint;
    for (let k = h.first + 1; k < h.count; k++)
      if (h.at(k, 0) > h.at(k - 1, 0) && h.when(k) >= start)
        g.fillRect((h.when(k) - start) / this.set.window * wide, 0, 0.7, this.scope.high);
    for (let i = 0; i < names.length; i++) {
      const c = this.byName.get(names[i]);
      this.drawLane(g, c, start, i * lane, lane, this.curve[i % this.curve.length]);
    }
    if (this.cursor !== undefined) {
      g.fillStyle = this.ink;
      g.fillRect(this.cursor * wide, 0, 1, this.scope.high);
    }
    this.startTime = start;
  }

  drawLane(g, c, start, top, lane, colour) {
    const h = this.history, wide = this.scope.wide, column = c.column;
    h.measure(column, start);
    const low = h.low, high = h.high, middle = (high + low) / 2;
    const room = (Math.max(high - low, 1e-6 * Math.abs(high)) || 1) * 0.55;
    const scale = (lane - 18) / 2 / room, centre = top + lane / 2 + 6;
    g.strokeStyle = colour;
    g.beginPath();
    let pixel = -1, least = 0, most = 0;
    for (let k = h.first; k < h.count; k++) {
      const at = (h.when(k) - start) / this.set.window * wide;
      if (at < 0) continue;
      const y = centre - (h.at(k, column) - middle) * scale;
      if (Math.floor(at) !== pixel) {
        if (pixel >= 0 && most > least) {
          g.lineTo(pixel, least);
          g.lineTo(pixel, most);
        }
        g.lineTo(at, y);
        pixel = Math.floor(at);
        least = most = y;
      } else {
        if (y < least) least = y;
        if (y > most) most = y;
      }
    }
    g.stroke();
    g.fillStyle = colour;
    g.fillText(c.label, 4, top + 12);
    g.fillStyle = this.ink;
    g.textAlign = "right";
    if (this.fresh || !c.range) c.range = high >= low ? text(low / c.factor) + " … " + text(high / c.factor) : "";
    g.fillText(c.range, wide - 4, top + 12);
    g.textAlign = "left";
  }

  readCursor() {
    const h = this.history, to = this.cursor === undefined ? Infinity : this.startTime + this.cursor * this.set.window;
    let k = h.count - 1;
    while (k > h.first && h.when(k) > to) k--;
    this.read.textContent = "t = " + text(h.when(k)) + " s: " + this.set.show.map((name) => {
      const c = this.byName.get(name);
      return name + " = " + text(h.at(k, c.column) / c.factor) + (c.unit ? " " + c.unit : "");
    }).join(", ");
  }

  moveCursor(to) {
    this.cursor = Math.min(1, Math.max(0, to));
    this.touch();
  }

  /* ---- phase plane and spectrum ---- */

  drawPlane(g) {
    const h = this.history, a = this.byName.get(this.set.x).column, b = this.byName.get(this.set.y).column;
    h.measure(a, 0);
    const left = h.low, right = h.high;
    h.measure(b, 0);
    const low = h.low, high = h.high, wide = this.plane.wide, tall = this.plane.high;
    const sx = (wide - 20) / (right - left || 1), sy = (tall - 20) / (high - low || 1);
    g.strokeStyle = this.curve[0];
    g.beginPath();
    for (let k = h.first; k < h.count; k++)
      g.lineTo(10 + (h.at(k, a) - left) * sx, tall - 10 - (h.at(k, b) - low) * sy);
    g.stroke();
    g.fillStyle = this.curve[1];
    g.beginPath();
    g.arc(10 + (h.at(h.count - 1, a) - left) * sx, tall - 10 - (h.at(h.count - 1, b) - low) * sy, 4, 0, 7);
    g.fill();
  }

  /* Amplitudes of the last 2^m rows under Hann's window */
  amplitudes(c) {
    const h = this.history, n = 2 ** Math.floor(Math.log2(Math.max(2, Math.min(h.count - h.first, 8192))));
    if (!this.re || this.re.length !== n) {
      this.re = new Float64Array(n);
      this.im = new Float64Array(n);
    }
    let mean = 0;
    for (let k = 0; k < n; k++) mean += h.at(h.count - n + k, c.column) / n;
    for (let k = 0; k < n; k++) {
      this.re[k] = (h.at(h.count - n + k, c.column) - mean) * (1 - Math.cos(2 * Math.PI * k / n)) * 2 / n;
      this.im[k] = 0;
    }
    fourier(this.re, this.im);
    for (let k = 0; k < n / 2; k++) this.re[k] = Math.hypot(this.re[k], this.im[k]);
    return n / 2;
  }

  /* The frequency of the largest amplitude [Hz] */
  findPeak(c) {
    const n = this.amplitudes(c);
    let most = 1;
    for (let k = 1; k < n; k++) if (this.re[k] > this.re[most]) most = k;
    return most / (2 * n * this.model.h * this.history.stride);
  }

  drawSpectrum(g) {
    const c = this.byName.get(this.set.of), peak = this.findPeak(c), n = this.re.length / 2;
    const wide = this.spectrum.wide, tall = this.spectrum.high, unit = 1 / (2 * n * this.model.h * this.history.stride);
    let most = 0;
    for (let k = 1; k < n; k++) most = Math.max(most, this.re[k]);
    g.strokeStyle = this.curve[2];
    g.beginPath();
    for (let k = 1; k < n && most > 0; k++)
      g.lineTo(wide * Math.log(k) / Math.log(n),
               tall - 20 - (tall - 30) * Math.max(0, 1 + Math.log10(this.re[k] / most + 1e-30) / 5));
    g.stroke();
    g.fillStyle = this.ink;
    g.fillText(text(unit) + " Hz", 4, tall - 4);
    g.textAlign = "right";
    g.fillText(text(unit * n) + " Hz", wide - 4, tall - 4);
    g.textAlign = "left";
    this.peak.textContent = "peak at " + text(peak) + " Hz, amplitude " + text(most / c.factor)
      + (c.unit ? " " + c.unit : "") + "; 5 decades";
  }

  /* ---- the sketch ---- */

  drawSketch(g) {
    g.strokeStyle = this.ink;
    g.fillStyle = this.paper;
    if (this.model.draw.length) this.drawPlaces(g);
    else this.drawNetwork(g);
  }

  /* A column as it is now */
  value(column) { return this.history.at(this.history.count - 1, column); }

  /* A number that a drawing reads; -1 is 0 */
  drawn(output) { return output < 0 ? 0 : this.value(1 + output); }

  /* The scale holds all that was seen. */
  drawPlaces(g) {
    const draw = this.model.draw, b = this.box || (this.box = new Float64Array([1e300, -1e300, 1e300, -1e300]));
    for (let i = 0; i < draw.length; i++) {
      const r = draw[i].radius < 0 ? 0 : this.drawn(draw[i].radius);
      for (let k = 0; k < draw[i].at.length; k += 2) {
        const x = this.drawn(draw[i].at[k]), y = this.drawn(draw[i].at[k + 1]);
        if (x - r < b[0]) b[0] = x - r;
        if (x + r > b[1]) b[1] = x + r;
        if (y - r < b[2]) b[2] = y - r;
        if (y + r > b[3]) b[3] = y + r;
      }
    }
    const wide = this.sketch.wide - 60, tall = this.sketch.high - 60;
    const scale = Math.min(wide / (b[1] - b[0] || 1e-9), tall / (b[3] - b[2] || 1e-9), 1e12);
    this.scale = b[1] > b[0] || b[3] > b[2] ? scale : 1;
    this.left = 30 + wide / 2 - this.scale * (b[0] + b[1]) / 2;
    this.base = 30 + tall / 2 + this.scale * (b[2] + b[3]) / 2;
    for (let i = 0; i < draw.length; i++) this.drawPlace(g, draw[i]);
  }

  drawPlace(g, d) {
    const x = this.left + this.scale * this.drawn(d.at[0]), y = this.base - this.scale * this.drawn(d.at[1]);
    const turn = d.turn < 0 ? 0 : -this.drawn(d.turn);
    if (d.what === "mass") this.drawMass(g, x, y, 20);
    else if (d.what === "ground") this.drawLink(g, "ground", x - 20, y, x + 20, y);
    else if (d.at.length === 2) {
      this.drawDisc(g, x, y, d.what === "joint" ? 4 : d.radius < 0 ? 14 : this.scale * this.drawn(d.radius), turn,
                    d.what === "wheel");
    } else {
      const ex = this.left + this.scale * this.drawn(d.at[2]), ey = this.base - this.scale * this.drawn(d.at[3]);
      this.drawLink(g, d.what, x, y, ex, ey);
    }
  }

  drawMass(g, x, y, size) {
    g.fillStyle = this.curve[0];
    g.fillRect(x - size / 2, y - size / 2, size, size);
    g.strokeRect(x - size / 2, y - size / 2, size, size);
  }

  drawDisc(g, x, y, radius, turn, spoke) {
    g.fillStyle = this.paper;
    g.beginPath();
    g.arc(x, y, radius, 0, 2 * Math.PI);
    g.fill();
    g.stroke();
    if (!spoke) return;
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(x + radius * Math.cos(turn), y + radius * Math.sin(turn));
    g.stroke();
  }

  /* A spring is a zigzag, a damper a piston in its cylinder, friction a hatched bar, a stop a gap with a wall. */
  drawLink(g, what, x, y, ex, ey) {
    const length = Math.hypot(ex - x, ey - y), lines = LINES[what];
    g.save();
    g.translate(x, y);
    g.rotate(Math.atan2(ey - y, ex - x));
    g.beginPath();
    for (let k = 0; k < lines.length; k++)
      for (let i = 0; i < lines[k].length; i += 2)
        if (i) g.lineTo(lines[k][i] * length, lines[k][i + 1]);
        else g.moveTo(lines[k][0] * length, lines[k][1]);
    g.stroke();
    g.restore();
  }

  /* Bodies side by side, one for each coordinate, moved in proportion to the largest motion so far */
  drawNetwork(g) {
    const n = this.model.coords, wide = this.sketch.wide, tall = this.sketch.high;
    const column = 1 + this.engine.outputs, apart = (wide - 30) / (n + 0.5);
    const size = Math.max(4, Math.min(36, apart * 0.35));
    if (this.model.elements.length === 0) {
      g.fillStyle = this.ink;
      g.fillText("no bodies to draw: the states are those of modes", 10, tall / 2);
      return;
    }
    for (let i = 0; i < n; i++) this.largest = Math.max(this.largest, Math.abs(this.value(column + i)));
    this.apart = apart;
    this.perUnit = apart * 0.28 / this.largest;
    const middle = tall * 0.4;
    g.beginPath();
    g.moveTo(12, middle - 50);
    g.lineTo(12, tall - 24);
    g.lineTo(wide, tall - 24);
    g.stroke();
    for (let k = 0; k < this.model.elements.length; k++) this.drawElement(g, k, column, middle, size);
    for (let i = 0; i < n; i++) {
      const x = this.bodyAt(i, column);
      if (this.model.states[i].unit === "rad") this.drawDisc(g, x, middle, size / 2, this.value(column + i), true);
      else this.drawMass(g, x, middle, size);
      g.fillStyle = this.ink;
      if (n <= 12) g.fillText(this.model.states[i].name, x - size / 2, middle - size / 2 - 26);
    }
  }

  bodyAt(i, column) { return 12 + (i + 1) * this.apart + this.perUnit * this.value(column + i); }

  /* Links of one pair of bodies lie below each other; what is not next to each other is linked above. */
  drawElement(g, k, column, middle, size) {
    const one = this.model.elements[k], what = one[0], from = one[1], to = one[2];
    if (what === "mass") return;
    let lane = 0;
    for (let j = 0; j < k; j++) {
      const other = this.model.elements[j];
      if (other[0] !== "mass" && other[1] === from && other[2] === to) lane++;
    }
    const a = Math.max(from, to), b = Math.min(from, to), x = this.bodyAt(a, column);
    const y = middle + (lane - 0.5) * Math.min(16, size * 0.6);
    if (what === "force") {
      this.drawLink(g, what, x - 14, middle - size / 2 - 8, x + 14, middle - size / 2 - 8);
    } else if (b < 0 && a > 0) {
      this.drawLink(g, what, x + (lane - 0.5) * 16, middle + size / 2, x + (lane - 0.5) * 16, this.sketch.high - 24);
    } else if (b < 0) {
      this.drawLink(g, what, 12, y, x - size / 2, y);
    } else if (a === b + 1) {
      this.drawLink(g, what, this.bodyAt(b, column) + size / 2, y, x - size / 2, y);
    } else {
      const high = middle - size / 2 - 8 - 7 * (a - b - 1);
      this.drawLink(g, what, this.bodyAt(b, column), high, x, high);
    }
  }

  /* ---- initial values by dragging ---- */

  /* The body next to the pointer: of a network its coordinate, of drawings the output of its x or y; -1: none */
  grabbed(px, py) {
    let nearest = -1, least = 40;
    const look = (what, x, y) => {
      const distance = Math.hypot(px - x, py - y);
      if (distance < least) [nearest, least] = [what, distance];
    };
    if (!this.model.draw.length)
      for (let i = 0; i < this.model.coords && this.model.elements.length; i++)
        look(i, this.bodyAt(i, 1 + this.engine.outputs), this.sketch.high * 0.4);
    for (const d of this.model.draw)
      for (let k = 0; k < d.at.length && d.what !== "ground" && !this.model.constrained; k += 2)
        look(d.at[k] >= 0 ? d.at[k] : d.at[k + 1], this.left + this.scale * this.drawn(d.at[k]),
             this.base - this.scale * this.drawn(d.at[k + 1]));
    return nearest;
  }

  drag(px, py) {
    if (!this.model.draw.length) {
      this.engine.start[this.held] = (px - 12 - (this.held + 1) * this.apart) / this.perUnit;
      return;
    }
    const d = this.model.draw.find((x) => x.at.includes(this.held)), k = d.at.indexOf(this.held) & ~1;
    const goal = [(px - this.left) / this.scale, (this.base - py) / this.scale];
    for (let turn = 0; turn < 20; turn++) this.approach(d.at[k], d.at[k + 1], goal);
  }

  /* A step down the slope of the distance from the goal to the outputs (x, y), by differences of the coordinates */
  approach(x, y, goal) {
    const e = this.engine, from = Float64Array.from(e.start), place = () => {
      e.y.set(e.start);
      e.wasm.set(0);
      e.wasm.look(0);
      return [x < 0 ? 0 : e.rows[1 + x], y < 0 ? 0 : e.rows[1 + y]];
    };
    const at = place(), [rx, ry] = [goal[0] - at[0], goal[1] - at[1]], slopes = [];
    for (let i = 0; i < this.model.coords; i++) {
      e.start[i] = from[i] + 1e-6;
      const moved = place();
      e.start[i] = from[i];
      slopes.push([(moved[0] - at[0]) * 1e6, (moved[1] - at[1]) * 1e6]);
    }
    /* The step that is best along that slope, at most half a unit of a coordinate */
    const down = slopes.map(([u, v]) => u * rx + v * ry);
    const sum = (k) => slopes.reduce((s, d, i) => s + d[k] * down[i], 0);
    const along = down.reduce((s, d) => s + d * d, 0) / (sum(0) ** 2 + sum(1) ** 2 || 1);
    down.forEach((d, i) => { e.start[i] = from[i] + Math.max(-0.5, Math.min(0.5, along * d || 0)); });
  }

  /* ---- events of the page ---- */

  listen() {
    const s = this.sketch, at = (event) => [event.offsetX, event.offsetY];
    s.onpointerdown = (event) => {
      this.held = this.grabbed(...at(event));
      if (this.held < 0) return;
      s.setPointerCapture(event.pointerId);
      this.resumes = this.running;
      this.run(false);
      for (let i = 0; i < this.engine.states; i++) this.engine.start[i] = this.value(1 + this.engine.outputs + i);
    };
    s.onpointermove = (event) => {
      if (this.held < 0) return;
      const largest = this.largest, box = this.box;
      this.drag(...at(event));
      this.forgetPast();
      Object.assign(this, {largest, box});        // The scale stays while a body is held.
    };
    s.onpointerup = s.onpointercancel = () => {
      if (this.held < 0) return;
      this.held = -1;
      this.run(this.resumes);
    };
    this.scope.onpointermove = (event) => this.moveCursor(event.offsetX / this.scope.wide);
    this.scope.onpointerleave = () => { this.cursor = undefined; this.touch(); };
    this.scope.onkeydown = (event) => {
      const by = {ArrowLeft: -0.01, ArrowRight: 0.01, Home: -1, End: 1}[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.moveCursor((this.cursor === undefined ? 1 : this.cursor) + by);
      this.readCursor();
    };
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
      const file = event.dataTransfer.files[0];
      if (file && this.model.inputs.length) file.text().then((t) => this.record(t));
    });
    window.addEventListener("beforeprint", () => this.printNumbers());
    window.addEventListener("resize", () => this.touch());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.colours(); this.wake(); });
  }

  /* On paper the numbers stand where the controls are on the screen. */
  printNumbers() {
    const row = (name, value) => element("tr", {}, element("td", {textContent: name}),
                                         element("td", {textContent: String(value)}));
    const m = this.model, h = this.history, table = element("table", {});
    m.params.forEach((p, i) => table.append(row(p.name, this.engine.params[i])));
    m.states.forEach((s, i) => table.append(row(s.name + " at t = 0", this.engine.start[i])));
    table.append(row("t", h.when(h.count - 1)));
    this.channels.forEach((c) => table.append(row(c.label, h.at(h.count - 1, c.column) / c.factor)));
    this.numbers.replaceChildren(table);
  }
}

/* ---- the start ---- */

/* The functions of the WebAssembly that the page has as text, compressed */
async function compiled(letters) {
  const bytes = Uint8Array.from(atob(letters), (c) => c.charCodeAt(0));
  const whole = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return (await WebAssembly.instantiate(await new Response(whole).arrayBuffer())).instance.exports;
}

async function open() {
  const model = JSON.parse(document.getElementById("model").textContent);
  try {
    window.page = new Page(model, new Engine(model, await compiled(document.getElementById("wasm").textContent)));
  } catch (error) {
    document.body.append(element("p", {role: "alert", className: "wrong", textContent: "The model does not run in this "
      + "browser: " + error.message}));
  }
}

if (typeof module === "undefined") open();
else module.exports = {Engine, compiled};
