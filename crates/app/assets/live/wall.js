// All rigs of a broker, a tile each. It watches and commands nothing; a tile leads to the page of its rig.
(() => {
  "use strict";
  const at = (id) => document.getElementById(id);
  const SILENT_MS = 2000;
  const rigs = new Map();
  const { page } = document.documentElement.dataset;
  const number = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits));
  const show = (element, text) => element.textContent !== text && (element.textContent = text);
  const order = new Intl.Collator("en", { numeric: true }).compare;

  const element = (kind, name, text = "") => Object.assign(document.createElement(kind), { className: name, textContent: text });
  const made = (name) => {
    const tile = element("li", "tile");
    const title = element("h2", "");
    title.append(Object.assign(element("a", "", name), { href: airball.pageOf(page, name) }));
    const parts = { word: element("span", "word"), height: element("span", "height"), values: element("p", "values"), fault: element("p", "fault") };
    const pipe = element("span", "pipe");
    pipe.setAttribute("aria-hidden", "true");
    pipe.append(parts.height);
    title.append(" ", parts.word);
    tile.append(pipe, title, parts.values, parts.fault);
    return { name, tile, parts, spoke: -Infinity };
  };
  const of = (name) => {
    if (!rigs.has(name)) {
      rigs.set(name, made(name));
      at("rigs").replaceChildren(...[...rigs.values()].sort((a, b) => order(a.name, b.name)).map(({ tile }) => tile));
    }
    return rigs.get(name);
  };
  const told = {
    status: (rig, text) => (rig.online = text === "online"),
    fault: (rig, text) => (rig.last = JSON.parse(text)),
    about: (rig, text) => (rig.top = JSON.parse(text).position_mm.max),
    state: (rig, text) => {
      rig.state = JSON.parse(text);
      rig.spoke = performance.now();
    },
  };

  const draw = () => {
    const connected = Boolean(client.connected);
    let faults = 0;
    for (const { tile, parts, online, spoke, state, last, top } of rigs.values()) {
      const silent = performance.now() > spoke + SILENT_MS;
      const fresh = connected && online && !silent;
      const fault = online && connected ? (state?.stopped_by ?? state?.fault) : undefined;
      faults += Number(Boolean(fault));
      tile.dataset.stale = !fresh;
      tile.dataset.fault = Boolean(fault);
      show(parts.word, online ? (silent || !state ? "silent" : state.mode.replace("_", " ")) : "offline");
      parts.word.dataset.good = fresh && !fault;
      show(parts.values, state ? `${number(state.position_mm, 0)} of ${number(state.setpoint_mm, 0)} mm, duty ${number(state.duty_percent, 1)} %` : "");
      parts.height.style.bottom = `${Math.max(0, Math.min(100, (100 * (state?.position_mm ?? 0)) / (top ?? 600)))}%`;
      show(parts.fault, fault ?? (last && !last.acknowledged ? `Last fault, ${last.at}: ${last.fault}` : ""));
    }
    const there = [...rigs.values()].filter(({ online }) => online).length;
    show(at("count"), connected ? `${rigs.size} ${rigs.size === 1 ? "rig" : "rigs"}, ${there} online, ${faults} with a fault` : `no connection to ${airball.broker()}, trying again`);
    at("none").hidden = !connected || rigs.size > 0;
  };

  let client;
  const connect = () => {
    client?.end(true);
    let met = false;
    const { user, password } = airball.login();
    client = mqtt.connect(airball.broker(), { ...(user ? { username: user, password } : {}), protocolVersion: 4, reconnectPeriod: 1000, connectTimeout: 5000, keepalive: 120, timerVariant: "native", resubscribe: false });
    client.on("connect", () => {
      met = true;
      at("connection").open = false;
      client.subscribe(Object.keys(told).map((name) => `airball/+/${name}`));
    });
    client.on("close", () => !met && (at("connection").open = true));
    client.on("error", () => {});
    client.on("message", (topic, payload) => {
      const [, name, kind] = topic.split("/");
      airball.attempt(() => told[kind](of(name), new TextDecoder().decode(payload)));
    });
  };
  at("connection-form").addEventListener("submit", (event) => {
    event.preventDefault();
    connect();
  });
  document.addEventListener("broker", connect);
  connect();
  setInterval(draw, 250);
})();
