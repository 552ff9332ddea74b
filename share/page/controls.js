/* SPDX-License-Identifier: MIT-0 */
/* Controls of a page of plgen --page: what the user sees and changes, and settings that a link restores. */

const withUnit = (v) => v.unit ? v.name + " [" + v.unit + "]" : v.name;
const text = (value) => Number(value.toPrecision(5)).toString();
const element = (tag, properties, ...children) => {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
};
const canvasFor = (label) => element("canvas", {tabIndex: 0, role: "img", ariaLabel: label});
let labels = 0;
const labelled = (name, control, ...more) => {
  control.id = control.id || "c" + ++labels;
  return element("div", {className: "row"}, element("label", {htmlFor: control.id, textContent: name}), control,
                 ...more);
};
const section = (title, ...parts) => element("section", {}, element("h2", {textContent: title}), ...parts);
const pane = (title, rows) =>
  rows.length ? element("section", {className: "controls"}, element("h2", {textContent: title}), ...rows) : "";
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);

class Controls {
  constructor(page) {
    const m = page.model;
    this.page = page;
    this.model = m;
    this.engine = page.engine;
    this.said = element("p", {role: "status", className: "said"});
    this.wrong = element("p", {role: "alert", className: "wrong"});
    this.now = element("output", {className: "now"});
    this.numbers = element("div", {className: "numbers"});
    this.selects = {};
    const r = page.response;
    document.body.append(
      element("header", {}, element("h1", {textContent: m.title}),
        element("p", {textContent: m.states.length + " states, step " + text(m.h) + " s; as plrun --math own"})),
      element("main", {}, this.buttons(), this.said, this.wrong,
        element("div", {className: "panes"},
          section("Sketch", page.sketch.canvas), section("Scope", page.scope.canvas, page.scope.read, this.choices()),
          section("Phase plane", page.plane.canvas, labelled("Across", this.select("x", page.channels)),
                  labelled("Up", this.select("y", page.channels))),
          section("Spectrum", page.spectrum.canvas, labelled("Of", this.select("of", page.channels)),
                  page.spectrum.said),
          r.drives.length ? section("Frequency response", r.canvas, labelled("To", this.select("to", page.channels)),
                                    labelled("By", this.select("by", r.drives)), r.said) : "",
          this.tunables(), this.inputs(), this.initials()),
        this.numbers,
        element("details", {}, element("summary", {textContent: "The model's text"}),
          element("pre", {textContent: m.spec}))));
  }

  button(name, action) { return element("button", {type: "button", textContent: name, onclick: action}); }

  /* A page inside of another has no address of its own. */
  buttons() {
    const page = this.page;
    this.play = this.button("Run", () => page.run(!page.running));
    this.speed = element("input", {type: "range", min: -4, max: 3, step: 0.1});
    this.speed.oninput = () => this.change("speed", Number((10 ** this.speed.value).toPrecision(2)));
    this.window = element("input", {type: "range", min: -3, max: 4, step: 0.1});
    this.window.oninput = () => {
      this.change("window", Number((10 ** this.window.value).toPrecision(2)));
      page.begin();
    };
    this.speedText = element("output", {});
    this.windowText = element("output", {});
    return element("div", {className: "bar"}, this.play, this.button("Step", () => page.single()),
      this.button("Reset", () => this.forget()), window.top === window ? this.button("Link", () => this.link()) : "",
      this.button("CSV", () => this.save()), this.button("Sound", () => this.sound()),
      labelled("Speed", this.speed, this.speedText), labelled("Time shown", this.window, this.windowText), this.now);
  }

  change(name, value) {
    this.page.set[name] = value;
    this.showSettings();
    this.page.touch();
  }

  showSettings() {
    const s = this.page.set;
    this.speed.value = Math.log10(s.speed);
    this.window.value = Math.log10(s.window);
    this.speedText.textContent = text(s.speed) + " \u00d7";
    this.windowText.textContent = text(s.window) + " s";
    this.boxes.forEach((b) => { b.checked = s.show.includes(b.value); });
    Object.keys(this.selects).forEach((key) => { this.selects[key].value = s[key]; });
  }

