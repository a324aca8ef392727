// The recording behind the page: unpacked arrays, and where things are at any time.

const ABSENT = -32768;

async function unpack(text) {
  if (!("DecompressionStream" in window && "findLastIndex" in Array.prototype)) {
    throw new Error("This browser cannot unpack the recording. Take one from 2023 or later: Chrome, Edge, Firefox or Safari.");
  }
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// One packed array: channels of 16-bit integers, stored as differences, low bytes before high bytes.
class Channels {
  constructor(bytes, { first, length, offset, step }) {
    this.length = length;
    this.offset = offset;
    this.step = step;
    this.values = new Int16Array(length * offset.length);
    const half = bytes.length / 2;
    for (let c = 0, i = 0; c < offset.length; c++) {
      let value = 0;
      for (let k = 0; k < length; k++, i++) {
        value = (value + (bytes[first + i] | (bytes[half + first + i] << 8))) << 16 >> 16;
        this.values[i] = value;
      }
    }
  }

  // Value of a channel at a sample; not a number where there is none.
  at(channel, k) {
    const value = this.values[channel * this.length + k];
    return value === ABSENT ? NaN : this.offset[channel] + this.step[channel] * value;
  }
}

class Recording {
  static async read(element) {
    const description = JSON.parse(element.textContent);
    return new Recording(description, await unpack(description.data));
  }

  constructor(description, bytes) {
    Object.assign(this, description);
    delete this.data;
    const channels = (name) => this.layout[name] && new Channels(bytes, this.layout[name]);
    this.poses = channels("pose");
    this.forces = channels("force");
    this.capacityUsed = channels("used");
    this.contacts = channels("contact");
    this.energies = channels("energy");
    const touching = channels("touching");
    this.contactStart = [0];
    for (let k = 0; k < this.time.length; k++) {
      this.contactStart.push(this.contactStart[k] + Math.round(touching.at(0, k)));
    }
    this.duration = this.time.at(-1);
    this.jumpsOf = new Set(this.jumps.map(([body, k]) => `${body} ${k}`));
    this.jointsOf = this.bodies.map(() => []);
    this.joints.forEach((joint, j) => joint.bodies.forEach((body) => this.jointsOf[body].push(j)));
  }

  // The last sample not after a time, and the share of the way to the next.
  momentAt(time) {
    let low = 0, high = this.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= time) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, this.time.length - 1);
    const span = this.time[next] - this.time[low];
    return { k: low, next, share: span > 0 ? Math.min(1, Math.max(0, (time - this.time[low]) / span)) : 0, time };
  }

  // x, y and angle of a body, between samples on a straight way; null while it is not there.
  pose(body, { k, next, share }) {
    const c = 3 * body, poses = this.poses;
    const here = [poses.at(c, k), poses.at(c + 1, k), poses.at(c + 2, k)];
    if (Number.isNaN(here[0])) return null;
    if (share === 0 || this.jumpsOf.has(`${body} ${next}`)) return here;
    const there = [poses.at(c, next), poses.at(c + 1, next), poses.at(c + 2, next)];
    if (Number.isNaN(there[0])) return here;
    return here.map((value, i) => value + share * (there[i] - value));
  }

  // Where a joint is, on a and on b, and the direction of its x axis; null while one of its bodies is not there.
  place(j, moment) {
    const joint = this.joints[j];
    const [a, b] = joint.bodies.map((body) => this.pose(body, moment));
    if (!a || !b) return null;
    const angle = (1 - joint.turn) * (a[2] + joint.rest[0]) + joint.turn * (b[2] + joint.rest[1]);
    return { a: toWorld(a, joint.anchors[0]), b: toWorld(b, joint.anchors[1]), angle };
  }

  // N, Q (kind 0, 1) or M (kind 2) of a joint at a sample.
  force(j, kind, k) {
    return this.broken(j, k) ? 0 : this.forces.at(3 * j + kind, k);
  }

  used(j, k) {
    return this.broken(j, k) ? 1 : this.capacityUsed.at(j, k);
  }

  broken(j, k) {
    const from = this.joints[j].brokenFrom;
    return from !== null && k >= from;
  }

  // Force over its maximum; 0 without a limit.
  share(j, kind, k) {
    const most = this.joints[j].maxima[kind];
    return most ? Math.abs(this.force(j, kind, k)) / most : 0;
  }

  utilisation(j, k) {
    return Math.max(this.share(j, 0, k), this.share(j, 1, k), this.share(j, 2, k));
  }

  // Contacts at a sample: x, y, force x, force y.
  contactsAt(k) {
    const found = [];
    for (let i = this.contactStart[k]; i < this.contactStart[k + 1]; i++) {
      found.push([0, 1, 2, 3].map((c) => this.contacts.at(c, i)));
    }
    return found;
  }
}

function toWorld([x, y, angle], [px, py]) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [x + c * px - s * py, y + s * px + c * py];
}
