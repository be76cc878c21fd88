// Where broker, rig and login are found.
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
  /** The address of another page of this one's broker: of a rig, or of all. */
  const pageOf = (file, rig) => {
    const query = new URLSearchParams({ ...(rig && { rig }), ...(wanted && { broker: wanted }) });
    return `${file}${query.size ? `?${query}` : ""}`;
  };
  /** Takes one message. One that is empty, damaged or of another version is left out, and the next are heard. */
  const attempt = (take) => {
    try {
      take();
    } catch (error) {
      console.warn("a message was left out:", error);
    }
  };
  return { attempt, broker, login, pageOf, root };
})();
