/* SPDX-License-Identifier: MIT-0 */
/* Curves of a page of plgen --page: a scope over time, a phase plane, a spectrum, a frequency response. Each draws what
 * the page's history or the engine has. */

const MARGIN = 14;              // Points below a curve for the numbers of its axis.

/* A text at the right end of a line */
function writeRight(g, words, x, y) {
  g.textAlign = "right";
  g.fillText(words, x, y);
  g.textAlign = "left";
}

class Scope {
  constructor(page) {
    this.page = page;
    this.canvas = canvasFor("Scope: outputs over time; arrow keys move the cursor");
    this.read = element("output", {className: "now"});
    this.canvas.onpointermove = (event) => this.moveCursor(event.offsetX / this.canvas.wide);
    this.canvas.onpointerleave = () => { this.cursor = undefined; page.touch(); };
    this.canvas.onkeydown = (event) => {
      const by = {ArrowLeft: -0.01, ArrowRight: 0.01, Home: -1, End: 1}[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.moveCursor((this.cursor === undefined ? 1 : this.cursor) + by);
      this.readCursor();
    };
  }

  draw() {
    const p = this.page, g = p.fit(this.canvas, 300), names = p.set.show, h = p.history, wide = this.canvas.wide;
    const tall = this.canvas.high - MARGIN, lane = tall / (names.length || 1);
    const end = Math.max(h.when(h.count - 1), p.set.window), start = end - p.set.window;
    g.fillStyle = p.faint;
    for (let k = h.first + 1; k < h.count; k++)
      if (h.at(k, 0) > h.at(k - 1, 0) && h.when(k) >= start)
        g.fillRect((h.when(k) - start) / p.set.window * wide, 0, 0.7, tall);
    g.fillRect(0, tall, wide, 1);
    for (let i = 0; i < names.length; i++)
      this.drawLane(g, p.byName.get(names[i]), start, i * lane, lane, p.curve[i % p.curve.length]);
    g.fillStyle = p.ink;
    if (p.fresh || !this.ends) this.ends = [text(start) + " s", text(end) + " s"];
    g.fillText(this.ends[0], 4, tall + 12);
    writeRight(g, this.ends[1], wide - 4, tall + 12);
    if (this.cursor !== undefined) g.fillRect(this.cursor * wide, 0, 1, tall);
    this.startTime = start;
  }

  /* Where more rows than one are in a point, a line from the least to the largest of them */
  drawLane(g, c, start, top, lane, colour) {
    const p = this.page, h = p.history, wide = this.canvas.wide, column = c.column;
    h.measure(column, start);
    const low = h.low, high = h.high, middle = (high + low) / 2;
    const room = (Math.max(high - low, 1e-6 * Math.abs(high)) || 1) * 0.55;
    const scale = (lane - 18) / 2 / room, centre = top + lane / 2 + 6;
    g.strokeStyle = colour;
    g.beginPath();
    let pixel = -1, least = 0, most = 0;
    for (let k = h.first; k < h.count; k++) {
      const at = (h.when(k) - start) / p.set.window * wide;
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
    g.fillStyle = p.ink;
    if (p.fresh || !c.range) c.range = high >= low ? text(low / c.factor) + " … " + text(high / c.factor) : "";
    writeRight(g, c.range, wide - 4, top + 12);
  }

  readCursor() {
    const p = this.page, h = p.history;
    const to = this.cursor === undefined ? Infinity : this.startTime + this.cursor * p.set.window;
    let k = h.count - 1;
    while (k > h.first && h.when(k) > to) k--;
    this.read.textContent = "t = " + text(h.when(k)) + " s: " + p.set.show.map((name) => {
      const c = p.byName.get(name);
      return name + " = " + text(h.at(k, c.column) / c.factor) + (c.unit ? " " + c.unit : "");
    }).join(", ");
  }

  moveCursor(to) {
    this.cursor = Math.min(1, Math.max(0, to));
    this.page.touch();
  }
}

/* ---- the phase plane ---- */

class Plane {
  constructor(page) {
    this.page = page;
    this.canvas = canvasFor("Phase plane");
    this.ends = ["", "", "", ""];
  }

  draw() {
    const p = this.page, g = p.fit(this.canvas, 260), h = p.history, across = p.byName.get(p.set.x);
    const up = p.byName.get(p.set.y), a = across.column, b = up.column;
    h.measure(a, 0);
    const left = h.low, right = h.high;
    h.measure(b, 0);
    const low = h.low, high = h.high, wide = this.canvas.wide, tall = this.canvas.high - MARGIN;
    const sx = (wide - 20) / (right - left || 1), sy = (tall - 34) / (high - low || 1), base = tall - 10;
    g.fillStyle = p.faint;
    if (left < 0 && right > 0) g.fillRect(10 - left * sx, 0, 1, tall);
    if (low < 0 && high > 0) g.fillRect(0, base + low * sy, wide, 1);
    g.strokeStyle = p.curve[0];
    g.beginPath();
    for (let k = h.first; k < h.count; k++)
      g.lineTo(10 + (h.at(k, a) - left) * sx, base - (h.at(k, b) - low) * sy);
    g.stroke();
    g.fillStyle = p.curve[1];
    g.beginPath();
    g.arc(10 + (h.at(h.count - 1, a) - left) * sx, base - (h.at(h.count - 1, b) - low) * sy, 4, 0, 7);
    g.fill();
    if (p.fresh) {
      this.ends[0] = text(left / across.factor);
      this.ends[1] = across.label + "   " + text(right / across.factor);
      this.ends[2] = text(low / up.factor);
      this.ends[3] = up.label + "   " + text(high / up.factor);
    }
    g.fillStyle = p.ink;
    g.fillText(this.ends[0], 4, tall + 12);
    writeRight(g, this.ends[1], wide - 4, tall + 12);
    g.fillText(this.ends[2], 4, tall - 2);
    g.fillText(this.ends[3], 4, 12);
  }
}

/* ---- over frequency ---- */

/* A curve of `count` amplitudes over frequencies, both by their logarithms; the decades as lines, `decades` high */
class Logarithms {
  constructor(page, label, decades) {
    this.page = page;
    this.canvas = canvasFor(label);
    this.decades = decades;
  }

  drawCurve(colour, frequency, amplitude, count, unit) {
    const p = this.page, g = p.fit(this.canvas, 260), wide = this.canvas.wide, tall = this.canvas.high - MARGIN;
    let most = 0;
    for (let k = 0; k < count; k++) if (amplitude[k] > most && amplitude[k] < Infinity) most = amplitude[k];
    const first = Math.log10(frequency[0]), last = Math.log10(frequency[count - 1]), top = Math.ceil(Math.log10(most));
    if (!(most > 0) || !(last > first)) return;
    const across = wide / (last - first), down = tall / this.decades;
    g.fillStyle = p.faint;
    for (let d = Math.ceil(first); d < last; d++) g.fillRect((d - first) * across, 0, 1, tall);
    for (let d = 1; d < this.decades; d++) g.fillRect(0, d / this.decades * tall, wide, 1);
    g.strokeStyle = colour;
    g.beginPath();
    for (let k = 0; k < count; k++)
      g.lineTo((Math.log10(frequency[k]) - first) * across,
               Math.min(tall, (top - Math.log10(amplitude[k] + 1e-300)) * down));
    g.stroke();
    g.fillStyle = p.ink;
    g.fillText(text(frequency[0]) + " Hz", 4, tall + 12);
    writeRight(g, text(frequency[count - 1]) + " Hz", wide - 4, tall + 12);
    g.fillText(text(10 ** top) + " " + unit, 4, 12);
    g.fillText(text(10 ** (top - this.decades)), 4, tall - 4);
  }
}

class Spectrum extends Logarithms {
  constructor(page) {
    super(page, "Amplitude spectrum", 5);
    this.said = element("output", {className: "now"});
  }

  /* Amplitudes of the last 2^m rows under Hann's window */
  amplitudes(c) {
    const h = this.page.history, n = 2 ** Math.floor(Math.log2(Math.max(2, Math.min(h.count - h.first, 8192))));
    if (!this.re || this.re.length !== n) {
      this.re = new Float64Array(n);
      this.im = new Float64Array(n);
      this.frequency = new Float64Array(n / 2);
    }
    let mean = 0;
    for (let k = 0; k < n; k++) mean += h.at(h.count - n + k, c.column) / n;
    for (let k = 0; k < n; k++) {
      this.re[k] = (h.at(h.count - n + k, c.column) - mean) * (1 - Math.cos(2 * Math.PI * k / n)) * 2 / n;
      this.im[k] = 0;
    }
    fourier(this.re, this.im);
    for (let k = 0; k < n / 2; k++) {
      this.re[k] = Math.sqrt(this.re[k] * this.re[k] + this.im[k] * this.im[k]) / c.factor;
      this.frequency[k] = k / (n * this.page.model.h * h.stride);
    }
    return n / 2;
  }

  /* The frequency of the largest amplitude [Hz] */
  findPeak(c) {
    const n = this.amplitudes(c);
    this.most = Math.min(1, n - 1);
    for (let k = 1; k < n; k++) if (this.re[k] > this.re[this.most]) this.most = k;
    return this.frequency[this.most];
  }

  draw() {
    const p = this.page, c = p.byName.get(p.set.of), peak = this.findPeak(c), n = this.frequency.length;
    this.drawCurve(p.curve[2], this.frequency.subarray(1), this.re.subarray(1), n - 1, c.unit);
    this.said.textContent = "peak at " + text(peak) + " Hz, amplitude " + text(this.re[this.most])
      + (c.unit ? " " + c.unit : "");
  }
}

class ResponsePlot extends Logarithms {
  constructor(page) {
    super(page, "Frequency response", 6);
    this.said = element("output", {className: "now"});
    this.drives = page.model.states.length <= 64 && page.model.whole ? drivesOf(page.model) : [];
    if (this.drives.length) this.response = new StepResponse(page.engine, 200);
  }

  /* Of a linear model as long as nothing was changed as it is */
  draw() {
    const p = this.page, r = this.response, drive = this.drives.find((d) => d.name === p.set.by);
    const c = p.byName.get(p.set.to), key = p.changes + " " + drive.name + " " + c.name;
    if (!p.model.linear || key !== this.key)
      r.measure(drive, c.column, (drive.factor || 1) / c.factor, 0.5e-3 / p.model.h);
    this.key = key;
    const unit = drive.input === undefined ? c.unit + " s" : c.unit + (drive.unit ? "/(" + drive.unit + ")" : "");
    this.drawCurve(p.curve[3], r.frequency, r.amplitude, r.points, unit);
    const peaks = [];
    for (let k = 1; k + 1 < r.points; k++)
      if (r.amplitude[k] > r.amplitude[k - 1] && r.amplitude[k] >= r.amplitude[k + 1]) peaks.push(k);
    peaks.sort((a, b) => r.amplitude[b] - r.amplitude[a]);
    this.said.textContent = (p.model.linear ? "" : "linear about the state as it is now; ")
      + (peaks.length ? "peaks: " + peaks.slice(0, 4).map((k) => text(r.frequency[k]) + " Hz ("
        + text(r.amplitude[k]) + ")").join(", ") : "no peak");
  }
}
