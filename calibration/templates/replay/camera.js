// From metres to pixels: pan, zoom, fit; mouse, wheel, touch.

class Camera {
  constructor(canvas) {
    this.canvas = canvas;
    this.x = this.y = 0;      // world point in the middle of the canvas [m]
    this.scale = 1;           // pixels a metre
    this.fitted = true;       // still as `fit` left it, so fit again when the window changes
    this.onChange = () => {};
    this.onTap = () => {};
    this.onHover = () => {};
    this.pointers = new Map();
    this.travelled = 0;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)), ...this.local(event));
    }, { passive: false });
  }

  get width() { return this.canvas.clientWidth; }
  get height() { return this.canvas.clientHeight; }

  toScreen([x, y]) {
    return [this.width / 2 + this.scale * (x - this.x), this.height / 2 - this.scale * (y - this.y)];
  }

  local(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // Show the rectangle from (x0, y0) to (x1, y1) with a margin.
  fit([x0, y0, x1, y1]) {
    const margin = 0.86;
    this.scale = margin * Math.min(this.width / Math.max(x1 - x0, 1e-6), this.height / Math.max(y1 - y0, 1e-6));
    this.x = (x0 + x1) / 2;
    this.y = (y0 + y1) / 2;
    this.fitted = true;
    this.onChange();
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const dx = px - this.width / 2, dy = this.height / 2 - py;
    this.x += dx / this.scale * (1 - 1 / factor);
    this.y += dy / this.scale * (1 - 1 / factor);
    this.scale *= factor;
    this.fitted = false;
    this.onChange();
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    if (this.pointers.size === 0) this.travelled = 0;
    this.pointers.set(event.pointerId, this.local(event));
  }

  move(event) {
    const now = this.local(event), before = this.pointers.get(event.pointerId);
    if (!before) { this.onHover(now); return; }
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId);
    const dx = now[0] - before[0], dy = now[1] - before[1];
    this.travelled += Math.hypot(dx, dy);
    if (others.length === 0) {
      // A tap that trembles is still a tap.
      if (this.travelled > 4) { this.x -= dx / this.scale; this.y += dy / this.scale; this.fitted = false; }
    } else {
      const still = others[0][1];
      const apart = (p) => Math.hypot(p[0] - still[0], p[1] - still[1]) || 1;
      this.x -= dx / 2 / this.scale;
      this.y += dy / 2 / this.scale;
      this.zoom(apart(now) / apart(before), (now[0] + still[0]) / 2, (now[1] + still[1]) / 2);
    }
    this.pointers.set(event.pointerId, now);
    this.canvas.classList.toggle("dragging", this.travelled > 4);
    this.onChange();
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    this.canvas.classList.remove("dragging");
    if (event.type === "pointerup" && this.pointers.size === 0 && this.travelled <= 4) {
      this.onTap(this.local(event), event.pointerType === "mouse" ? 12 : 24);
    }
  }
}
