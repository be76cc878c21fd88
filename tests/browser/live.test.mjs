// Flies the simulated rig from the live page in Debian's Chromium. tests/tests/live_page.rs starts rig and broker, and says where: URL, the
// page as its broker serves it; FILE, the same page on the disk; BROKER, the broker's WebSockets; USER_NAME and PASSWORD, and
// RIG_NAME, who may speak as a rig, with the same password.
// SHOTS, a directory: pictures of the page are left there, to be looked at.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { DESK, PHONE, browserOfTests, complaints, invalid, open as openPage, shoot } from "./browser.mjs";

const { URL: SERVED, FILE, BROKER, USER_NAME, RIG_NAME, PASSWORD } = process.env;
const PATIENCE = 60_000;

const browser = browserOfTests();

const open = ({ url = SERVED, ...options } = {}) => openPage(browser(), url, { broker: BROKER, patience: PATIENCE, ...options });

async function connect(page) {
  await page.locator("#connection").evaluate((details) => (details.open = true));
  await page.getByLabel("User").fill(USER_NAME);
  await page.getByLabel("Password").fill(PASSWORD);
  await page.getByRole("button", { name: "Connect" }).click();
}

async function login(page) {
  await connect(page);
  await page.getByText("rig online", { exact: true }).waitFor();
}

/** Clicks a link to rig1 and waits for its page: a click alone returns before the page has changed. */
async function follow(page, link) {
  await link.click();
  await page.waitForURL((url) => url.searchParams.get("rig") === "rig1");
}

async function flying(options) {
  const opened = await open(options);
  await login(opened.page);
  const { page } = opened;
  await until(page, "a state", async () => (await text(page, "position")) !== "–");
  if ((await text(page, "mode")) === "stopped") await page.getByRole("button", { name: "Fly again" }).click();
  await until(page, "flying", async () => (await text(page, "mode")) === "flying");
  // The broker refused the page before anybody had logged in: that is said, and no fault of the page.
  opened.wrong.length = 0;
  return opened;
}

const text = (page, id) => page.locator(`#${id}`).innerText();
const position = async (page) => Number(await text(page, "position"));

async function until(page, what, look) {
  const deadline = Date.now() + PATIENCE;
  while (!(await look())) {
    assert.ok(Date.now() < deadline, `still not true after ${PATIENCE} ms: ${what}; ${await page.locator("body").innerText()}`);
    await page.waitForTimeout(100);
  }
}

test("live: is valid HTML, in one small file", async () => {
  assert.deepEqual(await invalid(FILE), []);
  assert.ok(readFileSync(FILE).length < 1e6);
});

test("live: the slider moves the ball, by mouse and by keys, within the rig's limits", async () => {
  const { page, wrong } = await flying();
  const slider = page.getByLabel("Height, mm");
  assert.deepEqual(await slider.evaluate(({ min, max }) => [min, max]), ["30", "550"]);
  await slider.fill("430");
  // The ball may be there before the command is: it starts near.
  await until(page, "the ball is asked to 430 mm", async () => (await text(page, "setpoint")) === "430");
  await until(page, "the ball is at 430 mm", async () => Math.abs((await position(page)) - 430) < 25);
  assert.equal(await slider.getAttribute("aria-valuetext"), "430 millimetres");
  await slider.focus();
  await page.keyboard.press("ArrowDown");
  await until(page, "one millimetre less", async () => (await text(page, "setpoint")) === "429");
  await page.getByLabel("Number, mm").fill("250");
  await page.keyboard.press("Enter");
  await until(page, "the ball is at 250 mm", async () => Math.abs((await position(page)) - 250) < 25);
  assert.match(await text(page, "reply"), /setpoint_mm: in force/);
  assert.deepEqual(wrong, []);
});

