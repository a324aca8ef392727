// Time: playing, pausing, seeking, speed.

const SPEEDS = [0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];

class Player {
  constructor(times) {
    this.times = times;
    this.duration = times.at(-1);
    this.time = 0;
    this.playing = false;
    // So that a run takes some seconds to watch.
    this.speed = this.duration > 4 ? 1 : SPEEDS.findLast((speed) => this.duration / speed >= 4) || SPEEDS[0];
    this.onChange = () => {};
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  play() {
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    this.last = null;
    requestAnimationFrame((now) => this.advance(now));
    this.onChange();
  }

  pause() {
    this.playing = false;
    this.onChange();
  }

  advance(now) {
    if (!this.playing) return;
    if (this.last !== null) this.time = Math.min(this.duration, this.time + this.speed * (now - this.last) / 1000);
    this.last = now;
    if (this.time >= this.duration) this.playing = false;
    else requestAnimationFrame((then) => this.advance(then));
    this.onChange();
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.onChange();
  }

  // To the sample so many further on.
  step(count) {
    this.playing = false;
    const tolerance = 1e-9 * this.duration;
    let k = this.times.findLastIndex((time) => time <= this.time + tolerance) + count;
    if (count < 0 && this.times[k - count] < this.time - tolerance) k += 1;
    this.seek(this.times[Math.min(this.times.length - 1, Math.max(0, k))]);
  }

  faster(count) {
    const k = SPEEDS.indexOf(this.speed) + count;
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, k))];
    this.onChange();
  }
}
