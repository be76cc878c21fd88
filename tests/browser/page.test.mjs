// Opens pages of airball in Debian's Chromium. PAGES is the directory that they are in; scripts/setup browser installs what this needs.
// SHOTS, a directory: pictures of the pages are left there, to be looked at.

import assert from "node:assert/strict";
import { accessSync, constants, readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { FileSystemConfigLoader, HtmlValidate } from "html-validate";
import { chromium } from "playwright-core";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** Each page, with how many figures it has at least, and the ink of a line that is both in a figure and in a chart that zooms, if it has one. */
const PAGES = {
  report: { figures: 8, ink: "nominal" },
  replay: { figures: 3, ink: "nominal" },
  "grey-box": { figures: 6, ink: "mended" },
  transient: { figures: 6, ink: "setpoint" },
  "third-pole": { figures: 5, ink: "recorded" },
  "dead-zone": { figures: 3, ink: "recorded" },
  "critical-gain": { figures: 3, ink: "recorded" },
  steps: { figures: 3, ink: "recorded" },
  calibration: { figures: 3, ink: "recorded" },
  design: { figures: 6, ink: "nominal" },
  unstable: { figures: 5 },
  observer: { figures: 0 },
  models: { figures: 0 },
};
const path = (name) => join(process.env.PAGES, `${name}.html`);
/** How the patches begin that pages offer to copy. */
const PATCHES = { report: /^\[plant\]\ngain_mm_per_s2_per_percent = /, "grey-box": /\n\[plant\]\n/, "dead-zone": /^\[/, design: /^\[controller/, observer: /^\[observer\]/, models: /^# Critical gain/ };
const DESK = { width: 1280, height: 900 };
const PHONE = { width: 390, height: 844 };

let browser;
before(async () => {
  browser = await chromium.launch({ executablePath: installed(), args: ["--no-sandbox"] });
});
after(() => browser.close());

function installed() {
  const names = ["chromium", "chromium-browser", "google-chrome"];
  const paths = process.env.PATH.split(":").flatMap((directory) => names.map((name) => join(directory, name)));
  const found = paths.find((path) => {
    try {
      accessSync(path, constants.X_OK);
      return true;
    } catch {
      return false;
    }
  });
  return found ?? assert.fail("no Chromium on the path; scripts/setup browser installs it");
}

/** Opens a page and collects what it must not have: errors, requests, dialogs. */
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: DESK, ...options });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && wrong.push(message.text()));
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("dialog", (dialog) => wrong.push(dialog.message()) && dialog.dismiss());
  page.on("request", (request) => request.url() !== page.url() && request.isNavigationRequest() === false && wrong.push(request.url()));
  await page.goto(pathToFileURL(path(name)).href);
  return { page, wrong };
}

const shown = (page) => page.locator("#record-charts").evaluate((place) => [place.dataset.from, place.dataset.to].map(Number));