test("live: the stop button stops the fan, and the ball is lifted again", async () => {
  const { page, wrong } = await flying();
  await page.getByRole("button", { name: "STOP", exact: true }).click();
  await until(page, "stopped", async () => (await text(page, "mode")) === "stopped" && (await text(page, "duty")) === "0.00");
  assert.match(await text(page, "stop-said"), /the broker has it/);
  await shoot(page, "live-stopped");
  await page.getByRole("button", { name: "Fly again" }).click();
  await until(page, "flying", async () => (await text(page, "mode")) === "flying");
  assert.deepEqual(wrong, []);
});

test("live: the stop button works when every other script has failed and the page's connection is gone", async () => {
  const { page: witness } = await flying();
  const { page } = await open();
  await page.getByLabel("User").waitFor({ state: "attached" });
  await page.locator("#connection").evaluate((details) => (details.open = true));
  await page.getByLabel("User").fill(USER_NAME);
  await page.getByLabel("Password").fill(PASSWORD);
  await page.evaluate(() => {
    for (const name of ["mqtt", "uPlot"]) window[name] = undefined;
    Object.defineProperty(window, "charts", { get: () => { throw new Error("charts are broken"); } });
    setInterval(() => { throw new Error("and so is the rest"); }, 20);
  });
  await page.getByRole("button", { name: "STOP", exact: true }).click();
  await until(witness, "stopped", async () => (await text(witness, "mode")) === "stopped");
  await page.getByText("the broker has it").waitFor();
  await witness.getByRole("button", { name: "Fly again" }).click();
  await until(witness, "flying", async () => (await text(witness, "mode")) === "flying");
});

test("live: a page whose other script never ran can still stop", async () => {
  const { page: witness } = await flying();
  const broken = readFileSync(FILE, "utf8").replace('"use strict";var mqtt=', '"use strict";throw new Error("broken");var mqtt=');
  // Served by the broker as well: of a page that a test makes up, Chromium does not know that it may talk to this machine.
  writeFileSync(FILE.replace(/[^/]*$/, "broken.html"), broken.replace(/<meta http-equiv="Content-Security-Policy"[^>]*>/, ""));
  const { page, wrong } = await open({ bypassCSP: true, url: `${SERVED}broken.html` });
  assert.match(wrong.join(), /broken/);
  await page.locator("#connection").evaluate((details) => (details.open = true));
  await page.getByLabel("User").fill(USER_NAME);
  await page.getByLabel("Password").fill(PASSWORD);
  await page.getByRole("button", { name: "STOP", exact: true }).click();
  await until(witness, "stopped", async () => (await text(witness, "mode")) === "stopped");
  await witness.getByRole("button", { name: "Fly again" }).click();
});

test("live: without a broker the stop button says so, and what to do", async () => {
  const { page } = await open({ url: `${pathToFileURL(FILE).href}?broker=ws://127.0.0.1:1` });
  await page.getByRole("button", { name: "Use this broker" }).click();
  await page.getByRole("button", { name: "STOP", exact: true }).click();
  await page.getByText("Switch off the fan's supply").waitFor();
});

