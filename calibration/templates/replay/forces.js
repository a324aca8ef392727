// Forces: N, Q and M of joints as ordinates beside the members, forces of contacts as lines through them.

// Share of the structure's size that the largest ordinate of the run takes when the scale is 1.
const LARGEST_ORDINATE = 0.15;

class ForceDrawing {
  constructor(recording, size) {
    this.recording = recording;
    this.shown = { N: false, Q: false, M: true, contact: true };
    this.scale = 1;
    this.unit = { N: "N", Q: "N", M: "N m", contact: "N" };
    // Metres of the picture for one N or N m, at scale 1.
    this.length = {};
    const times = recording.time.length;
    FORCE_KINDS.forEach((name, kind) => {
      let most = 0;
      recording.joints.forEach((_, j) => {
        for (let k = 0; k < times; k++) most = Math.max(most, Math.abs(recording.force(j, kind, k)));
      });
      this.length[name] = most > 0 ? LARGEST_ORDINATE * size / most : 0;
    });
    let most = 0;
    for (let k = 0; k < times; k++) for (const [, , fx, fy] of recording.contactsAt(k)) most = Math.max(most, Math.hypot(fx, fy));
    this.length.contact = most > 0 ? LARGEST_ORDINATE * size / most : 0;
  }

  draw(pen, camera, palette, moment, places) {
    FORCE_KINDS.forEach((name, kind) => {
      if (this.shown[name]) this.drawKind(pen, camera, palette[name], name, kind, moment, places);
    });
    if (this.shown.contact) this.drawContacts(pen, camera, palette, moment);
  }

  // Ordinates of one kind; N and Q on the left of the joint's axis when positive, M on the side in tension.
  drawKind(pen, camera, colour, name, kind, { k }, places) {
    const { recording } = this, side = name === "M" ? -1 : 1;
    const feet = places.map((place) => place && camera.toScreen(place.a));
    const tips = places.map((place, j) => {
      if (!place || recording.broken(j, k)) return null;
      const ordinate = side * this.scale * this.length[name] * recording.force(j, kind, k) * camera.scale;
      return [feet[j][0] - ordinate * Math.sin(place.angle), feet[j][1] - ordinate * Math.cos(place.angle)];
    });
    pen.save();
    pen.strokeStyle = pen.fillStyle = colour;
    recording.jointsOf.forEach((joints, body) => {
      const [i, j] = joints;
      if (joints.length !== 2 || recording.bodies[body].kind === "static" || !tips[i] || !tips[j]) return;
      pen.beginPath();
      pen.moveTo(...feet[i]); pen.lineTo(...tips[i]); pen.lineTo(...tips[j]); pen.lineTo(...feet[j]);
      pen.globalAlpha = 0.16;
      pen.fill();
      pen.globalAlpha = 1;
      pen.lineWidth = 1.4;
      pen.beginPath();
      pen.moveTo(...tips[i]); pen.lineTo(...tips[j]);
      pen.stroke();
    });
    pen.lineWidth = 2;
    tips.forEach((tip, j) => {
      if (!tip) return;
      pen.beginPath();
      pen.moveTo(...feet[j]); pen.lineTo(...tip);
      pen.stroke();
    });
    pen.restore();
  }

  drawContacts(pen, camera, palette, { k }) {
    pen.save();
    pen.strokeStyle = pen.fillStyle = palette.contact;
    pen.lineWidth = 2;
    for (const [x, y, fx, fy] of this.recording.contactsAt(k)) {
      const [px, py] = camera.toScreen([x, y]);
      const half = 0.5 * this.scale * this.length.contact * camera.scale;
      pen.beginPath();
      pen.moveTo(px - half * fx, py + half * fy);
      pen.lineTo(px + half * fx, py - half * fy);
      pen.stroke();
      pen.beginPath();
      pen.arc(px, py, 2.5, 0, 2 * Math.PI);
      pen.fill();
    }
    pen.restore();
  }

  // For the legend: of each kind shown, a round force and its length in pixels.
  bars(camera) {
    const bars = [];
    for (const name of [...FORCE_KINDS, "contact"]) {
      const pixels = this.scale * this.length[name] * camera.scale;
      if (!this.shown[name] || !(pixels > 0)) continue;
      const force = roundBelow(70 / pixels);
      bars.push({ name, pixels: force * pixels, text: roundWithUnit(force, this.unit[name]) });
    }
    return bars;
  }
}
