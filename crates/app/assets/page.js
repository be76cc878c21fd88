// Charts that zoom in place of the still pictures, and buttons that copy. The page says all it has to say without it.
(() => {
  "use strict";
  const SYNC = "record";
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const place = document.getElementById("record-charts");
  const data = JSON.parse(document.getElementById("series").textContent);
  let charts = [];

  const make = (tag, properties, parent) => parent.appendChild(Object.assign(document.createElement(tag), properties));

  // What all charts show of the time, and all there is of it.
  const times = data.flatMap((chart) => [chart.times[0], chart.times.at(-1)]).filter(Number.isFinite);
  const all = { min: Math.min(...times), max: Math.max(...times) };
  let shown = { ...all };
  let moving = false;

  const show = (min, max) => {
    const span = Math.min(Math.max(max - min, 0.2), all.max - all.min);
    const from = Math.min(Math.max(min, all.min), all.max - span);
    shown = { min: from, max: from + span };
    moving = true;
    charts.forEach((chart) => chart.setScale("x", shown));
    moving = false;
    place.dataset.from = shown.min.toFixed(3);
    place.dataset.to = shown.max.toFixed(3);
  };
  const scale = (factor) => {
    const middle = (shown.min + shown.max) / 2;
    const half = (factor * (shown.max - shown.min)) / 2;
    show(middle - half, middle + half);
  };
  const shift = (share) => {
    const by = share * (shown.max - shown.min);
    show(shown.min + by, shown.max + by);
  };
  const actions = [
    ["Zoom in", "+", () => scale(0.5)],
    ["Zoom out", "-", () => scale(2)],
    ["Earlier", "ArrowLeft", () => shift(-0.25)],
    ["Later", "ArrowRight", () => shift(0.25)],
    ["Show all", "0", () => show(all.min, all.max)],
  ];

  const options = (chart, width) => ({
    width,
    height: width < 600 ? 220 : 260,
    cursor: { sync: { key: SYNC }, drag: { x: true, y: false } },
    scales: { x: { time: false } },
    legend: { live: true },
    axes: [
      { label: "time, s", labelSize: 18, size: 28, gap: 2, font: font(), labelFont: font(), stroke: ink("axis"), grid: { show: false }, ticks: { stroke: ink("grid"), width: 1, size: 5 } },
      { size: 52, font: font(), stroke: ink("axis"), grid: { stroke: ink("grid"), width: 1 }, ticks: { stroke: ink("grid"), width: 1, size: 5 } },
    ],
    series: [
      { label: "time, s", value: (_, value) => (value == null ? "–" : value.toFixed(2)) },
      ...chart.lines.map((line) => ({
        label: line.label || chart.ordinate.split(",")[0],
        stroke: ink(line.ink),
        width: line.ink === "setpoint" ? 1 : 1.6,
        spanGaps: false,
        points: { show: false },
        value: (_, value) => (value == null ? "–" : value.toFixed(chart.places - 1)),
      })),
    ],
    hooks: {
      drawClear: [(u) => ground(u, chart)],
      setScale: [
        (u, key) => {
          const { min, max } = u.scales.x;
          if (key === "x" && !moving && min !== null && (min !== shown.min || max !== shown.max)) show(min, max);
        },
      ],
    },
  });
  // Shaded stretches, and a dashed line at each event.
  const ground = (u, chart) => {
    const { ctx } = u;
    const { left, top, width, height } = u.bbox;
    const x = (time) => Math.min(Math.max(u.valToPos(time, "x", true), left), left + width);
    ctx.save();
    ctx.fillStyle = ink("shade");
    ctx.globalAlpha = 0.28;
    for (const [from, to] of chart.shaded) ctx.fillRect(x(from), top, x(to) - x(from), height);
    ctx.globalAlpha = 1;
    ctx.strokeStyle = ink("setpoint");
    ctx.setLineDash([4, 4]);
    for (const time of chart.events.filter((time) => time >= shown.min && time <= shown.max)) {
      ctx.beginPath();
      ctx.moveTo(x(time), top);
      ctx.lineTo(x(time), top + height);
      ctx.stroke();
    }
    ctx.restore();
  };
  const font = () => `12px ${getComputedStyle(document.body).fontFamily}`;

  // Readings that were not taken leave no gap in a line: only what a model does not forecast does.
  const values = (chart) => (line) => {
    if (!line.whole) return line.values;
    const joined = line.values.map((v) => (v === null ? undefined : v));
    // Between two flights every line ends.
    for (const end of chart.breaks) {
      const k = chart.times.findIndex((time) => time >= end - 1e-3);
      if (k > 0) joined[k - 1] = null;
    }
    return joined;
  };

  const draw = () => {
    charts.forEach((chart) => chart.destroy());
    const holders = place.querySelectorAll(".chart .plot");
    charts = data.map((chart, k) => new uPlot(options(chart, holders[k].clientWidth), [chart.times, ...chart.lines.map(values(chart))], holders[k]));
    show(shown.min, shown.max);
  };

  const replace = () => {
    const stills = place.querySelectorAll(".still");
    const tools = make("div", { className: "tools" }, place);
    tools.setAttribute("role", "group");
    tools.setAttribute("aria-label", "Zoom of all charts");
    place.prepend(tools);
    for (const [label, , action] of actions) make("button", { type: "button", textContent: label, onclick: action }, tools);
    data.forEach((chart, k) => {
      const holder = make("div", { className: "chart", tabIndex: 0 }, place);
      stills[k].before(holder);
      stills[k].style.display = "none";
      holder.setAttribute("role", "group");
      holder.setAttribute("aria-label", `${stills[k].querySelector("svg")?.getAttribute("aria-label") ?? chart.ordinate}; zoom by +, -, arrows and 0`);
      make("p", { className: "title", textContent: chart.ordinate }, holder);
      make("div", { className: "plot" }, holder);
      holder.addEventListener("keydown", (event) => {
        const action = actions.find(([, key]) => key === event.key || (key === "+" && event.key === "="));
        if (action && !event.ctrlKey && !event.metaKey && !event.altKey) {
          event.preventDefault();
          action[2]();
        }
      });
    });
  };

  if (place && times.length > 0) {
    replace();
    draw();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    let width = place.clientWidth;
    new ResizeObserver(() => {
      if (place.clientWidth !== width && place.clientWidth > 0) {
        width = place.clientWidth;
        draw();
      }
    }).observe(place);
  }

  for (const hint of document.querySelectorAll(".script-only")) hint.hidden = false;
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const text = document.getElementById(button.dataset.copy);
      try {
        await navigator.clipboard.writeText(`${text.textContent}\n`);
        button.textContent = "Copied";
      } catch {
        getSelection().selectAllChildren(text);
        button.textContent = "Selected";
      }
    });
  }
})();