test("live: gains, controller and experiment are changed, and a refusal is said with its reason", async () => {
  const { page, wrong } = await flying();
  const gain = page.getByLabel("K_p, %/mm");
  await gain.fill("0.015");
  await page.getByRole("button", { name: "Change together" }).click();
  await page.getByText("gains: in force").waitFor();
  await page.getByText("Controllers, compensation and observer").click();
  const fan = page.getByLabel("lqg.fan");
  await fan.fill("0.6");
  await page.getByRole("button", { name: "Change numbers together" }).click();
  await page.getByText("numbers: in force").waitFor();
  await page.getByRole("button", { name: "Undo the last change" }).click();
  await until(page, "the number is back", async () => (await fan.inputValue()) === "0.6968");
  // A switch, with the number that it needs, as one change.
  const dither = page.locator('select[name="compensation.dither"]');
  await dither.selectOption("on");
  await page.getByLabel("compensation.dither.step_percent").fill("0.2");
  await page.getByRole("button", { name: "Change numbers together" }).click();
  await until(page, "the number is in force", async () => (await page.getByLabel("compensation.dither.step_percent").inputValue()) === "0.2");
  await page.getByRole("button", { name: "Undo the last change" }).click();
  await until(page, "the switch is back", async () => (await dither.inputValue()) === "off");
  await page.getByRole("combobox", { name: "Flies, from now on" }).selectOption("lqg");
  await until(page, "lqg flies", async () => (await text(page, "flying-controller")) === "lqg");
  await page.getByRole("combobox", { name: "Flies, from now on" }).selectOption("pid");
  await page.getByRole("combobox", { name: "Flown once" }).selectOption("steps");
  await page.getByRole("button", { name: "Start" }).click();
  await until(page, "the experiment", async () => (await text(page, "experiment")) === "steps");
  await page.getByRole("button", { name: "Back to the programme" }).click();
  await until(page, "no experiment", async () => (await text(page, "experiment")) === "none");
  assert.deepEqual(wrong, []);
  await page.evaluate(() => { document.getElementById("setpoint-form").noValidate = true; });
  await page.getByLabel("Number, mm").evaluate((input) => { input.removeAttribute("max"); input.value = 5000; input.dispatchEvent(new Event("input")); });
  await page.getByRole("button", { name: "Send there" }).click();
  await page.getByText("30 to 550 mm").and(page.locator("#reply")).waitFor();
});

test("live: every cycle is drawn on demand", async () => {
  const { page, wrong } = await flying();
  const span = () => page.evaluate(() => charts.times().at(-1) - charts.times()[0]);
  await until(page, "three seconds of states", async () => (await span()) > 3);
  const first = await page.evaluate(() => charts.times()[0]);
  await page.getByLabel("Draw every cycle").check();
  await until(page, "batches", async () => /^\d+ cycles in the last batch, 0 dropped$/.test(await text(page, "rate")));
  // By the rig's clock: the newest drawn are the loop's cycles, not ten states a second.
  await until(page, "neighbouring cycles", async () => {
    const times = await page.evaluate(() => charts.times().slice(-20));
    return times.length === 20 && times.at(-1) - times[0] < 19.5 * 0.02;
  });
  // What was drawn stays; half a minute later its beginning may have left the chart.
  const [kept, shown] = [await page.evaluate(() => charts.times()[0]), await span()];
  assert.ok(kept === first || shown > 29, `drawn from ${first} s before, from ${kept} s after, ${shown} s in all`);
  await shoot(page, "live-full");
  await page.getByLabel("Draw every cycle").uncheck();
  assert.deepEqual(wrong, []);
});

test("live: a batch that began before the last state is drawn once, and a new flight begins a new chart", async () => {
  const { page } = await open();
  const drawn = (from, to) => page.evaluate(([from, to]) => {
    const cycles = Array.from({ length: Math.round((to - from) / 0.02) + 1 }, (_, k) => ({ time_s: from + 0.02 * k, setpoint_mm: 300, position_mm: 300, duty_percent: 21 }));
    charts.add(cycles);
    return [charts.times()[0], Math.round(100 * charts.times().at(-1)) / 100, charts.times().every((time, k, all) => k === 0 || time > all[k - 1])];
  }, [from, to]);
  assert.deepEqual(await drawn(100, 120), [100, 120, true]);
  assert.deepEqual(await drawn(119.89, 120.09), [100, 120.09, true]);
  assert.deepEqual(await drawn(118, 119), [100, 120.09, true]);
  assert.deepEqual(await drawn(0, 1), [0, 1, true]);
});

test("live: lateness and losses of a flight are said", async () => {
  const { page } = await flying();
  await until(page, "the lateness", async () => /^half within \d+ µs, 99 % within \d+ µs, 99\.9 % within \d+ µs, all within \d+ µs$/.test(await text(page, "lateness")));
  assert.match(await text(page, "late"), /^\d+ late cycles; lost: \d+ log messages, \d+ MQTT messages$/);
  assert.equal(await text(page, "fault"), "");
});

