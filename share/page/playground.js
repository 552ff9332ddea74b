/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The script of build/playground.html: the generator in a page. An editor has a spec; plgen, as WebAssembly, reads it
 * from files that are texts here, and writes messages, C, and the page of the model, which is shown in a frame and
 * calls back into this plgen, where the model's code is emulated (playground.c). */
"use strict";

/* ---- what plgen asks of a system: WASI, as far as it goes ---- */

const PAGE = "page.html";

class Left extends Error {}
class Ended extends Error {}

class Generator {
  constructor(module, files) {
    this.files = files;
    this.names = Object.keys(files);
    this.open = [{}, {text: ""}, {text: ""}, {}];     // Standard input, output, errors; the folder
    this.page = {text: ""};
    this.begun = performance.now();
    const none = () => 52;
    const wasi = new Proxy({}, {get: (_, name) => this[name] ? (...all) => this[name](...all) : none});
    const missing = (name) => () => { throw new Error(name + " is not there in a page"); };
    const env = new Proxy({}, {get: (_, name) => name.startsWith("sem_") ? () => 0 : missing(name)});
    const page = {leave: () => { throw new Left(); }, ends: (work, context) => this.ends(work, context)};
    const imports = {wasi_snapshot_preview1: {}, env: {}, page};
    for (const i of WebAssembly.Module.imports(module))
      if (i.module !== "page") imports[i.module][i.name] = (i.module === "env" ? env : wasi)[i.name];
    this.wasm = new WebAssembly.Instance(module, {...imports}).exports;
  }

  /* Its exit status; what it wrote is in `text(1)`, `text(2)` and `page` */
  run(...words) {
    this.words = ["plgen", ...words].map((word) => new TextEncoder().encode(word + "\0"));
    try {
      this.wasm._start();
    } catch (error) {
      if (!(error instanceof Ended)) {
        this.open[2].text += "plgen: error: " + (error instanceof RangeError || /stack/.test(error.message)
          ? "this takes a deeper stack than a page has" : error.message) + "\n";
        return 1;
      }
      return this.status;
    }
    return 0;
  }

  text(descriptor) { return this.open[descriptor].text; }

  /* The functions that a model's page calls */
  get model() {
    const {call, memory} = this.wasm;
    return {memory, place: (what) => call(0, what, 0), init: () => call(1, 0, 0), set: (t) => call(2, 0, t),
            tune: () => call(3, 0, 0), hold: () => call(4, 0, 0), look: (k) => call(5, k, 0),
            steps: (n) => call(6, n, 0), probe: () => call(7, 0, 0), time: () => call(8, 0, 0)};
  }

  ends(work, context) {
    const {__stack_pointer: stack, __indirect_function_table: table} = this.wasm, kept = stack.value;
    try {
      table.get(work)(context);
      return 1;
    } catch (error) {
      if (!(error instanceof Left)) throw error;
      stack.value = kept;
      return 0;
    }
  }

  get view() { return new DataView(this.wasm.memory.buffer); }
  bytes(at, length) { return new Uint8Array(this.wasm.memory.buffer, at, length); }
  put(at, value) { this.view.setUint32(at, value, true); return 0; }
  name(at, length) { return new TextDecoder().decode(this.bytes(at, length).slice()).replace(/^(\.?\/)+/, ""); }

  list(words, at, texts) {
    for (const word of words) {
      this.put(at, texts);
      this.bytes(texts, word.length).set(word);
      at += 4;
      texts += word.length;
    }
    return 0;
  }

  args_sizes_get(count, size) {
    this.put(count, this.words.length);
    return this.put(size, this.words.reduce((sum, word) => sum + word.length, 0));
  }
  args_get(at, texts) { return this.list(this.words, at, texts); }
  environ_sizes_get(count, size) { return this.put(count, 0) + this.put(size, 0); }
  environ_get() { return 0; }
  clock_time_get(clock, precision, at) {
    this.view.setBigUint64(at, BigInt(Math.round((performance.now() - this.begun) * 1e6)), true);
    return 0;
  }
  proc_exit(status) {
    this.status = status;
    throw new Ended();
  }

  fd_prestat_get(d, at) { return d === 3 ? this.put(at, 0) + this.put(at + 4, 1) : 8; }
  fd_prestat_dir_name(d, at, length) {
    this.bytes(at, length).fill(46);
    return 0;
  }
  fd_fdstat_get(d, at) {
    if (!this.open[d]) return 8;
    this.bytes(at, 24).fill(0);
    this.bytes(at, 1)[0] = d === 3 ? 3 : this.open[d].bytes ? 4 : 2;
    this.bytes(at + 8, 16).fill(255);
    return 0;
  }

  /* The page is written as a device is, so nothing is put beside it. */
  stat(name, at) {
    if (name !== PAGE && !(name in this.files) && name !== ".") return 44;
    this.bytes(at, 64).fill(0);
    this.put(at + 8, 1 + this.names.indexOf(name));
    this.bytes(at + 16, 1)[0] = name === PAGE ? 2 : name === "." ? 3 : 4;
    if (name in this.files) this.put(at + 32, new TextEncoder().encode(this.files[name]).length);
    return 0;
  }
  path_filestat_get(d, flags, path, length, at) { return this.stat(this.name(path, length), at); }
  fd_filestat_get(d, at) { return this.open[d] && this.open[d].name ? this.stat(this.open[d].name, at) : 8; }
  path_open(d, flags, path, length, how, rights, inherited, modes, at) {
    const name = this.name(path, length);
    if (name !== PAGE && !(name in this.files)) return 44;
    const file = name === PAGE ? this.page : {bytes: new TextEncoder().encode(this.files[name]), at: 0};
    file.name = name;
    this.open.push(file);
    return this.put(at, this.open.length - 1);
  }
  fd_close() { return 0; }
  fd_seek(d, by, from, at) {
    const file = this.open[d];
    if (!file.bytes) return 29;
    file.at = Number(by) + (from === 0 ? 0 : from === 1 ? file.at : file.bytes.length);
    this.view.setBigUint64(at, BigInt(file.at), true);
    return 0;
  }

