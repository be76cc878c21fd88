// What tests in a browser share: Debian's Chromium, and the judges of a page.

import assert from "node:assert/strict";
import { accessSync, constants, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, afterEach, before } from "node:test";
import { join } from "node:path";
import { FileSystemConfigLoader, HtmlValidate } from "html-validate";
import { chromium } from "playwright-core";

export const DESK = { width: 1280, height: 900 };
export const PHONE = { width: 390, height: 844 };
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

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

/** Starts the browser before the tests of a file and ends it after them. Returns a function that gives it. */
export function browserOfTests() {
  let browser;
  before(async () => {
    browser = await chromium.launch({ executablePath: installed(), args: ["--no-sandbox"] });
  });
  // A page that stays open slows the tests after it.
  afterEach(() => Promise.all(browser.contexts().map((context) => context.close())));
  after(() => browser.close());
  return () => browser;
}

/** Opens a page and collects what it must not have: errors, dialogs, requests of anybody but its `broker`. `patience`: of what waits, ms. */
export async function open(browser, url, { broker, patience, ...options } = {}) {
  const context = await browser.newContext({ viewport: DESK, ...options });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && wrong.push(message.text()));
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("dialog", (dialog) => wrong.push(dialog.message()) && dialog.dismiss());
  page.on("request", (request) => !request.isNavigationRequest() && !request.url().startsWith("data:") && wrong.push(request.url()));
  page.on("websocket", (socket) => !(broker && new URL(socket.url()).host === new URL(broker).host) && wrong.push(socket.url()));
  await page.goto(url);
  if (patience) page.setDefaultTimeout(patience);
  return { page, wrong };
}

/** What axe complains of. The page needs a context that bypasses its policy. */
export async function complaints(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => axe.run({ runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] }));
  return violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((node) => node.html.slice(0, 160)).join(" | ")}`);
}

/** What is invalid in a file of HTML. */
export async function invalid(path) {
  const rules = { "no-inline-style": "off", "long-title": "off", "no-trailing-whitespace": "off", "wcag/h32": "off" };
  const loader = new FileSystemConfigLoader({ root: true, extends: ["html-validate:recommended"], rules });
  const report = await new HtmlValidate(loader).validateFile(path);
  const said = report.results.flatMap((result) => result.messages.map((at) => `${at.line}:${at.column} ${at.ruleId}: ${at.message}`));
  return said.slice(0, 20);
}

/** SHOTS, a directory: pictures are left there, to be looked at. */
export async function shoot(page, name, fullPage = true) {
  if (process.env.SHOTS) await page.screenshot({ path: join(process.env.SHOTS, `${name}.png`), fullPage });
}