  choices() {
    const list = element("fieldset", {className: "choices"}, element("legend", {textContent: "Shown"}));
    this.boxes = this.page.channels.map((c) => {
      const box = element("input", {type: "checkbox", value: c.name});
      box.onchange = () => this.change("show", this.boxes.filter((b) => b.checked).map((b) => b.value));
      list.append(element("label", {}, box, " " + c.label));
      return box;
    });
    return list;
  }

  select(setting, list) {
    const s = element("select", {});
    list.forEach((c) => s.append(element("option", {value: c.name, textContent: c.label || withUnit(c)})));
    s.onchange = () => {
      this.page.spectrumAt = undefined;
      this.change(setting, s.value);
    };
    this.selects[setting] = s;
    return s;
  }

  /* ---- params ---- */

  /* A number field beside a slider says and takes any value; both are in the param's own unit. */
  tunables() {
    this.sliders = [];
    return pane("Params", this.model.params.map((p, i) => {
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
    this.page.changes++;
    this.page.touch();
  }

  /* ---- inputs ---- */

  inputs() {
    this.signalRows = [];
    return pane("Inputs", this.model.inputs.map((input, i) => {
      const s = this.engine.signals[i], fields = {}, kind = element("select", {});
      [["hold", "constant"], ["step", "step"], ["sine", "sine"], ["noise", "noise"], ["record", "CSV file"]].forEach(
        ([value, name]) => kind.append(element("option", {value, textContent: name})));
      kind.onchange = () => { s.kind = kind.value; this.page.forgetPast(); };
      const field = (key, name) => {
        fields[key] = element("input", {type: "number", step: "any", value: s[key]});
        fields[key].oninput = () => { s[key] = Number(fields[key].value) || 0; };
        return labelled(name, fields[key]);
      };
      const file = element("input", {type: "file", accept: ".csv,text/csv"});
      file.onchange = () => this.take(file.files[0]);
      this.signalRows.push({kind, fields});
      return element("fieldset", {}, element("legend", {textContent: withUnit(input)}), labelled("Signal", kind),
        field("level", "Level"), field("size", "Amplitude"),
        field("rate", "Frequency [Hz], or time of the step [s]"), labelled("Samples", file));
    }));
  }

  take(file) { if (file && this.model.inputs.length) file.text().then((t) => this.record(t)); }

  /* Columns by the names of inputs, a row for each step; without a line of names in the inputs' order. */
  record(csv) {
    const lines = csv.split(/\r?\n/).filter((l) => l.trim() && l[0] !== "#").map((l) => l.split(","));
    const inputs = this.model.inputs, named = lines.length > 0 && lines[0].some((w) => Number.isNaN(Number(w)));
    const head = named ? lines.shift().map((w) => w.trim()) : inputs.map((x) => x.name);
    let taken = 0;
    this.wrong.textContent = "";
    inputs.forEach((input, i) => {
      const column = head.indexOf(input.name);
      if (column < 0) return;
      const record = Float64Array.from(lines, (l) => l[column] && l[column].trim() ? Number(l[column]) : NaN);
      const bad = record.findIndex((x) => !Number.isFinite(x));
      if (!record.length || bad >= 0) {
        this.wrong.textContent = "the column of " + input.name + (bad < 0 ? " has no row" : " has no number in row "
          + (bad + 1));
        return;
      }
      Object.assign(this.engine.signals[i], {record, kind: "record"});
      this.signalRows[i].kind.value = "record";
      taken++;
    });
    this.said.textContent = taken ? lines.length + " samples, one for each step" : "no column was taken for an input";
    const wrong = this.wrong.textContent;
    this.page.forgetPast();
    this.wrong.textContent = wrong;
  }

  /* ---- initial values ---- */

  initials() {
    const m = this.model;
    if (m.states.length > 64) return "";
    this.startFields = m.states.map((s, i) => {
      const field = element("input", {type: "number", step: "any"});
      field.onchange = () => this.place(i, Number(field.value) * (s.factor || 1));
      return field;
    });
    return pane("Initial values", m.states.map((s, i) => labelled(withUnit(s), this.startFields[i])));
  }

  place(i, value) {
    if (Number.isFinite(value)) this.engine.start[i] = value;
    this.page.forgetPast();
  }

  showStart() {
    (this.startFields || []).forEach((f, i) => {
      f.value = Number((this.engine.start[i] / (this.model.states[i].factor || 1)).toPrecision(12));
    });
  }

  /* ---- what buttons do ---- */

  forget() {
    const e = this.engine;
    e.params.set(e.nominal);
    e.start.set(e.given);
    e.tuned = false;
    this.showParams();
    this.page.forgetPast();
    if (location.hash) history.replaceState(null, "", location.pathname + location.search);
  }

  /* Settings as text behind the page's address: what differs from the spec */
  link() {
    const e = this.engine, m = this.model, all = {p: {}, y: {}, u: {}, s: this.page.set};
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
    const e = this.engine, m = this.model;
    const taken = (list, values, to) => list.forEach((v, i) => {
      if (values && Object.hasOwn(values, v.name) && isNumber(values[v.name])) to[i] = values[v.name];
    });
    taken(m.params, all.p, e.params);
    taken(m.states, all.y, e.start);
    m.inputs.forEach((input, i) => {
      const from = (all.u || {})[input.name] || {}, s = e.signals[i], row = this.signalRows[i];
      ["level", "size", "rate"].forEach((key) => { if (isNumber(from[key])) s[key] = from[key]; });
      if (["hold", "step", "sine", "noise"].includes(from.kind)) s.kind = from.kind;
      row.kind.value = s.kind;
      Object.keys(row.fields).forEach((key) => { row.fields[key].value = s[key]; });
    });
    this.restoreSettings(all.s || {});
    if (e.reset()) {
      e.params.set(e.nominal);
      e.reset();
      this.said.textContent = "the model cannot have the params in the page's address";
    }
    this.showParams();
    this.showSettings();
  }

  restoreSettings(from) {
    const set = this.page.set, has = (select, name) => [...select.options].some((o) => o.value === name);
    ["speed", "window"].forEach((key) => { if (isNumber(from[key]) && from[key] > 0) set[key] = from[key]; });
    Object.keys(this.selects).forEach((key) => { if (has(this.selects[key], from[key])) set[key] = from[key]; });
    if (Array.isArray(from.show)) set.show = from.show.filter((name) => this.page.byName.has(name));
  }

  save() {
    const h = this.page.history, channels = this.page.channels, line = (values) => values.join(",") + "\n";
    const rows = [line(["t", ...channels.map((c) => c.name)])];
    for (let k = h.first; k < h.count; k++) rows.push(line([h.when(k), ...channels.map((c) => h.at(k, c.column))]));
    const a = element("a", {href: URL.createObjectURL(new Blob(rows, {type: "text/csv"})),
                            download: this.model.name + ".csv"});
    a.click();
    setTimeout(() => URL.revokeObjectURL(a.href), 1000);
  }

  /* The time that is shown, as it would be heard; at most two seconds */
  sound() {
    const h = this.page.history, c = this.page.byName.get(this.page.set.of), rate = 1 / (this.model.h * h.stride);
    const length = Math.min(h.count - h.first, Math.floor(2 * rate)), first = h.count - length;
    const peak = this.page.spectrum.findPeak(c);
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
    this.source = this.audio.createBufferSource();
    this.source.buffer = out;
    this.source.connect(this.audio.destination);
    this.source.start();
    this.said.textContent = "sound of " + c.name + ": " + text(peak) + " Hz";
  }

  /* On paper the numbers stand where the controls are on the screen. */
  printNumbers() {
    const row = (name, value) => element("tr", {}, element("td", {textContent: name}),
                                         element("td", {textContent: String(value)}));
    const m = this.model, h = this.page.history, table = element("table", {});
    m.params.forEach((p, i) => table.append(row(p.name, this.engine.params[i])));
    m.states.forEach((s, i) => table.append(row(s.name + " at t = 0", this.engine.start[i])));
    table.append(row("t", h.when(h.count - 1)));
    this.page.channels.forEach((c) => table.append(row(c.label, h.at(h.count - 1, c.column) / c.factor)));
    this.numbers.replaceChildren(table);
  }
}
