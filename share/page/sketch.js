/* SPDX-License-Identifier: MIT-0 */
/* The sketch of a page of plgen --page: bodies and links as they are now, and initial values by dragging them. */

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
const EDGE = 14;                // Points from the canvas' edge to a wall.
const LANE = 17;                // Points from a link to the one below it.

class Sketch {
  constructor(page) {
    this.page = page;
    this.model = page.model;
    this.engine = page.engine;
    this.first = 1 + page.engine.outputs;           // The column of the first state
    this.held = -1;
    this.canvas = canvasFor("Animated sketch of the model; drag a body to give it an initial value");
    this.forget();
    this.places();
    this.listen();
  }

  forget() {
    this.largest = 1e-300;
    this.box = null;
  }

  draw() {
    const g = this.page.fit(this.canvas, this.canvas.clientWidth > 380 ? 370 : 260);
    g.strokeStyle = this.page.ink;
    g.fillStyle = this.page.paper;
    if (this.model.draw.length) this.drawPlaces(g);
    else this.drawNetwork(g);
  }

  value(column) { return this.page.value(column); }

  /* A number that a drawing reads; -1 is 0 */
  drawn(output) { return output < 0 ? 0 : this.value(1 + output); }

  /* ---- what `draw` says ---- */

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
    const wide = this.canvas.wide - 60, tall = this.canvas.high - 60;
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
      if (d.what !== "rod") return;
      this.drawDisc(g, x, y, 3, 0, false);
      this.drawDisc(g, ex, ey, 3, 0, false);
    }
  }

  drawMass(g, x, y, size) {
    g.fillStyle = this.page.curve[0];
    g.fillRect(x - size / 2, y - size / 2, size, size);
    g.strokeRect(x - size / 2, y - size / 2, size, size);
  }

  drawDisc(g, x, y, radius, turn, spoke) {
    g.fillStyle = this.page.paper;
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
    const length = Math.sqrt((ex - x) * (ex - x) + (ey - y) * (ey - y)), lines = LINES[what];
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

  drawLine(g, x, y, ex, ey) {
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(ex, ey);
    g.stroke();
  }

  /* ---- the network: bodies side by side, one for each coordinate ---- */

  /* Of each link the number of those of the same pair before it, and whether the last body stands at a wall */
  places() {
    const links = this.model.elements.filter((e) => e[0] !== "mass" && e[0] !== "force");
    this.lane = this.model.elements.map((e, k) => this.model.elements.slice(0, k).filter((other) =>
      other[0] !== "mass" && other[0] !== "force" && other[1] === e[1] && other[2] === e[2]).length);
    this.wallRight = links.some((e) => this.isAtWall(Math.min(e[1], e[2]), Math.max(e[1], e[2])));
  }

  /* Of the last of a few bodies the ground is a wall behind it; of those between it is a post on the floor. */
  isAtWall(low, high) { return low < 0 && high > 0 && high === this.model.coords - 1; }

  /* Moved in proportion to the largest motion so far */
  drawNetwork(g) {
    const n = this.model.coords, wide = this.canvas.wide, tall = this.canvas.high;
    this.apart = (wide - 2 * EDGE) / (n + (this.wallRight ? 1 : 0.5));
    this.size = Math.max(4, Math.min(40, this.apart * 0.35));
    this.middle = tall * 0.45;
    this.floor = tall - 40;
    if (this.model.elements.length === 0) {
      g.fillStyle = this.page.ink;
      g.fillText("no bodies to draw: the states are those of modes", 10, tall / 2);
      return;
    }
    for (let i = 0; i < n; i++) this.largest = Math.max(this.largest, Math.abs(this.value(this.first + i)));
    this.perUnit = this.apart * 0.28 / this.largest;
    this.drawLine(g, EDGE, this.middle - 60, EDGE, this.floor);
    this.drawLine(g, EDGE, this.floor, wide - EDGE, this.floor);
    if (this.wallRight) this.drawLine(g, wide - EDGE, this.middle - 60, wide - EDGE, this.floor);
    for (let k = 0; k < this.model.elements.length; k++) this.drawElement(g, k);
    for (let i = 0; i < n; i++) this.drawBody(g, i);
  }

  drawBody(g, i) {
    const x = this.bodyAt(i), s = this.model.states[i];
    if (s.unit === "rad") this.drawDisc(g, x, this.middle, this.size / 2, this.value(this.first + i), true);
    else this.drawMass(g, x, this.middle, this.size);
    g.fillStyle = this.page.ink;
    g.textAlign = "center";
    if (this.model.coords <= 12) g.fillText(s.name, x, this.middle - this.size / 2 - 28);
    g.textAlign = "left";
  }

  restAt(i) { return EDGE + (i + 1) * this.apart; }
  bodyAt(i) { return this.restAt(i) + this.perUnit * this.value(this.first + i); }

  /* Links of one pair of bodies lie below each other; what is not next to each other is linked above. */
  drawElement(g, k) {
    const e = this.model.elements[k], what = e[0], high = Math.max(e[1], e[2]), low = Math.min(e[1], e[2]);
    const half = this.size / 2, x = this.bodyAt(high), y = this.middle + (this.lane[k] - 0.5) * LANE;
    if (what === "mass") return;
    if (what === "force") this.drawLink(g, what, x - 14, this.middle - half - 12, x + 14, this.middle - half - 12);
    else if (this.isAtWall(low, high)) this.drawLink(g, what, this.canvas.wide - EDGE, y, x + half, y);
    else if (low < 0 && high > 0) this.drawPost(g, what, high, this.lane[k]);
    else if (low < 0) this.drawLink(g, what, EDGE, y, x - half, y);
    else if (high === low + 1) this.drawLink(g, what, this.bodyAt(low) + half, y, x - half, y);
    else {
      const above = this.middle - half - 12 - 7 * (high - low - 1);
      this.drawLink(g, what, this.bodyAt(low), above, x, above);
    }
  }

  /* From the foot of a body to a post on the floor beside it */
  drawPost(g, what, i, lane) {
    const x = this.bodyAt(i), foot = this.middle + this.size / 2, y = foot + 14 + lane * LANE;
    const post = this.restAt(i) + this.apart * 0.6;
    this.drawLine(g, x, foot, x, y);
    this.drawLine(g, post, y - 8, post, this.floor);
    this.drawLink(g, what, post, y, x, y);
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
      for (let i = 0; i < this.model.coords && this.model.elements.length; i++) look(i, this.bodyAt(i), this.middle);
    for (const d of this.model.draw)
      for (let k = 0; k < d.at.length && d.what !== "ground" && !this.model.constrained; k += 2)
        look(d.at[k] >= 0 ? d.at[k] : d.at[k + 1], this.left + this.scale * this.drawn(d.at[k]),
             this.base - this.scale * this.drawn(d.at[k + 1]));
    return nearest;
  }

  drag(px, py) {
    if (!this.model.draw.length) {
      this.engine.start[this.held] = (px - this.restAt(this.held)) / this.perUnit;
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

  /* The scale stays while a body is held. */
  listen() {
    const s = this.canvas, page = this.page, at = (event) => [event.offsetX, event.offsetY];
    let resumes = false;
    s.onpointerdown = (event) => {
      this.held = this.grabbed(...at(event));
      if (this.held < 0) return;
      s.setPointerCapture(event.pointerId);
      resumes = page.running;
      page.run(false);
      for (let i = 0; i < this.engine.states; i++) this.engine.start[i] = this.value(this.first + i);
    };
    s.onpointermove = (event) => {
      if (this.held < 0) return;
      const {largest, box} = this;
      this.drag(...at(event));
      page.forgetPast();
      Object.assign(this, {largest, box});
    };
    s.onpointerup = s.onpointercancel = () => {
      if (this.held < 0) return;
      this.held = -1;
      page.run(resumes);
    };
  }
}