for (const [name, { figures: fewest, ink }] of Object.entries(PAGES)) {
  test(`${name}: opens without an error, a request or a script of a stranger, and is small`, async () => {
    const { page, wrong } = await open(name);
    if (ink) await page.waitForSelector(".uplot");
    assert.deepEqual(wrong, []);
    assert.equal(await page.locator("img, iframe, object, link").count(), 0);
    assert.match(await page.locator(".top").innerText(), /<img src=x onerror=alert\(1\)>/);
    assert.ok(readFileSync(path(name)).length < 3e6);
  });

  test(`${name}: is valid HTML`, async () => {
    const rules = { "no-inline-style": "off", "long-title": "off", "no-trailing-whitespace": "off", "wcag/h32": "off" };
    const loader = new FileSystemConfigLoader({ root: true, extends: ["html-validate:recommended"], rules });
    const report = await new HtmlValidate(loader).validateFile(path(name));
    const said = report.results.flatMap((result) => result.messages.map((at) => `${at.line}:${at.column} ${at.ruleId}: ${at.message}`));
    assert.deepEqual(said.slice(0, 20), []);
  });

  for (const colorScheme of ["light", "dark"]) {
    for (const [size, viewport] of Object.entries({ desk: DESK, phone: PHONE })) {
      test(`${name}: axe finds nothing to complain of, ${colorScheme}, ${size}`, async () => {
        const { page } = await open(name, { colorScheme, viewport, bypassCSP: true });
        await page.evaluate(AXE);
        const { violations } = await page.evaluate(() => axe.run({ runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] }));
        assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((node) => node.html.slice(0, 160)).join(" | ")}`), []);
        await shoot(page, `${name}-${colorScheme}-${size}`);
      });
    }
  }

  test(`${name}: a phone shows all without scrolling sideways, in letters that can be read`, async () => {
    const { page } = await open(name, { viewport: PHONE });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), PHONE.width);
    const heights = await page.locator("main svg text").evaluateAll((texts) =>
      texts.filter((text) => text.checkVisibility()).map((text) => parseFloat(text.getAttribute("font-size")) * text.getScreenCTM().a),
    );
    assert.ok((heights.length > 5 || fewest === 0) && Math.min(...heights) > 10.5, `${Math.min(...heights)} px`);
  });

  test(`${name}: the figures are there without a script, and no button that does nothing`, async () => {
    const { page } = await open(name, { javaScriptEnabled: false });
    const figures = page.locator("main svg[role=img]:visible");
    assert.ok((await figures.count()) >= fewest, `${await figures.count()}`);
    for (const figure of await figures.all()) assert.ok((await figure.getAttribute("aria-label")).length > 10);
    assert.equal(await page.locator("button:visible").count(), 0);
  });

  // What follows is of charts, which a loop that is not stable has none of.
  if (!ink) continue;

  test(`${name}: dragging zooms all charts, double-click and keys zoom back and on`, async () => {
    const { page, wrong } = await open(name);
    const chart = page.locator(".u-over").first();
    await chart.scrollIntoViewIfNeeded();
    const [from, to] = await shown(page);
    const box = await chart.boundingBox();
    const at = (share) => [box.x + share * box.width, box.y + box.height / 2];
    await page.mouse.move(...at(0.25));
    await page.mouse.down();
    await page.mouse.move(...at(0.4), { steps: 4 });
    await page.mouse.move(...at(0.5), { steps: 4 });
    await page.mouse.up();
    const zoomed = await shown(page);
    const expected = [0.25, 0.5].map((share) => from + share * (to - from));
    zoomed.forEach((end, k) => assert.ok(Math.abs(end - expected[k]) < 0.02 * (to - from), `${zoomed} s, ${expected} s`));
    await shoot(page, `${name}-zoomed`);
    await page.mouse.dblclick(...at(0.5));
    assert.deepEqual(await shown(page), [from, to]);
    await page.locator(".chart").first().focus();
    await page.keyboard.press("+");
    await page.keyboard.press("ArrowRight");
    const [left, right] = await shown(page);
    assert.ok(Math.abs(right - left - (to - from) / 2) < 0.01 && left > from + 0.2 * (to - from), `${left} to ${right} s`);
    await page.getByRole("button", { name: "Show all" }).click();
    assert.deepEqual(await shown(page), [from, to]);
    assert.deepEqual(wrong, []);
  });

  test(`${name}: the same signal has the theme's colour in the pictures and in the charts`, async () => {
    const { page } = await open(name, { colorScheme: "light" });
    const colours = () =>
      page.evaluate((ink) => {
        const line = document.querySelector(`main svg [stroke="var(--${ink})"]`);
        const label = [...document.querySelectorAll(".u-legend .u-marker")].map((marker) => getComputedStyle(marker).borderTopColor);
        return { line: getComputedStyle(line).stroke, ground: getComputedStyle(document.documentElement).backgroundColor, label };
      }, ink);
    const light = await colours();
    assert.ok(light.label.includes(light.line), JSON.stringify(light));
    await page.emulateMedia({ colorScheme: "dark" });
    const recoloured = (before) => {
      const markers = [...document.querySelectorAll(".u-legend .u-marker")].map((marker) => getComputedStyle(marker).borderTopColor);
      return before.every((colour, k) => k === 0 || colour !== markers[k]);
    };
    await page.waitForFunction(recoloured, light.label);
    const dark = await colours();
    assert.ok(dark.label.includes(dark.line) && dark.line !== light.line && dark.ground !== light.ground, JSON.stringify(dark));
  });

  test(`${name}: on paper the pictures stand in place of the charts, on white`, async () => {
    const { page } = await open(name, { colorScheme: "dark" });
    await page.emulateMedia({ media: "print", colorScheme: "dark" });
    assert.equal(await page.locator(".chart:visible, button:visible, nav:visible").count(), 0);
    assert.ok((await page.locator(".still svg:visible").count()) >= 1);
    assert.equal(await page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor), "rgb(255, 255, 255)");
    if (process.env.SHOTS) await page.pdf({ path: join(process.env.SHOTS, `${name}.pdf`), format: "A4", printBackground: true });
  });
}

for (const [name, beginning] of Object.entries(PATCHES)) {
  test(`${name}: the patch is copied as it is in the file`, async () => {
    const { page } = await open(name, { permissions: ["clipboard-read", "clipboard-write"] });
    const patch = await page.locator("#patch").innerText();
    assert.match(patch, beginning);
    await page.locator("[data-copy=patch]").click();
    await page.getByRole("button", { name: "Copied" }).waitFor();
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), `${patch}\n`);
  });
}

async function shoot(page, name) {
  if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, `${name}.png`), fullPage: !name.endsWith("zoomed") });
}