test("live: a fault that lasts and the last one of earlier flights are shown, and go when they are over", async () => {
  const { page: speaker } = await flying();
  // A rig of its own says what rig1 says, with a fault.
  const says = (fault) => speaker.evaluate(async ([fault, username, password]) => {
    const client = mqtt.connect(airball.broker(), { username, password, protocolVersion: 4, timerVariant: "native" });
    const state = await new Promise((heard) => {
      client.on("message", (_, payload) => heard(JSON.parse(new TextDecoder().decode(payload))));
      client.on("connect", () => client.subscribe(`${airball.root}state`));
    });
    const say = (name, payload) => client.publishAsync(`airball/faulty/${name}`, payload, { qos: 1, retain: true });
    await say("status", "online");
    await say("state", JSON.stringify({ ...state, fault }));
    await say("fault", JSON.stringify({ at: "2026-01-01T12:00:00Z", fault: "the ball does not move", log: null }));
    client.end();
  }, [fault, RIG_NAME, PASSWORD]);
  await says("no new range for 300 ms");
  const { page } = await open({ url: `${SERVED}?rig=faulty` });
  await connect(page);
  await until(page, "the fault", async () => (await text(page, "fault")) === "no new range for 300 ms");
  await until(page, "the last fault", async () => (await text(page, "last-fault")) === "Last fault, 2026-01-01T12:00:00Z: the ball does not move");
  await says(null);
  await until(page, "no fault", async () => (await text(page, "fault")) === "");
});

test("live: a stop that the broker took for a rig that is offline is not said to be obeyed", async () => {
  const { page: speaker } = await flying();
  await speaker.evaluate(async ([username, password]) => {
    const client = mqtt.connect(airball.broker(), { username, password, protocolVersion: 4, timerVariant: "native" });
    await client.publishAsync("airball/gone/status", "offline", { qos: 1, retain: true });
    client.end();
  }, [RIG_NAME, PASSWORD]);
  const { page } = await open({ url: `${SERVED}?rig=gone` });
  await connect(page);
  await until(page, "the others", async () => (await text(page, "others")).includes("rig1"));
  await page.getByRole("button", { name: "STOP", exact: true }).click();
  await page.getByText("is offline and has not heard it").waitFor();
});

test("live: a page of a rig that is not there leads to those that are", async () => {
  const { page } = await open({ url: `${SERVED}?rig=nobody` });
  await connect(page);
  await follow(page, page.locator("#others").getByRole("link", { name: "rig1" }));
  await login(page);
  assert.equal(new URL(page.url()).searchParams.get("rig"), "rig1");
});

test("live: the wall shows every rig with its state, and leads to its page", async () => {
  const { page: speaker } = await flying();
  const say = (name, payload) => speaker.evaluate(async ([name, payload, username, password]) => {
    const client = mqtt.connect(airball.broker(), { username, password, protocolVersion: 4, timerVariant: "native" });
    await client.publishAsync(`airball/${name}`, payload, { qos: 1, retain: true });
    client.end();
  }, [name, payload, RIG_NAME, PASSWORD]);
  await say("rig10/status", "offline");
  await say("rig2/status", "online");
  await say("rig2/state", JSON.stringify({ mode: "stopped", stopped_by: "the <b>ball</b> has not moved", fault: null, position_mm: 20, setpoint_mm: 300, duty_percent: 0 }));
  const { page, wrong } = await open({ url: `${SERVED}wall.html`, bypassCSP: true });
  await connect(page);
  const tile = (name) => page.getByRole("listitem").filter({ has: page.getByRole("link", { name, exact: true }) });
  await tile("rig1").getByText("flying").waitFor();
  assert.match(await tile("rig1").innerText(), /\d+ of \d+ mm, duty \d+\.\d %/);
  await tile("rig2").getByText("the <b>ball</b> has not moved").waitFor();
  await tile("rig10").getByText("offline").waitFor();
  assert.equal(await tile("rig10").getAttribute("data-stale"), "true");
  const names = await page.getByRole("listitem").getByRole("link").allInnerTexts();
  assert.ok(names.indexOf("rig2") < names.indexOf("rig10"), names.join());
  assert.match(await text(page, "count"), /^\d+ rigs, \d+ online, 1 with a fault$/);
  assert.deepEqual(await complaints(page), []);
  await page.setViewportSize(PHONE);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), PHONE.width);
  await shoot(page, "live-wall");
  wrong.length = 0;
  await follow(page, tile("rig1").getByRole("link"));
  await login(page);
  assert.match(await text(page, "rig-state"), /online/);
});

