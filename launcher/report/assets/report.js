// A cursor with values, and zoom: drag to zoom, double click to see all again. Figures with the same axis move together.
"use strict";
(() => {
  const views = [];
  const clock = { h: [1, 2, 3, 6, 12, 24, 48, 72, 168], min: [1, 2, 5, 10, 15, 30, 60] }; // as in ticks.cpp
  const niceTicks = (low, high, count, unit) => {
    const raw = (high - low) / count, magnitude = 10 ** Math.floor(Math.log10(raw));
    const decimal = magnitude * ([1, 2, 2.5, 5, 10].find((m) => m * magnitude >= raw) || 10);
    const step = (raw > 0.5 && (clock[unit] || []).find((s) => s >= raw)) || decimal;
    const ticks = [];
    for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) ticks.push(Math.abs(v) < 1e-12 * step ? 0 : v);
    return ticks;
  };
  for (const data of figures) {
    const figure = document.getElementById(data.id), svg = figure.querySelector("svg"), d = svg.dataset;
    const n = (key) => Number(d[key]);
    const all = { from: n("from"), to: n("to") }, box = { left: n("left"), right: n("right"), top: n("top"), bottom: n("bottom") };
    const unit = n("unitS"), zero = n("zero"), ns = svg.namespaceURI, plot = svg.querySelector(".plot"), ticks = svg.querySelector(".ticks");
    const make = (tag, attributes, parent) => {
      const element = document.createElementNS(ns, tag);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      parent.appendChild(element);
      return element;
    };
    const cursor = make("line", { stroke: "currentColor", "stroke-opacity": 0.5, y1: box.top, y2: box.bottom, visibility: "hidden" }, svg);
    const band = make("rect", { fill: "currentColor", "fill-opacity": 0.1, y: box.top, height: box.bottom - box.top, visibility: "hidden" }, svg);
    const tip = figure.appendChild(Object.assign(document.createElement("div"), { className: "tip" }));
    const view = { from: all.from, to: all.to, all, axis: d.axis };
    const together = () => views.filter((other) => other.axis === view.axis);
    const toX = (t) => box.left + ((t - view.from) / (view.to - view.from)) * (box.right - box.left);
    const toTime = (x) => view.from + ((x - box.left) / (box.right - box.left)) * (view.to - view.from);
    const svgX = (event) => {
      const r = svg.getBoundingClientRect();
      return Math.min(box.right, Math.max(box.left, ((event.clientX - r.left) / r.width) * svg.viewBox.baseVal.width));
    };
    view.draw = () => {
      const scale = (all.to - all.from) / (view.to - view.from);
      plot.setAttribute("transform", `translate(${box.left - scale * (box.left + ((view.from - all.from) / (all.to - all.from)) * (box.right - box.left))} 0) scale(${scale} 1)`);
      ticks.querySelectorAll(".tx").forEach((tick) => tick.remove());
      for (const v of niceTicks((view.from - zero) / unit, (view.to - zero) / unit, 10, d.unit)) {
        const x = toX(zero + v * unit), group = make("g", { class: "tx" }, ticks);
        make("line", { class: "grid", x1: x, x2: x, y1: box.bottom, y2: box.top }, group);
        make("text", { x, y: box.bottom + 15, "text-anchor": "middle" }, group).textContent = String(Number(v.toPrecision(8)));
      }
      svg.querySelectorAll(".tm").forEach((label) => {
        const x = toX(Number(label.dataset.t));
        label.setAttribute("x", x);
        label.setAttribute("visibility", x >= box.left && x <= box.right ? "visible" : "hidden");
      });
    };
    view.show = (t) => {
      const x = toX(t);
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
      cursor.setAttribute("visibility", x >= box.left && x <= box.right ? "visible" : "hidden");
    };
    view.hide = () => { cursor.setAttribute("visibility", "hidden"); tip.style.display = "none"; };
    const valueAt = (series, t) => {
      let low = 0, high = series.t.length - 1;
      if (high < 0 || t < series.t[0]) return null;
      while (low < high) { const middle = (low + high + 1) >> 1; if (series.t[middle] <= t) low = middle; else high = middle - 1; }
      return series.v[low];
    };
    let dragFrom = null;
    svg.addEventListener("pointermove", (event) => {
      const x = svgX(event), t = toTime(x);
      together().forEach((other) => other.show(t));
      const html = (tag, more) => Object.assign(document.createElement(tag), more);
      tip.replaceChildren(html("b", { textContent: `${((t - zero) / unit).toFixed(3)} ${d.unit}` }), ...data.series.flatMap((s) => { // names are text
        const v = valueAt(s, t), dot = html("i");
        dot.style.background = s.colour;
        return [html("br"), dot, `${s.name} ${v === null ? "–" : Number(v.toPrecision(5))}`];
      }));
      const r = figure.getBoundingClientRect(), right = event.clientX - r.left > r.width / 2;
      Object.assign(tip.style, { display: "block", top: `${event.clientY - r.top + 12}px`, left: right ? "auto" : `${event.clientX - r.left + 14}px`,
        right: right ? `${r.right - event.clientX + 14}px` : "auto" });
      if (dragFrom !== null) {
        band.setAttribute("visibility", "visible");
        band.setAttribute("x", Math.min(dragFrom, x));
        band.setAttribute("width", Math.abs(x - dragFrom));
      }
    });
    svg.addEventListener("pointerleave", () => views.forEach((other) => other.hide()));
    svg.addEventListener("pointerdown", (event) => { dragFrom = svgX(event); svg.setPointerCapture(event.pointerId); });
    svg.addEventListener("pointerup", (event) => {
      const x = svgX(event);
      if (dragFrom !== null && Math.abs(x - dragFrom) > 6) {
        const [from, to] = [toTime(Math.min(dragFrom, x)), toTime(Math.max(dragFrom, x))];
        together().forEach((other) => { Object.assign(other, { from, to }); other.draw(); });
      }
      dragFrom = null;
      band.setAttribute("visibility", "hidden");
    });
    svg.addEventListener("dblclick", () => together().forEach((other) => { Object.assign(other, other.all); other.draw(); }));
    views.push(view);
  }
})();
