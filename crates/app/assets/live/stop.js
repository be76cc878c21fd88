// The stop button. It needs nothing else of this page: every press dials the broker on a connection of its own and says `stop` in four
// packets of MQTT 3.1.1, until the broker has acknowledged it. It shares the tab's thread: a tab that hangs takes it along. Also where broker, rig and login are found, for the rest of the page.
const airball = (() => {
  "use strict";
  const given = document.documentElement.dataset;
  const asked = new URLSearchParams(location.search);
  const sameHost = location.protocol.startsWith("http") ? `${location.protocol.replace("http", "ws")}//${location.host}` : "";
  const own = given.broker || sameHost || given.fallback;
  const host = (address) => (URL.canParse(address) ? new URL(address).hostname : "");
  // Whoever wrote the link may want the login: a broker of another host is dialled once the reader agrees, and gets only what is typed after that.
  const wanted = asked.get("broker");
  const foreign = Boolean(wanted) && host(wanted) !== host(own);
  let agreed = !foreign;
  const broker = () => (wanted && agreed ? wanted : own);
  const root = `airball/${asked.get("rig") || given.rig}/`;
  const typed = new Set();
  const field = (id) => (foreign && agreed && !typed.has(id) ? "" : document.getElementById(id).value);
  const login = () => ({ user: field("user"), password: field("password") });

  if (foreign) {
    const fields = ["user", "password"].map((id) => document.getElementById(id));
    for (const input of fields) {
      // What a browser fills in comes without a kind, as a replacement, or from a script.
      input.addEventListener("input", ({ isTrusted, inputType = "" }) => {
        const byHand = isTrusted && inputType !== "insertReplacementText" && inputType !== "";
        typed[byHand ? "add" : "delete"](input.id);
      });
    }
    const only = Boolean(given.broker);
    const name = wanted.slice(0, 80);
    document.getElementById("foreign").hidden = false;
    document.getElementById("foreign-use").hidden = only;
    document.getElementById("foreign-said").textContent = only
      ? `This link asks for the broker ${name}, but this page is made for ${own} alone and stays there.`
      : `This link asks for the broker ${name}, of another host. It is not used unless you say so, and gets only the login that you type then.`;
    document.getElementById("foreign-use").addEventListener("click", () => {
      agreed = true;
      typed.clear();
      for (const input of fields) [input.value, input.autocomplete] = ["", "off"];
      document.getElementById("foreign").hidden = true;
      document.dispatchEvent(new Event("broker"));
    });
  }

  const PAUSE_MS = 500;
  const TRIES = 20;
  const word = (text) => {
    const bytes = new TextEncoder().encode(text);
    return [bytes.length >> 8, bytes.length & 255, ...bytes];
  };
  const packet = (kind, body) => Uint8Array.of(kind, ...(body.length < 128 ? [body.length] : [(body.length & 127) | 128, body.length >> 7]), ...body);
  const connect = ({ user, password }) => {
    const flags = 2 | (user ? 0x80 : 0) | (user && password ? 0x40 : 0);
    const id = `stop-${Math.random().toString(36).slice(2, 12)}`;
    const names = [id, ...(user ? [user] : []), ...(user && password ? [password] : [])];
    return packet(0x10, [...word("MQTT"), 4, flags, 0, 10, ...names.flatMap(word)]);
  };
  const stop = () => packet(0x32, [...word(`${root}set/mode`), 0, 1, ...new TextEncoder().encode("stop")]);

  const button = document.getElementById("stop");
  const said = document.getElementById("stop-said");
  const say = (text) => (said.textContent = text);
  const SUPPLY = "Switch off the fan's supply.";

  const dial = (left) => {
    let over = false;
    const again = (why) => {
      if (over) return;
      over = true;
      if (left > 1) setTimeout(() => dial(left - 1), PAUSE_MS);
      else say(`The stop did not get through: ${why}. ${SUPPLY}`);
    };
    try {
      const socket = new WebSocket(broker(), "mqtt");
      socket.binaryType = "arraybuffer";
      socket.onopen = () => socket.send(connect(login()));
      socket.onclose = () => again(`no broker at ${broker()}`);
      let heard = [];
      socket.onmessage = ({ data }) => {
        heard.push(...new Uint8Array(data));
        // Both answers that can come have four bytes.
        for (; heard.length >= 4; heard = heard.slice(4)) {
          if (heard[0] === 0x20 && heard[3] === 0) socket.send(stop());
          else if (heard[0] === 0x40) {
            over = true;
            say("Stop sent: the broker has it.");
            socket.close();
          } else {
            over = true;
            say(`The broker refuses this user: mend it under "Connection". ${SUPPLY}`);
            socket.close();
          }
        }
      };
      setTimeout(() => socket.close(), 4 * PAUSE_MS);
    } catch (why) {
      again(why.message);
    }
  };
  button.addEventListener("click", () => {
    say("Stopping…");
    dial(TRIES);
  });
  return { broker, login, root };
})();
