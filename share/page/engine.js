/* SPDX-License-Identifier: MIT-0 */
/* The first part of the script of a page of plgen --page: an engine drives the model's WebAssembly, a history keeps its
 * rows, a response is the frequency response of its step. The loop of a frame allocates nothing: all arrays are made at
 * the start. */
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

/* Exchanges two numbers of an array; what is written [a, b] = [b, a] makes an array each time. */
function exchange(list, i, j) {
  const kept = list[i];
  list[i] = list[j];
  list[j] = kept;
}

/* In place, of 2^m numbers: the sums over e^{-2 pi i jk/n}. */
function fourier(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      exchange(re, i, j);
      exchange(im, i, j);
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

/* ---- the frequency response of the step, linear about the state as it is now ---- */

/* What drives it: an input as sampled, or a jump by 1 of a velocity (where there are none, of a state) */
function drivesOf(model) {
  const inputs = model.inputs.map((u, i) => ({...u, input: i, ahead: model.ahead[i]})).filter((u) => u.ahead < 2);
  const fast = model.states.some((s) => s.name.endsWith("'"));
  const jumps = model.states.map((s, i) => ({name: "a jump of " + s.name, state: i, moves: s.name}));
  return inputs.concat(jumps.filter((s) => !fast || s.moves.endsWith("'")));
}

class StepResponse {
  constructor(engine, points) {
    const n = engine.states;
    this.engine = engine;
    this.points = points;
    this.map = new Float64Array(n * n);             // The states after a step by the states before it
    this.reads = new Float64Array(n);               // The output after a step by those states
    this.before = new Float64Array(n);              // The states after a step by the sample before it,
    this.after = new Float64Array(n);               // and by that of the step; then what a sine with z adds
    this.re = new Float64Array(n * n);
    this.im = new Float64Array(n * n);
    this.x = new Float64Array(n);
    this.xi = new Float64Array(n);
    this.at = new Float64Array(n);                  // The state now
    this.kept = new Float64Array(engine.columns);
    this.frequency = new Float64Array(points);      // [Hz]
    this.amplitude = new Float64Array(points);
  }

  /* A central difference of what a step makes, by state i, or (i < 0) by a sample: 0 before the step, 1 of the step */
  difference(i, sample, drive) {
    const e = this.engine, m = e.signals.length, from = 1 + e.outputs;
    const of = i < 0 ? sample * m + drive.input : 0, size = this.sizeOf(i);
    const probe = (by) => {
      for (let k = 0; k < m; k++) {
        e.u[k] = e.sample(k, e.count - 1 + e.model.ahead[k]);
        e.u[m + k] = e.sample(k, e.count + e.model.ahead[k]);
      }
      e.y.set(this.at);
      if (i < 0) e.u[of] += by;
      else e.y[i] += by;
      e.wasm.probe();
    };
    probe(size);
    this.kept.set(e.rows.subarray(0, e.columns));
    probe(-size);
    for (let k = 0; k < e.columns; k++) this.kept[k] = (this.kept[k] - e.rows[k]) / (2 * size);
    return from;
  }

  /* 1e-4 of the largest coordinate, or of the largest velocity */
  sizeOf(i) {
    const n = this.engine.model.coords;
    let largest = 0;
    if (i >= 0)
      for (let k = i < n ? 0 : n; k < (i < n ? n : this.engine.states); k++)
        largest = Math.max(largest, Math.abs(this.at[k]));
    return 1e-4 * (largest || 1);
  }

  /* Of the output in this column of a row, times a factor; from the frequency `lowest` [Hz] */
  measure(drive, column, factor, lowest) {
    const e = this.engine, n = e.states;
    e.wasm.look(0);
    this.at.set(e.rows.subarray(1 + e.outputs, 1 + e.outputs + n));
    for (let i = 0; i < n; i++) {
      const from = this.difference(i, 0, drive);
      for (let k = 0; k < n; k++) this.map[k * n + i] = this.kept[from + k];
      this.reads[i] = factor * this.kept[column];
    }
    this.direct = [0, 0];
    [this.before, this.after].forEach((to, sample) => {
      if (drive.input === undefined) {
        for (let k = 0; k < n; k++) to[k] = sample ? 0 : this.map[k * n + drive.state] * e.model.h;
        this.direct[sample] = sample ? 0 : this.reads[drive.state] * e.model.h;
        return;
      }
      const from = this.difference(-1, sample, drive);
      for (let k = 0; k < n; k++) to[k] = this.kept[from + k];
      this.direct[sample] = factor * this.kept[column];
    });
    this.reduce();
    this.sweep(lowest);
  }

  /* To upper Hessenberg form by elimination, so that a frequency takes n^2 products */
  reduce() {
    const n = this.engine.states, a = this.map, columns = [this.before, this.after], reads = this.reads;
    for (let m = 1; m < n - 1; m++) {
      let pivot = m;
      for (let i = m; i < n; i++)
        if (Math.abs(a[i * n + m - 1]) > Math.abs(a[pivot * n + m - 1])) pivot = i;
      if (pivot !== m) {
        for (let j = 0; j < n; j++) exchange(a, m * n + j, pivot * n + j);
        for (let i = 0; i < n; i++) exchange(a, i * n + m, i * n + pivot);
        for (const b of [...columns, reads]) exchange(b, m, pivot);
      }
      for (let i = m + 1; i < n && a[m * n + m - 1] !== 0; i++) {
        const by = a[i * n + m - 1] / a[m * n + m - 1];
        if (by === 0) continue;
        for (let j = 0; j < n; j++) a[i * n + j] -= by * a[m * n + j];
        for (let k = 0; k < n; k++) a[k * n + m] += by * a[k * n + i];
        for (const b of columns) b[i] -= by * b[m];
        reads[m] += by * reads[i];
      }
    }
  }

  /* The output's amplitude at f [Hz]: |reads (z - map)^-1 (before + z after) + direct|, z = e^{2 pi i f h} */
  amplitudeAt(f) {
    const n = this.engine.states, {re, im, x, xi} = this, angle = 2 * Math.PI * f * this.engine.model.h;
    const c = Math.cos(angle), s = Math.sin(angle);
    for (let k = 0; k < n * n; k++) {
      re[k] = -this.map[k];
      im[k] = 0;
    }
    for (let k = 0; k < n; k++) {
      re[k * n + k] += c;
      im[k * n + k] = s;
      x[k] = this.before[k] + c * this.after[k];
      xi[k] = s * this.after[k];
    }
    for (let k = 0; k + 1 < n; k++) this.eliminate(k);
    let sum = this.direct[0] + c * this.direct[1], other = s * this.direct[1];
    for (let k = n - 1; k >= 0; k--) {
      for (let j = k + 1; j < n; j++) {
        x[k] -= re[k * n + j] * x[j] - im[k * n + j] * xi[j];
        xi[k] -= re[k * n + j] * xi[j] + im[k * n + j] * x[j];
      }
      const p = re[k * n + k], q = im[k * n + k], size = p * p + q * q, u = (x[k] * p + xi[k] * q) / size;
      xi[k] = (xi[k] * p - x[k] * q) / size;
      x[k] = u;
      sum += this.reads[k] * x[k];
      other += this.reads[k] * xi[k];
    }
    return Math.sqrt(sum * sum + other * other);
  }

  /* Row k + 1 less a multiple of row k, the larger of the two above */
  eliminate(k) {
    const n = this.engine.states, {re, im, x, xi} = this, a = k * n, b = a + n;
    if (re[b + k] * re[b + k] + im[b + k] * im[b + k] > re[a + k] * re[a + k] + im[a + k] * im[a + k]) {
      for (let j = k; j < n; j++) {
        exchange(re, a + j, b + j);
        exchange(im, a + j, b + j);
      }
      exchange(x, k, k + 1);
      exchange(xi, k, k + 1);
    }
    const p = re[a + k], q = im[a + k], size = p * p + q * q;
    if (size === 0) return;
    const u = (re[b + k] * p + im[b + k] * q) / size, v = (im[b + k] * p - re[b + k] * q) / size;
    for (let j = k; j < n; j++) {
      re[b + j] -= u * re[a + j] - v * im[a + j];
      im[b + j] -= u * im[a + j] + v * re[a + j];
    }
    x[k + 1] -= u * x[k] - v * xi[k];
    xi[k + 1] -= u * xi[k] + v * x[k];
  }

  /* From `lowest` to half the rate of the steps; a point next to a peak is moved onto it. */
  sweep(lowest) {
    const f = this.frequency, a = this.amplitude, last = this.points - 1, ratio = 0.5 / this.engine.model.h / lowest;
    for (let k = 0; k <= last; k++) {
      f[k] = lowest * ratio ** (k / last);
      a[k] = this.amplitudeAt(f[k]);
    }
    for (let k = 1; k < last; k++)
      if (a[k] > a[k - 1] && a[k] >= a[k + 1]) this.refine(k, f[k - 1], f[k + 1]);
  }

  /* By thirds of what is between low and high */
  refine(k, low, high) {
    for (let turn = 0; turn < 40 && high - low > 1e-7 * high; turn++) {
      const left = low + (high - low) / 3, right = high - (high - low) / 3;
      if (this.amplitudeAt(left) > this.amplitudeAt(right)) high = right;
      else low = left;
    }
    const a = this.amplitudeAt((low + high) / 2);
    if (!(a > this.amplitude[k])) return;
    this.frequency[k] = (low + high) / 2;
    this.amplitude[k] = a;
  }
}