  fd_read(d, blocks, count, at) {
    const file = this.open[d];
    let read = 0;
    for (let k = 0; k < count && file.bytes; k++) {
      const length = this.view.getUint32(blocks + 8 * k + 4, true);
      const part = file.bytes.subarray(file.at, file.at + length);
      this.bytes(this.view.getUint32(blocks + 8 * k, true), part.length).set(part);
      file.at += part.length;
      read += part.length;
    }
    return this.put(at, read);
  }
  fd_write(d, blocks, count, at) {
    const file = this.open[d];
    let written = 0;
    file.decoder = file.decoder || new TextDecoder();
    for (let k = 0; k < count; k++) {
      const length = this.view.getUint32(blocks + 8 * k + 4, true);
      file.text += file.decoder.decode(this.bytes(this.view.getUint32(blocks + 8 * k, true), length).slice(),
                                       {stream: true});
      written += length;
    }
    return this.put(at, written);
  }
}

/* ---- the editor ---- */

const STYLE = `#edit { position: relative; } #edit > *, pre { font: 14px/1.4 monospace; margin: 0; overflow: auto; }
#spec { width: calc(100% - 3rem); margin-left: 3rem; padding: 3px; color: inherit; background: inherit;
border: 1px solid var(--faint); } #said { margin: .4rem 0; } #c { max-height: 40rem; }
#lines { position: absolute; inset: 4px auto 0 0; width: 2.6rem; overflow: hidden; text-align: right; }
#said button { font: inherit; padding: 0; border: 0; color: var(--accent); text-align: left; }
.bar input[type="file"] { width: auto; } #shown { width: 100%; height: 60rem; border: 1px solid var(--faint); }`;

const $ = (id) => document.getElementById(id);

class Playground {
  constructor(module, models) {
    const style = new CSSStyleSheet();
    style.replaceSync(STYLE);
    document.adoptedStyleSheets = [style];
    this.module = module;
    this.models = models;
    const names = Object.keys(models).filter((name) => /^model /m.test(models[name]));
    $("from").append(...names.map((name) => new Option(name)));
    $("from").value = "two_masses.spec";
    $("from").onchange = () => this.take($("from").value, models[$("from").value]);
    $("spec").oninput = () => this.number([]);
    $("spec").onscroll = () => { $("lines").scrollTop = $("spec").scrollTop; };
    $("spec").onkeydown = (event) => { if (event.key === "Enter" && event.ctrlKey) this.run(); };
    $("run").onclick = () => this.run();
    $("open").onchange = async (event) => this.take(event.target.files[0].name, await event.target.files[0].text());
    $("save").onclick = () => this.download(this.name, $("spec").value);
    $("code").ontoggle = () => this.showCode();
    $("keep").onclick = () => this.download(this.name.replace(/(\.spec)?$/, "_pl.c"), $("c").textContent);
    this.take("two_masses.spec", models["two_masses.spec"]);
  }

  take(name, text) {
    this.name = name;
    $("spec").value = text;
    this.run();
  }

  generator() { return new Generator(this.module, {...this.models, [this.name]: $("spec").value}); }

  /* Lines by number; those that a message is about are marked. */
  number(marked) {
    const count = $("spec").value.split("\n").length;
    $("lines").replaceChildren(...Array.from({length: count}, (_, i) => Object.assign(document.createElement("div"),
      {textContent: i + 1, className: marked.includes(i + 1) ? "wrong" : ""})));
  }

  run() {
    const plgen = this.generator(), status = plgen.run("--page", PAGE, this.name);
    this.say(plgen.text(2));
    $("shown").hidden = status !== 0;
    window.model = status === 0 ? plgen.model : null;
    $("shown").srcdoc = status === 0 ? plgen.page.text : "";
    this.showCode();
  }

  /* Messages as plgen writes them; the place of one is a button that goes there. */
  say(text) {
    const marked = [], parts = text.split("\n").filter((line) => line).map((line) => {
      const found = line.match(/^(.*):(\d+):(\d+): /);
      if (!found || found[1] !== this.name) return line + "\n";
      marked.push(Number(found[2]));
      const button = Object.assign(document.createElement("button"), {type: "button", textContent: line});
      button.onclick = () => this.go(Number(found[2]), Number(found[3]));
      return button;
    });
    $("said").replaceChildren(...parts.flatMap((part) => part instanceof Element ? [part, "\n"] : [part]));
    this.number(marked);
    const first = text.match(/^(.*):(\d+):(\d+): error: /m);
    if (first && first[1] === this.name) this.go(Number(first[2]), Number(first[3]));
  }

  /* Columns count bytes. */
  go(line, column) {
    const lines = $("spec").value.split("\n"), before = lines.slice(0, line - 1).join("\n").length + (line > 1);
    const bytes = new TextEncoder().encode(lines[line - 1] || "").subarray(0, column - 1);
    const at = before + new TextDecoder().decode(bytes).length;
    $("spec").focus();
    $("spec").setSelectionRange(at, at + 1);
  }

  showCode() {
    if (!$("code").open) return;
    const plgen = this.generator();
    plgen.run(this.name);
    $("c").textContent = plgen.text(1);
  }

  download(name, text) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text]));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
}

if (typeof module === "undefined")
  inflated("plgen").then((bytes) => WebAssembly.compile(bytes)).then((wasm) => {
    window.playground = new Playground(wasm, JSON.parse($("models").textContent));
  });
else module.exports = {Generator};
