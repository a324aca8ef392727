// The picture: bodies to scale, joints, contacts, the reference's shape.

// Everything may be so many times as large as the structure to be shown at first.
const FAR = 4;
// Share of positions on either side that may lie outside the picture.
const STRAYED = 0.02;
const FORCE_KINDS = ["N", "Q", "M"];

class Stage {
  constructor(canvas, recording, palette) {
    Object.assign(this, { canvas, recording, palette });
    this.camera = new Camera(canvas);
    this.bounds = this.extent(() => true);
    this.structureBounds = this.extent((body) => body.inStructure);
    this.measureStructure();
    this.forces = new ForceDrawing(recording, this.structureSize);
    this.showReference = true;
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
    if (this.camera.fitted) this.fit();
  }

  // What to show at first: everything, unless that makes the structure small; then the structure and what is near it.
  fit() {
    const [x0, y0, x1, y1] = this.structureBounds, size = Math.max(x1 - x0, y1 - y0);
    const all = Math.max(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1]);
    if (size > 0 && all > FAR * size) this.camera.fit([x0 - size, y0 - 0.4 * size, x1 + size, y1 + 0.4 * size]);
    else this.camera.fit(this.bounds);
  }

  fitAll() { this.camera.fit(this.bounds); }

  // Rectangle around where joints and chosen bodies are: at the start, and most of the time later. What stands still
  // is background and may reach far beyond, and so may a fragment.
  extent(chosen) {
    const { recording } = this, xs = [], ys = [];
    const include = ([x, y], r = 0) => { xs.push(x - r, x + r); ys.push(y - r, y + r); };
    const reach = recording.bodies.map((body) => Math.max(0, ...body.outlines.flatMap((outline) =>
      outline.points.map(([x, y]) => Math.hypot(x, y) + outline.radius))));
    const at = (k) => {
      const moment = { k, next: k, share: 0 };
      recording.joints.forEach((_, j) => { const place = recording.place(j, moment); if (place) include(place.a); });
      recording.bodies.forEach((body, i) => {
        const pose = body.kind !== "static" && chosen(body) ? recording.pose(i, moment) : null;
        if (pose) include(pose, reach[i]);
      });
    };
    at(0);
    const [startX, startY] = [xs, ys].map((values) => [Math.min(...values), Math.max(...values)]);
    const every = Math.max(1, Math.floor(recording.time.length / 60));
    for (let k = every; k < recording.time.length; k += every) at(k);
    if (xs.length === 0) return [-1, -1, 1, 1];
    const [x, y] = [[xs, startX], [ys, startY]].map(([values, [low, high]]) => {
      values.sort((one, other) => one - other);
      const rank = (share) => values[Math.round(share * (values.length - 1))];
      return [Math.min(low, rank(STRAYED)), Math.max(high, rank(1 - STRAYED))];
    });
    return [x[0], y[0], x[1], y[1]];
  }

  // Of the joints at the start: the diagonal around them, and how far apart neighbours are, as a rule [m].
  measureStructure() {
    const start = { k: 0, next: 0, share: 0 };
    const places = this.recording.joints.map((_, j) => this.recording.place(j, start)).filter(Boolean).map(({ a }) => a);
    const span = (i) => Math.max(...places.map((p) => p[i])) - Math.min(...places.map((p) => p[i]));
    const all = Math.hypot(this.bounds[2] - this.bounds[0], this.bounds[3] - this.bounds[1]);
    this.structureSize = (places.length > 1 && Math.hypot(span(0), span(1))) || 0.3 * all;
    const nearest = places.map((p, i) => Math.min(...places.map((q, j) => (i === j ? Infinity : Math.hypot(p[0] - q[0], p[1] - q[1])))));
    this.spacing = nearest.sort((one, other) => one - other)[nearest.length >> 1] || Infinity;
  }

  draw(moment, chosen) {
    const { canvas, recording, palette, camera } = this;
    const ratio = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, camera.width, camera.height);
    pen.lineJoin = pen.lineCap = "round";
    const places = recording.joints.map((_, j) => recording.place(j, moment));
    recording.bodies.forEach((body, i) => this.drawBody(pen, body, i, moment));
    this.forces.draw(pen, camera, palette, moment, places);
    if (this.showReference && recording.reference) this.drawReference(pen, moment);
    places.forEach((place, j) => place && this.drawJoint(pen, j, place, moment, chosen.indexOf(j)));
    pen.globalAlpha = 1;
  }

  drawBody(pen, body, i, moment) {
    const { recording, palette, camera } = this, pose = recording.pose(i, moment);
    if (!pose) return;
    pen.fillStyle = body.kind === "static" ? palette.still : body.inStructure ? palette.piece : palette.loose;
    pen.strokeStyle = body.kind === "static" ? palette.soft : palette.edge;
    pen.lineWidth = 1;
    if (body.outlines.length === 0 && body.kind !== "static") this.drawStick(pen, i, pose);
    for (const { kind, points, radius } of body.outlines) {
      const corners = points.map((point) => camera.toScreen(toWorld(pose, point)));
      const r = radius * camera.scale;
      pen.beginPath();
      if (kind === "circle") {
        pen.arc(...corners[0], Math.max(r, 0.5), 0, 2 * Math.PI);
        pen.fill();
        pen.stroke();
        pen.beginPath();
        pen.moveTo(...corners[0]);
        pen.lineTo(corners[0][0] + r * Math.cos(pose[2]), corners[0][1] - r * Math.sin(pose[2]));
        pen.stroke();
        continue;
      }
      corners.forEach((corner, k) => (k ? pen.lineTo(...corner) : pen.moveTo(...corner)));
      if (kind === "segment") {
        pen.save();
        pen.lineWidth = Math.max(2 * r, 1.5);
        pen.strokeStyle = pen.fillStyle;
        pen.stroke();
        pen.restore();
      } else {
        pen.closePath();
        pen.fill();
        if (r > 0.5) { pen.save(); pen.lineWidth = 2 * r; pen.strokeStyle = pen.fillStyle; pen.stroke(); pen.restore(); }
        else pen.stroke();
      }
    }
  }

  // A body without a shape: from its middle to each of its joints.
  drawStick(pen, i, pose) {
    const { recording, camera } = this, middle = camera.toScreen(pose);
    pen.save();
    pen.lineWidth = 3;
    pen.strokeStyle = pen.fillStyle;
    for (const j of recording.jointsOf[i]) {
      const { bodies, anchors } = recording.joints[j];
      pen.beginPath();
      pen.moveTo(...middle);
      pen.lineTo(...camera.toScreen(toWorld(pose, anchors[bodies.indexOf(i)])));
      pen.stroke();
    }
    pen.restore();
  }

  drawReference(pen, { time }) {
    const { lines, time: times } = this.recording.reference;
    // The moments before and after, and the share of the way between them.
    const before = times ? Math.max(0, times.findLastIndex((t) => t <= time)) : 0;
    const after = times ? Math.min(before + 1, times.length - 1) : 0;
    const span = times ? times[after] - times[before] : 0;
    const share = span > 0 ? Math.min(1, Math.max(0, (time - times[before]) / span)) : 0;
    pen.save();
    pen.strokeStyle = this.palette.reference;
    pen.lineWidth = 1.5;
    pen.setLineDash([6, 4]);
    for (const line of lines) {
      pen.beginPath();
      line[before].forEach(([x, y], k) => {
        const [nextX, nextY] = line[after][k];
        const point = this.camera.toScreen([x + share * (nextX - x), y + share * (nextY - y)]);
        if (k) pen.lineTo(...point); else pen.moveTo(...point);
      });
      pen.stroke();
    }
    pen.restore();
  }

  // Radius of a joint's mark: smaller where joints stand close on the screen.
  get jointRadius() {
    return Math.min(6, Math.max(2.5, 0.3 * this.camera.scale * this.spacing));
  }

  drawJoint(pen, j, { a, b }, { k }, chosen) {
    const { recording, palette, camera } = this, r = this.jointRadius;
    const [x, y] = camera.toScreen(a);
    pen.lineWidth = 1;
    if (recording.broken(j, k)) {
      const half = 0.9 * r + 1.5;
      pen.strokeStyle = palette.bad;
      pen.lineWidth = 2.2;
      for (const [px, py] of [[x, y], camera.toScreen(b)]) {
        pen.beginPath();
        pen.moveTo(px - half, py - half); pen.lineTo(px + half, py + half);
        pen.moveTo(px + half, py - half); pen.lineTo(px - half, py + half);
        pen.stroke();
      }
    } else {
      pen.beginPath();
      pen.arc(x, y, r, 0, 2 * Math.PI);
      pen.fillStyle = palette.utilisation(recording.utilisation(j, k));
      pen.strokeStyle = palette.edge;
      pen.fill();
      pen.stroke();
      const used = recording.used(j, k);
      if (used > 0.001) {
        pen.beginPath();
        pen.arc(x, y, r + 2.5, -Math.PI / 2, (-0.5 + 2 * used) * Math.PI);
        pen.strokeStyle = palette.used;
        pen.lineWidth = 2;
        pen.stroke();
      }
    }
    if (chosen >= 0) {
      pen.beginPath();
      pen.arc(x, y, r + 6, 0, 2 * Math.PI);
      pen.strokeStyle = CHOSEN[chosen];
      pen.lineWidth = 2.5;
      pen.stroke();
      badge(pen, x + r + 13, y - r - 13, chosen);
    }
  }

  // The joint nearest to a point of the screen, or null when none is within reach.
  jointAt([x, y], moment, reach) {
    let nearest = null, best = reach;
    this.recording.joints.forEach((_, j) => {
      const place = this.recording.place(j, moment);
      if (!place) return;
      for (const end of [place.a, place.b]) {
        const [px, py] = this.camera.toScreen(end), distance = Math.hypot(px - x, py - y);
        if (distance < best) { nearest = j; best = distance; }
      }
    });
    return nearest;
  }
}

// A chosen joint's number on a disc of its colour.
function badge(pen, x, y, chosen) {
  pen.beginPath();
  pen.arc(x, y, 8, 0, 2 * Math.PI);
  pen.fillStyle = CHOSEN[chosen];
  pen.fill();
  pen.fillStyle = "#fff";
  pen.font = "600 10px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillText(String(chosen + 1), x, y + 0.5);
}
