"use strict";
// Moves both robots and all cursors of a log to one time. Everything else stands in the page already.
(() => {
  const COLUMNS = ["t", "x", "y", "theta", "k", "vh", "v", "wh", "w", "d", "D", "L"];
  const UNIT = { L: 1, k: 1 };
  const all = (root, what) => Array.from(root.querySelectorAll(what));
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

  // Rows of integers in thousandths, cells that are not known empty.
  const parse = text => !text ? [] : text.split(";").map(row => {
    const cells = row.split(",");
    return Object.fromEntries(COLUMNS.map((name, i) =>
      [name, cells[i] === "" ? NaN : Number(cells[i]) * (UNIT[name] || 0.001)]));
  });

  // The last row at or before a time.
  const indexAt = (rows, t) => {
    let low = 0, high = rows.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (rows[middle].t <= t + 1e-9) low = middle; else high = middle - 1;
    }
    return low;
  };

  // Between two rows the robot moves evenly; values hold until the next row.
  const poseAt = (rows, i, t) => {
    const from = rows[i], to = rows[Math.min(i + 1, rows.length - 1)];
    const share = to.t > from.t ? clamp((t - from.t) / (to.t - from.t), 0, 1) : 0;
    const turn = Math.atan2(Math.sin(to.theta - from.theta), Math.cos(to.theta - from.theta));
    return [from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), from.theta + share * turn];
  };

  const shown = (name, x) => {
    if (Number.isNaN(x)) return "–";
    if (name === "k") return x === 1 ? "person" : x === 0 ? "law" : String(x);
    return name === "L" && x !== 0 && (Math.abs(x) < 0.01 || Math.abs(x) >= 1000) ? x.toExponential(1) : x.toFixed(name === "L" ? 2 : 3);
  };

  const discAt = (walk, t) => {
    const [x0, y0, x1, y1, speed, start, toAndFro] = walk;
    const length = Math.hypot(x1 - x0, y1 - y0), walked = speed * (t - start);
    let share = 0;
    if (length > 0 && walked > 0) {
      const lap = walked % (2 * length);
      share = (toAndFro ? (lap <= length ? lap : 2 * length - lap) : Math.min(walked, length)) / length;
    }
    return [x0 + share * (x1 - x0), y0 + share * (y1 - y0)];
  };

  class Viewer {
    constructor(root) {
      this.root = root;
      this.end = Number(root.dataset.end);
      this.slider = root.querySelector("input[type=range]");
      this.output = root.querySelector("output");
      this.playing = root.querySelector(".play");
      this.map = root.querySelector(".map");
      this.place = this.map ? this.map.dataset.place.split(",").map(Number) : [0, 0, 1];
      this.arms = ["a", "b"].map(arm => ({
        rows: parse(root.dataset[arm]),
        robot: root.querySelector(".robot.r" + arm),
        cells: all(root, `.readout tr.${arm} td[data-of]`),
      }));
      this.cursors = all(root, ".cursor");
      this.discs = all(root, "[data-walk]").map(disc => [disc, disc.dataset.walk.split(",").map(Number)]);
      this.moments = all(root.closest("details"), ".jump[data-t]").map(link => Number(link.dataset.t));
      this.moments = Array.from(new Set(this.moments)).sort((a, b) => a - b);
      this.slider.addEventListener("input", () => { this.pause(); this.show(Number(this.slider.value)); });
      this.playing.addEventListener("click", () => this.timer ? this.pause() : this.play());
      root.querySelector(".back").addEventListener("click", () => this.toMoment(-1));
      root.querySelector(".next").addEventListener("click", () => this.toMoment(1));
      for (const plot of all(root, ".plot svg")) {
        const follow = event => {
          const box = plot.getBoundingClientRect();
          this.pause();
          this.show(this.end * clamp((event.clientX - box.left) / box.width, 0, 1));
        };
        plot.addEventListener("pointerdown", event => { plot.setPointerCapture(event.pointerId); follow(event); });
        plot.addEventListener("pointermove", event => { if (event.buttons) follow(event); });
      }
      root.addEventListener("keydown", event => this.key(event));
      this.show(0);
    }

    show(t) {
      this.t = clamp(t, 0, this.end);
      this.slider.value = this.t;
      this.slider.setAttribute("aria-valuetext", this.t.toFixed(2) + " seconds");
      this.output.textContent = this.t.toFixed(2) + " s";
      const [left, top, scale] = this.place;
      const at = (x, y) => [(x - left) * scale, (top - y) * scale];
      for (const { rows, robot, cells } of this.arms) {
        if (!rows.length) continue;
        const i = indexAt(rows, this.t);
        for (const cell of cells) cell.textContent = shown(cell.dataset.of, rows[i][cell.dataset.of]);
        if (!robot) continue;
        const [x, y, theta] = poseAt(rows, i, this.t);
        const known = [x, y, theta].every(Number.isFinite);
        robot.setAttribute("visibility", known ? "visible" : "hidden");
        if (known) {
          const [px, py] = at(x, y);
          robot.setAttribute("transform", `translate(${px.toFixed(2)} ${py.toFixed(2)})`);
          robot.firstElementChild.setAttribute("transform", `rotate(${(-theta * 180 / Math.PI).toFixed(2)})`);
        }
      }
      for (const [disc, walk] of this.discs) {
        const [px, py] = at(...discAt(walk, this.t));
        disc.setAttribute("cx", px.toFixed(2));
        disc.setAttribute("cy", py.toFixed(2));
      }
      for (const cursor of this.cursors) {
        const x = (620 * this.t / this.end).toFixed(2);
        cursor.setAttribute("x1", x);
        cursor.setAttribute("x2", x);
      }
    }

    play() {
      if (this.t >= this.end) this.show(0);
      let before = performance.now();
      const tick = now => {
        this.show(this.t + (now - before) / 1000);
        before = now;
        if (this.t >= this.end) this.pause(); else this.timer = requestAnimationFrame(tick);
      };
      this.timer = requestAnimationFrame(tick);
      this.playing.textContent = "Pause";
    }

    pause() {
      cancelAnimationFrame(this.timer);
      this.timer = 0;
      this.playing.textContent = "Play";
    }

    toMoment(direction) {
      this.pause();
      const beyond = this.moments.filter(t => direction > 0 ? t > this.t + 1e-6 : t < this.t - 1e-6);
      if (beyond.length) this.show(direction > 0 ? beyond[0] : beyond[beyond.length - 1]);
    }

    key(event) {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const onButton = event.target.closest("button, a");
      const step = event.shiftKey ? 1 : 0.1;
      const onSlider = event.target === this.slider;
      const actions = {
        " ": () => this.timer ? this.pause() : this.play(),
        ArrowLeft: () => this.show(this.t - step),
        ArrowRight: () => this.show(this.t + step),
        Home: () => this.show(0),
        End: () => this.show(this.end),
        n: () => this.toMoment(1),
        p: () => this.toMoment(-1),
      };
      // A button keeps its own space bar.
      if (!actions[event.key] || (onButton && event.key === " ")) return;
      if (!onSlider && ["Home", "End"].includes(event.key)) return;
      if (event.key !== " " && event.key !== "n" && event.key !== "p") this.pause();
      actions[event.key]();
      event.preventDefault();
    }
  }

  const viewers = new Map();
  // A log's viewer is made when the log is first opened: pages may hold a hundred.
  const viewer = details => {
    const root = details.querySelector(".viewer");
    if (root && !viewers.has(details)) viewers.set(details, new Viewer(root));
    return viewers.get(details);
  };

  const jump = (index, t) => {
    const details = document.getElementById("log-" + index);
    if (!details) return;
    details.open = true;
    const made = viewer(details);
    if (made) {
      made.pause();
      made.show(t);
      made.root.scrollIntoView({ block: "start" });
      made.slider.focus({ preventScroll: true });
    } else {
      details.scrollIntoView({ block: "start" });
    }
    history.replaceState(null, "", `#log-${index}@${t}`);
  };

  const start = () => {
    document.documentElement.classList.add("js");
    for (const details of all(document, "details.log")) {
      details.addEventListener("toggle", () => { if (details.open) viewer(details); });
      if (details.open) viewer(details);
    }
    document.addEventListener("click", event => {
      const link = event.target.closest(".jump[data-t]");
      if (!link) return;
      event.preventDefault();
      jump(link.dataset.log, Number(link.dataset.t));
    });
    for (const button of all(document, ".open-all")) {
      button.hidden = false;
      button.addEventListener("click", () => {
        const open = button.dataset.open === "1";
        for (const details of all(document, "details.log")) details.open = open;
      });
    }
    const wanted = /^#log-(\d+)@([\d.]+)$/.exec(location.hash);
    if (wanted) jump(wanted[1], Number(wanted[2]));
  };
  start();
})();
