// Flies the simulated rig from the page that `airball run --live` serves itself. tests/tests/live_page.rs starts the flights and says where their
// pages are: URL, of a rig that flies, and PID, its process; STUCK_URL, of one whose ball never moves.

import assert from "node:assert/strict";
import { test } from "node:test";
import { PHONE, browserOfTests, complaints, open as openPage, shoot } from "./browser.mjs";

const { URL: SERVED, STUCK_URL, PID } = process.env;
const PATIENCE = 60_000;

const browser = browserOfTests();

const open = ({ url = SERVED, ...options } = {}) => openPage(browser(), url, { broker: url.replace("http", "ws"), patience: PATIENCE, ...options });

const text = (page, id) => page.locator(`#${id}`).innerText();
const stop = (page) => page.getByRole("button", { name: "STOP", exact: true }).click();

async function until(page, what, look) {
  const deadline = Date.now() + PATIENCE;
  while (!(await look())) {
    assert.ok(Date.now() < deadline, `still not true after ${PATIENCE} ms: ${what}; ${await page.locator("body").innerText()}`);
    await page.waitForTimeout(100);
  }
}

async function flying(options) {
  const opened = await open(options);
  const { page } = opened;
  await page.getByText("rig online", { exact: true }).waitFor();
  await until(page, "a state", async () => (await text(page, "mode")) !== "–");
  if ((await text(page, "mode")) === "stopped") await page.getByRole("button", { name: "Fly again" }).click();
  await until(page, "flying", async () => (await text(page, "mode")) === "flying");
  return opened;
}

test("served: the page flies the rig without broker and login", async () => {
  const { page, wrong } = await flying();
  assert.ok(await page.locator("#connection").isHidden());
  await page.getByLabel("Number, mm").fill("430");
  await page.keyboard.press("Enter");
  await until(page, "the ball is at 430 mm", async () => Math.abs(Number(await text(page, "position")) - 430) < 25);
  await page.getByLabel("Draw every cycle").check();
  await until(page, "batches", async () => /^\d+ cycles in the last batch, 0 dropped$/.test(await text(page, "rate")));
  assert.deepEqual(wrong, []);
});

test("served: the critical gain stands beside K_p, and more than half of it is warned of before it is sent", async () => {
  const { page } = await flying();
  await until(page, "the critical gain", async () => /oscillates from K_p = 0\.0\d+ on/.test(await text(page, "critical")));
  const critical = Number(/K_p = (\S+) on/.exec(await text(page, "critical"))[1]);
  const gain = page.getByLabel("K_p, %/mm");
  assert.equal(await text(page, "gain-warning"), "");
  await gain.fill(String(0.6 * critical));
  await until(page, "a warning", async () => (await text(page, "gain-warning")).includes("above half of the critical"));
  await shoot(page, "live-critical");
  await gain.fill(String(0.4 * critical));
  await until(page, "no warning", async () => (await text(page, "gain-warning")) === "");
});

test("served: the stop button stops the fan and what it said goes when the ball flies again", async () => {
  const { page, wrong } = await flying();
  await stop(page);
  await until(page, "stopped", async () => (await text(page, "mode")) === "stopped" && (await text(page, "duty")) === "0.00");
  assert.match(await text(page, "stop-said"), /the flight has it/);
  await page.getByRole("button", { name: "Fly again" }).click();
  await until(page, "nothing said", async () => (await text(page, "stop-said")) === "" && (await text(page, "mode")) === "flying");
  assert.deepEqual(wrong, []);
});

test("served: the stop button works where every other script has died", async () => {
  const { page: witness } = await flying();
  const context = await browser().newContext();
  const page = await context.newPage();
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(String(error)));
  await page.addInitScript(() => Object.defineProperty(window, "mqtt", { set() { throw new Error("broken"); } }));
  await page.goto(SERVED);
  assert.match(wrong.join(), /broken/);
  assert.equal(await page.evaluate(() => typeof uPlot), "undefined");
  await stop(page);
  await until(witness, "stopped", async () => (await text(witness, "mode")) === "stopped");
  await witness.getByRole("button", { name: "Fly again" }).click();
});

test("served: a link that names another broker is not followed", async () => {
  const { page, wrong } = await open({ url: `${SERVED}?broker=ws://localhost:1` });
  await page.getByText("stays there").waitFor();
  await page.getByText("rig online", { exact: true }).waitFor();
  assert.deepEqual(wrong.filter((one) => one.includes("localhost:1")), []);
});

test("served: a page of another origin gets neither messages nor the stop button", async () => {
  const { page } = await flying();
  const socket = SERVED.replace("http", "ws");
  const heard = await page.context().newPage().then(async (other) => {
    await other.goto("data:text/html,<p>another site</p>");
    return other.evaluate((address) => new Promise((end) => {
      const socket = new WebSocket(address, "mqtt");
      socket.onopen = () => end("open");
      socket.onerror = () => end("refused");
    }), socket);
  });
  assert.equal(heard, "refused");
});

test("served: a fault is said in the bar, the fan stays off, and the ball is flown again without starting the program", async () => {
  const { page } = await open({ url: STUCK_URL });
  const fault = async () => /has not moved.*The fan is off\. Then press "Fly again"/.test(await text(page, "fault"));
  await until(page, "the fault", fault);
  assert.equal(await text(page, "mode"), "stopped");
  assert.ok(await page.locator(".bar #fault").isVisible());
  await shoot(page, "live-fault");
  await page.getByRole("button", { name: "Fly again" }).click();
  await until(page, "flying again", async () => (await text(page, "mode")) === "flying" && (await text(page, "fault")) === "");
  assert.match(await page.locator(".bar #last-fault").innerText(), /^Last fault, .*has not moved/);
  await until(page, "the ball is still stuck", fault);
});

for (const colorScheme of ["light", "dark"]) {
  test(`served: axe finds nothing to complain of and nothing scrolls sideways on a phone, ${colorScheme}`, async () => {
    const { page } = await flying({ colorScheme, viewport: PHONE, bypassCSP: true });
    assert.deepEqual(await complaints(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), PHONE.width);
  });
}

test("served: where the program has ended, what is shown is greyed, and the stop button says that nobody hears it", async () => {
  const { page } = await flying({ bypassCSP: true });
  const colour = () => page.locator("#position").evaluate((element) => getComputedStyle(element).color);
  const alive = await colour();
  process.kill(Number(PID), "SIGINT");
  await until(page, "greyed", async () => (await page.locator("body").getAttribute("data-stale")) === "true");
  assert.notEqual(await colour(), alive);
  assert.match(await text(page, "mode"), /^was /);
  assert.deepEqual(await complaints(page), []);
  await shoot(page, "live-gone");
  await stop(page);
  await page.getByText("Switch off the fan's supply").waitFor();
});
