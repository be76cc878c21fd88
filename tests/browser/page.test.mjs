// Opens pages of airball in Debian's Chromium. PAGES is the directory that they are in; scripts/setup browser installs what this needs.
// SHOTS, a directory: pictures of the pages are left there, to be looked at. PART: 0 or 1, the half of the pages that is tested, so that two
// processes share them; without it all are.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { DESK, PHONE, browserOfTests, complaints, invalid, open as openPage, shoot } from "./browser.mjs";

/** Each page, with how many figures it has at least, and the ink of a line that is both in a figure and in a chart that zooms, if it has one. */
const PAGES = {
  report: { figures: 4, ink: "nominal" },
  replay: { figures: 3, ink: "nominal" },
  "grey-box": { figures: 7, ink: "mended" },
  transient: { figures: 6, ink: "setpoint" },
  "third-pole": { figures: 5, ink: "recorded" },
  "dead-zone": { figures: 3, ink: "recorded" },
  "critical-gain": { figures: 3, ink: "recorded" },
  steps: { figures: 3, ink: "recorded" },
  square: { figures: 3, ink: "recorded" },
  "force-curve": { figures: 3, ink: "recorded" },
  "noise-floor": { figures: 3, ink: "recorded" },
  calibration: { figures: 3, ink: "recorded" },
  design: { figures: 8, ink: "nominal" },
  unstable: { figures: 5 },
  observer: { figures: 0 },
  models: { figures: 0 },
};
/** The entries of the tested pages. */
const tested = (of) => Object.entries(of).filter(([name]) => !process.env.PART || Object.keys(PAGES).indexOf(name) % 2 === Number(process.env.PART));
const path = (name) => join(process.env.PAGES, `${name}.html`);
/** How the patches begin that pages offer to copy. */
const PATCHES = { report: /^\[plant\]\ngain_mm_per_s2_per_percent = /, "grey-box": /\n\[plant\]\n/, "dead-zone": /^\[/, "force-curve": /^\[/, "noise-floor": /^\[/, design: /^\[controller/, observer: /^\[observer\]/, models: /^# Critical gain/ };

const browser = browserOfTests();

const open = (name, options) => openPage(browser(), pathToFileURL(path(name)).href, options);
const shown = (page) => page.locator("#record-charts").evaluate((place) => [place.dataset.from, place.dataset.to].map(Number));

for (const [name, { figures: fewest, ink }] of tested(PAGES)) {
  test(`${name}: opens without an error, a request or a script of a stranger, and is small`, async () => {
    const { page, wrong } = await open(name);
    if (ink) await page.waitForSelector(".uplot");
    assert.deepEqual(wrong, []);
    assert.equal(await page.locator("img, iframe, object, link").count(), 0);
    assert.match(await page.locator(".top").innerText(), /<img src=x onerror=alert\(1\)>/);
    assert.ok(readFileSync(path(name)).length < 3e6);
  });

  test(`${name}: is valid HTML`, async () => {
    assert.deepEqual(await invalid(path(name)), []);
  });

  for (const colorScheme of ["light", "dark"]) {
    for (const [size, viewport] of Object.entries({ desk: DESK, phone: PHONE })) {
      test(`${name}: axe finds nothing to complain of, ${colorScheme}, ${size}`, async () => {
        const { page } = await open(name, { colorScheme, viewport, bypassCSP: true });
        assert.deepEqual(await complaints(page), []);
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
    await shoot(page, `${name}-zoomed`, false);
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

for (const [name, beginning] of tested(PATCHES)) {
  test(`${name}: the patch is copied as it is in the file`, async () => {
    const { page } = await open(name, { permissions: ["clipboard-read", "clipboard-write"] });
    const patch = await page.locator("#patch").innerText();
    assert.match(patch, beginning);
    await page.locator("[data-copy=patch]").click();
    await page.getByRole("button", { name: "Copied" }).waitFor();
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), `${patch}\n`);
  });
}