test("live: opened as a file it finds the broker that it is told, once the reader agrees", async () => {
  const { page } = await open({ url: `${pathToFileURL(FILE).href}?broker=${BROKER}` });
  await page.getByRole("button", { name: "Use this broker" }).click();
  await login(page);
  assert.match(await text(page, "link"), /connected/);
});

test("live: a link to the broker of another host is not followed unasked, and never gets what the browser filled in", async () => {
  const elsewhere = BROKER.replace("127.0.0.1", "localhost");
  const { page } = await open({ url: "about:blank" });
  const sent = [];
  page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => sent.push([socket.url(), String(payload)])));
  const filled = () =>
    page.evaluate(
      (login) => {
        for (const [id, value] of Object.entries(login)) {
          const input = document.getElementById(id);
          input.value = value;
          input.dispatchEvent(new Event("input", { bubbles: true }));
        }
      },
      { user: USER_NAME, password: PASSWORD },
    );
  const press = async (name) => {
    await page.locator("#connection").evaluate((details) => (details.open = true));
    await page.getByRole("button", { name, exact: true }).click();
  };
  const there = () => sent.filter(([url]) => url.startsWith(elsewhere));
  await page.goto(`${SERVED}?broker=${elsewhere}`);
  await page.getByText(elsewhere).waitFor();
  await filled();
  await press("Connect");
  await page.getByText("rig online", { exact: true }).waitFor();
  await press("STOP");
  await page.getByText("Stop sent").waitFor();
  assert.deepEqual(there(), []);

  await press("Use this broker");
  await filled();
  await press("Connect");
  await press("STOP");
  await page.getByText("The broker refuses this user").waitFor();
  assert.ok(there().length > 0);
  assert.ok(!there().some(([, payload]) => payload.includes(PASSWORD)));
  await login(page);
  await until(page, "the typed login arrives", () => there().some(([, payload]) => payload.includes(PASSWORD)));
});

test("live: a login that is refused is said, and the form to mend it stands open", async () => {
  const { page } = await open();
  await page.getByText("refuses this user").waitFor();
  assert.ok(await page.getByLabel("Password").isVisible());
  assert.ok(await page.getByLabel("Height, mm").isDisabled());
  assert.ok(await page.getByRole("button", { name: "STOP", exact: true }).isEnabled());
});

for (const colorScheme of ["light", "dark"]) {
  for (const [size, viewport] of Object.entries({ desk: DESK, phone: PHONE })) {
    test(`live: axe finds nothing to complain of and nothing scrolls sideways, ${colorScheme}, ${size}`, async () => {
      const { page } = await flying({ colorScheme, viewport, bypassCSP: true });
      await page.waitForTimeout(3000);
      assert.deepEqual(await complaints(page), []);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
      await shoot(page, `live-${colorScheme}-${size}`);
    });
  }
}

test("live: the first key reaches the stop button, which stays in sight", async () => {
  const { page } = await flying({ viewport: PHONE });
  await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
  assert.ok(await page.getByRole("button", { name: "STOP", exact: true }).evaluate((button) => button.getBoundingClientRect().top >= 0 && button.getBoundingClientRect().bottom < innerHeight));
  await page.reload();
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "stop");
});
