// The rest of the page: what the rig says is shown, what is asked for is sent. Limits, units and names come from the rig's `about`.
(() => {
  "use strict";
  const at = (id) => document.getElementById(id);
  const show = (id, text) => at(id).textContent !== text && (at(id).textContent = text);
  const number = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits));
  const decode = (payload) => new TextDecoder().decode(payload);

  // The connection.
  let client;
  let online = false;
  let saidOffline = false;
  const connect = () => {
    client?.end(true);
    let met = false;
    const { user, password } = airball.login();
    const login = user ? { username: user, password } : {};
    // Timers of a worker would need one more permission in the page's policy; a slow keep-alive bears a sleeping tab.
    client = mqtt.connect(airball.broker(), { ...login, protocolVersion: 4, reconnectPeriod: 1000, connectTimeout: 5000, keepalive: 120, timerVariant: "native", resubscribe: false });
    client.on("connect", () => {
      met = true;
      at("connection").open = false;
      link("connected");
      const own = ["about", "numbers", "critical_kp_per_mm", "status", "fault", "state", "reply", "cycles"].map((name) => airball.root + name);
      client.subscribe([...own, "airball/+/status"]);
      if (at("full").checked) stream();
    });
    // A broker may refuse a login by closing without a word.
    client.on("close", () => {
      if (!met) at("connection").open = true;
      link(met ? `connection lost to ${airball.broker()}, trying again` : `no answer from ${airball.broker()}: no broker is there, or it refuses this user; trying again`);
    });
    client.on("error", () => {});
    client.on("message", (topic, payload) => {
      if (topic.startsWith(airball.root)) airball.attempt(() => heard[topic.slice(airball.root.length)]?.(decode(payload)));
      else if (topic.endsWith("/status")) other(topic.split("/")[1], decode(payload) === "online");
    });
  };
  const send = (name, payload) => client.publish(`${airball.root}set/${name}`, String(payload), { qos: 1 });
  const link = (text) => {
    show("link", text);
    at("link").dataset.good = text === "connected";
    usable();
  };
  const usable = () => {
    const able = client?.connected && online && about !== undefined;
    for (const part of [...document.querySelectorAll("fieldset"), at("full")]) part.disabled = !able;
  };

  // What the rig says.
  let about;
  let latest;
  let inForce = {};
  let spoke = -Infinity;
  let batches = -Infinity;
  // A rig that is online and says nothing for two seconds is worth a word of its own.
  const rig = () => {
    const silent = performance.now() > spoke + 2000;
    const fresh = Boolean(client?.connected) && online && !silent;
    show("rig-state", online ? (silent ? "rig silent" : "rig online") : "rig offline");
    at("rig-state").dataset.good = online && !silent;
    // What is shown is of some time ago: it must not look like now.
    document.body.dataset.stale = !fresh;
    document.body.dataset.online = online;
    if (latest) show("mode", `${fresh ? "" : "was "}${latest.mode.replace("_", " ")}`);
    if (!online) show("fault", "");
    at("others").hidden = online || others.size === 0;
  };
  setInterval(rig, 500);

  // Other rigs of the broker, for who is at one that is offline.
  const others = new Set();
  const other = (name, there) => {
    others[there ? "add" : "delete"](name);
    const link = (name) => Object.assign(document.createElement("a"), { href: airball.pageOf(location.pathname, name), textContent: name });
    at("others").replaceChildren("Online: ", ...[...others].sort().flatMap((name, k) => [k ? ", " : "", link(name)]));
    rig();
  };
  const heard = {
    status: (text) => {
      online = text === "online";
      saidOffline = text === "offline";
      usable();
      rig();
    },
    about: (text) => {
      about = JSON.parse(text);
      offer(about);
      charts.fit(about);
      usable();
    },
    state: (text) => {
      const before = latest?.mode;
      latest = JSON.parse(text);
      spoke = performance.now();
      tell(latest);
      rig();
      // A stop that was obeyed and is over is said no longer.
      if (before === "stopped" && latest.mode !== "stopped") show("stop-said", "");
      if (performance.now() > batches + 500) charts.add([latest]);
    },
    cycles: (text) => {
      const { cycles, dropped } = JSON.parse(text);
      batches = performance.now();
      charts.add(cycles);
      show("rate", `${cycles.length} cycles in the last batch, ${dropped} dropped`);
    },
    numbers: (text) => {
      inForce = JSON.parse(text);
      fill();
    },
    critical_kp_per_mm: (text) => {
      critical = JSON.parse(text);
      judge();
    },
    fault: (text) => {
      const { at: when, fault } = JSON.parse(text);
      show("last-fault", `Last fault, ${when}: ${fault}`);
    },
    reply: (text) => {
      const { topic, accepted, reason } = JSON.parse(text);
      if (topic !== "set/stream" || !accepted) show("reply", accepted ? `${topic.slice(4)}: in force` : `${topic.slice(4)} refused: ${reason}`);
      at("reply").dataset.good = accepted;
    },
  };

  const tell = (state) => {
    show("position", number(state.position_mm, 0));
    show("setpoint", number(state.setpoint_mm, 0));
    show("duty", number(state.duty_percent, 2));
    show("flying-controller", state.controller.replaceAll("_", " "));
    show("experiment", state.experiment ?? "none");
    show("fault", state.stopped_by ? `${state.stopped_by}. The fan is off. Then press "Fly again".` : (state.fault ?? ""));
    // While it stops the rig, it is above.
    at("last-fault").hidden = Boolean(state.stopped_by);
    const { p50_us, p99_us, p99_9_us, max_us } = state.lateness;
    show("lateness", `half within ${number(p50_us, 0)} µs, 99 % within ${number(p99_us, 0)} µs, 99.9 % within ${number(p99_9_us, 0)} µs, all within ${number(max_us, 0)} µs`);
    show("late", `${state.late_cycles} late cycles; lost: ${state.dropped_log_messages} log messages, ${state.dropped_mqtt_messages} MQTT messages`);
    follow(state);
  };

  // Controls show what is in force, unless somebody is at them.
  let touched = -Infinity;
  const touch = () => (touched = performance.now());
  const follow = (state) => {
    if (performance.now() < touched + 1500) return;
    if (state.setpoint_mm !== null) slide(state.setpoint_mm);
    if (document.activeElement !== at("controller")) at("controller").value = state.controller;
    for (const input of at("gains").querySelectorAll("input:not([data-edited])")) {
      if (document.activeElement !== input) input.value = state[input.name] ?? "";
    }
    judge();
  };

  // The gain that is typed, or in force, beside the one at which the model's loop loses stability.
  let critical = null;
  const judge = () => {
    const input = at("gains").querySelector('[name="kp_per_mm"]');
    const said = critical === null ? "" : critical.toPrecision(3);
    show("critical", critical === null ? "" : `By the model, the ball oscillates from K_p = ${said} on.`);
    const high = critical !== null && input && Number(input.value) > critical / 2;
    show("gain-warning", high ? `K_p is above half of the critical ${said}: the ball will swing.` : "");
  };
  // Infinity has no number in JSON: it is shown as an empty field.
  const fill = () => {
    for (const input of at("numbers").querySelectorAll(":is(input, select):not([data-edited])")) {
      if (document.activeElement !== input) input.value = inForce[input.name] ?? "";
    }
  };
  const slide = (mm) => {
    at("slider").value = mm;
    at("wanted").value = Math.round(mm);
    at("slider").setAttribute("aria-valuetext", `${Math.round(mm)} millimetres`);
  };

  const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
  const offer = ({ setpoint_mm: { min, max }, controllers, gains, numbers = [], experiments, rig, simulated, version }) => {
    show("about", `${rig}${simulated ? ", simulated" : ""}, airball ${version}`);
    for (const input of [at("slider"), at("wanted")]) Object.assign(input, { min, max });
    show("limits", `${min} to ${max} mm are safe`);
    at("controller").replaceChildren(...controllers.map((name) => option(name, name.replaceAll("_", " "))));
    at("experiments").replaceChildren(...experiments.map(({ name, title, duration_s }) => option(name, `${name}: ${title}, ${Math.round(duration_s)} s`)));
    at("gains").replaceChildren(...gains.map(gain));
    at("gain-set").hidden = gains.length === 0;
    judge();
    at("numbers").replaceChildren(...numbers.map((number) => gain({ ...number, symbol: number.name })));
    at("number-set").hidden = numbers.length === 0;
    fill();
    if (latest) follow(latest);
  };
  const gain = ({ name, symbol, unit, min, max, words = [], absent = false }) => {
    const label = document.createElement("label");
    const choice = () => {
      const select = Object.assign(document.createElement("select"), { name });
      select.append(...words.map((word) => option(word, word.replaceAll("_", " "))));
      return select;
    };
    const input = words.length > 0 ? choice() : Object.assign(document.createElement("input"), { type: "number", name, min, step: "any", inputMode: "decimal" });
    if (words.length === 0 && max !== null) input.max = max;
    label.append(Object.assign(document.createElement("span"), { textContent: unit ? `${symbol}, ${unit}` : symbol }), input);
    const range = `accepted: ${max === null ? `at least ${min}` : `${min} to ${max}`}`;
    if (words.length === 0) label.append(Object.assign(document.createElement("small"), { textContent: absent ? `${range}; off as the flight began` : range }));
    input.addEventListener("input", () => {
      input.dataset.edited = "";
      judge();
    });
    return label;
  };

  // What is asked for. A slider in motion sends ten times a second at most, and where it came to rest.
  let due = 0;
  let later;
  const move = (mm) => {
    touch();
    slide(mm);
    clearTimeout(later);
    const wait = due - performance.now();
    if (wait > 0) later = setTimeout(() => move(mm), wait);
    else {
      due = performance.now() + 100;
      send("setpoint_mm", mm);
    }
  };
  at("slider").addEventListener("input", () => move(Number(at("slider").value)));
  at("setpoint-form").addEventListener("submit", (event) => {
    event.preventDefault();
    move(Number(at("wanted").value));
  });
  at("wanted").addEventListener("input", touch);
  for (const mode of ["fly", "programme"]) at(mode).addEventListener("click", () => send("mode", mode));
  at("controller").addEventListener("change", () => send("controller", at("controller").value));
  for (const [form, fields] of [["gain-form", "gains"], ["number-form", "numbers"]]) {
    at(form).addEventListener("submit", (event) => {
      event.preventDefault();
      const edited = [...at(fields).querySelectorAll("[data-edited]")].filter((input) => input.value !== "");
      const value = (input) => (input.localName === "select" ? input.value : Number(input.value));
      if (edited.length > 0) send(fields, JSON.stringify(Object.fromEntries(edited.map((input) => [input.name, value(input)]))));
      for (const input of at(fields).querySelectorAll("[data-edited]")) delete input.dataset.edited;
      touch();
    });
  }
  at("undo").addEventListener("click", () => send("numbers", "undo"));
  at("experiment-form").addEventListener("submit", (event) => {
    event.preventDefault();
    send("experiment", at("experiments").value);
  });
  at("connection-form").addEventListener("submit", (event) => {
    event.preventDefault();
    connect();
  });
  document.addEventListener("broker", () => connect());
  document.addEventListener("stop-sent", () => {
    // A page that has not heard of the rig knows nothing better than the broker's word.
    if (client?.connected && saidOffline) show("stop-said", "Stop sent, but the rig is offline and has not heard it. If its fan turns, switch off the fan's supply.");
  });

  // Every cycle, for as long as the box is ticked and the page is looked at: the rig forgets the asking after five seconds.
  const stream = () => client.connected && send("stream", at("full").checked ? "full" : "off");
  at("full").addEventListener("change", () => {
    stream();
    if (!at("full").checked) show("rate", "");
  });
  setInterval(() => at("full").checked && !document.hidden && stream(), 2000);

  connect();
})();
