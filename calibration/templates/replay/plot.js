// A small plot over time with a cursor; click or drag in it to go to a time.

const LEFT = 46, RIGHT = 8, TOP = 16, BOTTOM = 16;

class Plot {
  constructor(parent, palette, height, onSeek) {
    Object.assign(this, { palette, height });
    this.figure = document.createElement("figure");
    this.figure.className = "plot";
    this.figure.style.margin = "0.5rem 0 0";
    this.canvas = document.createElement("canvas");
    this.canvas.style.height = `${height}px`;
    this.figure.append(this.canvas);
    parent.append(this.figure);
    this.curves = document.createElement("canvas");
    const seek = (event) => {
      const share = (event.clientX - this.canvas.getBoundingClientRect().left - LEFT) / this.innerWidth;
      onSeek(Math.min(1, Math.max(0, share)) * this.duration);
    };
    this.canvas.addEventListener("pointerdown", (event) => { this.canvas.setPointerCapture(event.pointerId); seek(event); });
    this.canvas.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
    new ResizeObserver(() => { this.drawCurves(); this.drawCursor(this.time || 0); }).observe(this.canvas);
  }

  get innerWidth() { return this.canvas.clientWidth - LEFT - RIGHT; }

  // series: [{ values, colour }], one value a time; limits: values to mark where they are near the data.
  show(title, unit, times, series, limits = []) {
    Object.assign(this, { title, unit, times, series, duration: times.at(-1) || 1 });
    let low = 0, high = 0;
    for (const { values } of series) for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
    this.limits = limits.filter((limit) => limit <= 1.5 * high && limit >= 1.5 * low);
    low = Math.min(low, ...this.limits);
    high = Math.max(high, ...this.limits);
    if (low === high) high = low + 1;
    const pad = 0.07 * (high - low);
    this.low = low < 0 ? low - pad : low;
    this.high = high > 0 ? high + pad : high;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `${title} over time`);
    this.drawCurves();
  }

  x(time) { return LEFT + this.innerWidth * time / this.duration; }
  y(value) { return TOP + (this.height - TOP - BOTTOM) * (this.high - value) / (this.high - this.low); }

  drawCurves() {
    if (!this.series || this.canvas.clientWidth === 0) return;
    const ratio = window.devicePixelRatio || 1, { palette } = this;
    for (const canvas of [this.canvas, this.curves]) {
      canvas.width = Math.round(this.canvas.clientWidth * ratio);
      canvas.height = Math.round(this.height * ratio);
    }
    const pen = this.curves.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = "11px system-ui, sans-serif";
    pen.lineJoin = "round";
    const [factor, letter] = this.unit === "%" ? [0.01, ""] : prefixOf(Math.max(-this.low, this.high));
    pen.fillStyle = palette.soft;
    pen.strokeStyle = palette.line;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const mark of ticks(this.low / factor, this.high / factor, 4)) {
      const y = Math.round(this.y(mark * factor)) + 0.5;
      pen.beginPath(); pen.moveTo(LEFT, y); pen.lineTo(LEFT + this.innerWidth, y); pen.stroke();
      pen.fillText(String(Number(mark.toPrecision(6))).replace("-", MINUS), LEFT - 5, y);
    }
    pen.textBaseline = "alphabetic";
    pen.textAlign = "center";
    const marks = ticks(0, this.duration, Math.max(2, Math.floor(this.innerWidth / 70)));
    for (const mark of marks) {
      const text = `${Number(mark.toPrecision(6))}${mark === marks.at(-1) ? " s" : ""}`;
      const half = pen.measureText(text).width / 2;
      pen.fillText(text, Math.min(this.x(mark), this.canvas.clientWidth - half - 1), this.height - 3);
    }
    pen.textAlign = "left";
    pen.fillStyle = palette.ink;
    pen.font = "600 11px system-ui, sans-serif";
    pen.fillText(`${this.title}, ${letter}${this.unit}`, 0, 10);
    pen.setLineDash([4, 3]);
    pen.strokeStyle = palette.soft;
    for (const limit of this.limits) {
      pen.beginPath(); pen.moveTo(LEFT, this.y(limit)); pen.lineTo(LEFT + this.innerWidth, this.y(limit)); pen.stroke();
    }
    pen.setLineDash([]);
    pen.lineWidth = 1.5;
    for (const { values, colour } of this.series) {
      pen.strokeStyle = colour;
      pen.beginPath();
      this.times.forEach((time, k) => (k ? pen.lineTo(this.x(time), this.y(values[k])) : pen.moveTo(this.x(time), this.y(values[k]))));
      pen.stroke();
    }
  }

  drawCursor(time) {
    this.time = time;
    if (!this.series || this.curves.width === 0) return;
    const ratio = window.devicePixelRatio || 1, pen = this.canvas.getContext("2d");
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.curves, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.strokeStyle = this.palette.accent;
    pen.lineWidth = 1;
    const x = Math.round(this.x(time)) + 0.5;
    pen.beginPath(); pen.moveTo(x, TOP - 3); pen.lineTo(x, this.height - BOTTOM); pen.stroke();
  }
}
