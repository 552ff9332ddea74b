/* SPDX-License-Identifier: MIT-0 */
/* The first part of the script of a page of plgen --page: an engine drives the model's WebAssembly. The loop of a frame
 * allocates nothing: all arrays are made at the start. */
"use strict";

/* ---- the engine: the model, and the samples of its inputs ---- */

const STATUS = [
  [1, "a state is infinite or not a number"], [2, "a step has met more crossings than its bound"],
  [4, "a step needed more substeps than its bound"], [8, "the last terms of a step are above the tolerance"],
  [16, "what is to stick and what is to slip at an event had no answer"],
  [32, "a state has left the range that the spec gives it"], [64, "a step has ended beyond a stop"],
  [128, "the mass matrix is singular"]];

class Engine {
  constructor(model, wasm) {
    const memory = wasm.memory.buffer, at = (what, length) => new Float64Array(memory, wasm.place(what), length);
    this.model = model;
    this.wasm = wasm;
    this.most = wasm.place(4);
    this.states = model.states.length;
    this.outputs = model.outputs.length + model.hidden;
    this.columns = 1 + this.outputs + this.states;
    this.y = at(0, this.states);
    this.params = at(1, model.params.length);
    this.u = at(2, this.most * model.inputs.length);
    this.rows = at(3, this.most * this.columns);
    this.params.set(model.params.map((p) => p.value));
    this.nominal = Float64Array.from(this.params);
    this.signals = model.inputs.map(() => ({kind: "step", level: 0, size: 1, rate: 1, record: null}));
    this.ahead = Math.max(0, ...model.ahead);
    wasm.init();
    this.start = Float64Array.from(this.y);         // The initial values that a reset takes.
    this.given = Float64Array.from(this.y);         // Those of the spec.
    this.reset();
  }

  /* Goes to t = 0 with the params and initial values as they are now; returns 0, or why it cannot. */
  reset() {
    this.count = 0;
    this.wasm.init();
    const wrong = this.tune();
    if (this.start.some((value, i) => value !== this.given[i])) {
      this.y.set(this.start);
      this.wasm.set(0);
    }
    for (let k = 0; k < this.ahead; k++) {
      for (let i = 0; i < this.signals.length; i++)
        this.u[i] = this.sample(i, this.model.ahead[i] ? k - this.ahead + this.model.ahead[i] : k);
      this.wasm.hold();
    }
    this.wasm.look(0);
    return wrong;
  }

  /* The params of the spec need no new numbers, so their run is that of the spec to the last bit. */
  tune() {
    const same = !this.tuned && this.params.every((value, i) => value === this.nominal[i]);
    this.tuned = !same;
    return same ? 0 : this.wasm.tune();
  }

  /* Sample k of an input. Noise is a number of k alone, so a run can be repeated. */
  sample(i, k) {
    const s = this.signals[i], t = k * this.model.h;
    if (k < 0) return 0;
    if (s.kind === "step") return t < s.rate ? s.level : s.level + s.size;
    if (s.kind === "sine") return s.level + s.size * Math.sin(2 * Math.PI * s.rate * t);
    if (s.kind === "record") return s.record && k < s.record.length ? s.record[k] : 0;
    if (s.kind !== "noise") return s.level;
    let sum = 0, x = Math.imul(k + 1, 0x9e3779b1) ^ Math.imul(i + 1, 0x85ebca6b);
    for (let m = 0; m < 4; m++) {
      x = Math.imul(x ^ x >>> 15, 0x2c1b3c6d);
      x ^= x >>> 12;
      sum += (x >>> 0) / 4294967296 - 0.5;
    }
    return s.level + s.size * sum * Math.sqrt(3);
  }

  /* Takes n steps, at most `most`; their rows are in `rows`. Returns the status. */
  run(n) {
    const inputs = this.signals.length;
    for (let k = 0; k < n; k++)
      for (let i = 0; i < inputs; i++)
        this.u[k * inputs + i] = this.sample(i, this.count + k + this.model.ahead[i]);
    this.count += n;
    return this.wasm.steps(n);
  }
}

/* The rows of the time that is shown: every `stride` steps one, in a ring. */
class History {
  constructor(columns) {
    this.columns = columns;
    this.room = Math.max(1024, Math.min(32768, Math.floor(4e6 / columns)));
    this.value = new Float64Array(this.room * columns);
    this.time = new Float64Array(this.room);
    this.clear(1);
  }

  clear(stride) {
    this.stride = stride;
    this.count = this.skipped = this.events = 0;
  }

  add(rows, k, t) {
    this.events += rows[k * this.columns];
    if (this.count && ++this.skipped < this.stride) return;
    const place = this.count++ % this.room, from = k * this.columns;
    this.skipped = 0;
    this.time[place] = t;
    for (let i = 1; i < this.columns; i++) this.value[place * this.columns + i] = rows[from + i];
    this.value[place * this.columns] = this.events;
  }

  /* Sets low and high to the least and largest value of a column from the time `start` on. */
  measure(column, start) {
    this.low = Infinity;
    this.high = -Infinity;
    for (let k = this.first; k < this.count; k++) {
      const x = this.at(k, column);
      if (x < this.low && this.when(k) >= start) this.low = x;
      if (x > this.high && this.when(k) >= start) this.high = x;
    }
  }

  get first() { return Math.max(0, this.count - this.room); }
  at(k, column) { return this.value[k % this.room * this.columns + column]; }
  when(k) { return this.time[k % this.room]; }
}

/* In place, of 2^m numbers: the sums over e^{-2 pi i jk/n}. */
function fourier(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [re[i], re[j]] = [re[j], re[i]];
      [im[i], im[j]] = [im[j], im[i]];
    }
  }
  for (let size = 2; size <= n; size *= 2)
    for (let k = 0; k < size / 2; k++) {
      const angle = -2 * Math.PI * k / size, c = Math.cos(angle), s = Math.sin(angle);
      for (let i = k; i < n; i += size) {
        const j = i + size / 2, x = c * re[j] - s * im[j], y = c * im[j] + s * re[j];
        re[j] = re[i] - x;
        im[j] = im[i] - y;
        re[i] += x;
        im[i] += y;
      }
    }
}
