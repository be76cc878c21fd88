// The stop button. It needs nothing else of this page but where the broker is: every press dials it on a connection of its own and says `stop`
// in four packets of MQTT 3.1.1, until the broker has acknowledged it. It shares the tab's thread: a tab that hangs takes it along.
(() => {
  "use strict";
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
  const stop = () => packet(0x32, [...word(`${airball.root}set/mode`), 0, 1, ...new TextEncoder().encode("stop")]);

  const button = document.getElementById("stop");
  const said = document.getElementById("stop-said");
  const say = (text) => (said.textContent = text);
  const SUPPLY = "Switch off the fan's supply.";
  // A page that a flight serves has no broker.
  const served = document.documentElement.dataset.served !== undefined;
  // Whether the rest of the page knows that no rig is online; it may not run.
  const alone = () => document.body.dataset.online === "false";

  const dial = (left) => {
    let over = false;
    const again = (why) => {
      if (over) return;
      over = true;
      if (left > 1) setTimeout(() => dial(left - 1), PAUSE_MS);
      else say(`The stop did not get through: ${why}. ${SUPPLY}`);
    };
    try {
      const socket = new WebSocket(airball.broker(), "mqtt");
      socket.binaryType = "arraybuffer";
      socket.onopen = () => socket.send(connect(airball.login()));
      socket.onclose = () => again(`no broker at ${airball.broker()}`);
      let heard = [];
      socket.onmessage = ({ data }) => {
        heard.push(...new Uint8Array(data));
        // Both answers that can come have four bytes.
        for (; heard.length >= 4; heard = heard.slice(4)) {
          if (heard[0] === 0x20 && heard[3] === 0) socket.send(stop());
          else if (heard[0] === 0x40) {
            over = true;
            const who = served ? "the flight" : "the broker";
            say(`Stop sent: ${who} has it.`);
            socket.close();
            document.dispatchEvent(new Event("stop-sent"));
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
    say(alone() ? "Stopping, though no rig is online…" : "Stopping…");
    dial(TRIES);
  });
})();
