// The last half minute as two charts over the same time: setpoint and position, and the duty below them.
const charts = (() => {
  "use strict";
  const SPAN_S = 30;
  // States and batches of cycles come on two topics: a batch may begin before the state that was drawn last.
  const OVERLAP_S = 5;
  // Pixels, on a wide screen and on a phone.
  const HEIGHTS = { height: [280, 210], duty: [150, 120] };
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const font = () => `12px ${getComputedStyle(document.body).fontFamily}`;
  const holders = { height: document.getElementById("height-chart"), duty: document.getElementById("duty-chart") };
  let pipe = [0, 600];
  // The duty moves within a few percent of hover: what it did fills the chart, in no less than five percent.
  const about = (min, max) => {
    const half = Math.max(2.5, 0.6 * (max - min));
    const middle = Math.max((min + max) / 2, half);
    return [middle - half, middle + half];
  };
  const range = { height: () => pipe, duty: (_, min, max) => (min === null ? [0, 50] : about(min, max)) };
  const KEYS = ["setpoint_mm", "position_mm", "duty_percent"];
  let times = [];
  let columns = KEYS.map(() => []);
  let drawn = [];
  let waiting = false;

  const options = (kind, label, lines) => ({
    width: holders[kind].clientWidth,
    height: HEIGHTS[kind][Number(holders[kind].clientWidth < 600)],
    cursor: { sync: { key: "live" }, drag: { x: false, y: false } },
    legend: { show: false },
    scales: { x: { time: false, range: () => [end() - SPAN_S, end()] }, y: { range: range[kind] } },
    axes: [
      { size: 30, gap: 2, font: font(), stroke: ink("axis"), grid: { show: false }, ticks: { stroke: ink("grid"), width: 1, size: 5 }, values: (_, ticks) => ticks.map((tick) => (tick < 0 ? "" : `${tick} s`)) },
      { size: 52, label, labelSize: 18, labelFont: font(), font: font(), stroke: ink("axis"), grid: { stroke: ink("grid"), width: 1 }, ticks: { stroke: ink("grid"), width: 1, size: 5 } },
    ],
    series: [{}, ...lines.map(([name, colour, width]) => ({ label: name, stroke: ink(colour), width, points: { show: false }, paths: name === "position" ? undefined : uPlot.paths.stepped({ align: 1 }) }))],
  });
  const end = () => times.at(-1) ?? SPAN_S;

  const redraw = () => {
    drawn.forEach((chart) => chart.destroy());
    drawn = [
      new uPlot(options("height", "height, mm", [["setpoint", "setpoint", 1.5], ["position", "recorded", 1.8]]), [times, columns[0], columns[1]], holders.height),
      new uPlot(options("duty", "duty, %", [["duty", "duty", 1.8]]), [times, columns[2]], holders.duty),
    ];
  };
  const refresh = () => {
    waiting = false;
    drawn[0]?.setData([times, columns[0], columns[1]]);
    drawn[1]?.setData([times, columns[2]]);
  };

  /** Takes cycles that are newer than the last. One from long before the last, or from before all that are drawn, is of a new flight. */
  const add = (cycles) => {
    for (const cycle of cycles) {
      if (cycle.time_s < times.at(-1) - OVERLAP_S || cycle.time_s < times[0]) {
        times = [];
        columns = KEYS.map(() => []);
      }
      if (cycle.time_s <= times.at(-1)) continue;
      times.push(cycle.time_s);
      KEYS.forEach((key, k) => columns[k].push(cycle[key]));
    }
    const old = times.findIndex((time) => time >= end() - SPAN_S);
    if (old > 0) [times, ...columns] = [times, ...columns].map((values) => values.slice(old));
    if (!waiting && !document.hidden) {
      waiting = true;
      requestAnimationFrame(refresh);
    }
  };
  const fit = ({ position_mm: { min, max } }) => {
    pipe = [min, max];
    redraw();
  };

  redraw();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  let width = holders.height.clientWidth;
  new ResizeObserver(() => {
    if (holders.height.clientWidth !== width && holders.height.clientWidth > 0) {
      width = holders.height.clientWidth;
      redraw();
    }
  }).observe(holders.height);
  return { add, fit, times: () => times };
})();
