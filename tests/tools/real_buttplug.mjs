// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A real Buttplug server, npm's buttplug-wasm (version 3 of the protocol), on a WebSocket of this computer. A browser's Bluetooth is simulated,
// and on it an "Aneros Vivi" with two vibrators of 127 steps. It prints a line for all that happens:
//   port PORT       first
//   got, said TEXT  a message of the client, of the server
//   write BYTES     to the device
// Usage: node real_buttplug.mjs [hold]    in a folder with node_modules; hold: the device never confirms a level, only zeros before it
import { readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { pathToFileURL } from "node:url";

const holds = process.argv.includes("hold");
const say = (...words) => console.log(...words);

// ---- Bluetooth, as a browser has it ----
const write = async (data) => {
  say("write", Buffer.from(data).toString("hex"));
  if (holds && data[1] > 0) await new Promise(() => {});
};
const service = { getCharacteristic: async () => ({ writeValue: write }) };
const device = { id: "simulated", name: "Massage Demo" };
device.gatt = { connect: async () => device.gatt, getPrimaryService: async () => service };
globalThis.Window = class {
  static [Symbol.hasInstance](value) {
    return value === globalThis;
  }
};
globalThis.window = globalThis.self = globalThis;
Object.defineProperty(globalThis, "navigator", { value: { bluetooth: { requestDevice: async () => device } } });

// ---- the server: one for each client, made before it comes, as that takes seconds ----
const require = createRequire(process.cwd() + "/");
const folder = join(dirname(require.resolve("buttplug-wasm/package.json")), "dist");
const wasm = await import(pathToFileURL(join(folder, readdirSync(folder).find((name) => name.startsWith("buttplug_wasm")))));
await wasm.__tla;
class Server {
  waiting = []; // until the device was found
  hear = (bytes) => {
    const text = new TextDecoder().decode(bytes);
    say("said", text);
    this.socket.send(text);
    if (text.includes("ServerInfo")) this.tell('[{"StartScanning":{"Id":4000000000}}]');
    if (!text.includes("DeviceAdded")) return;
    for (const held of this.waiting.splice(0)) this.tell(held);
    this.waiting = null;
  };
  pointer = wasm.buttplug_create_embedded_wasm_server(this.hear);
  tell(text) {
    wasm.buttplug_client_send_json_message(this.pointer, new TextEncoder().encode(text), this.hear);
  }
}
const servers = [new Server(), new Server()]; // a feel-test connects twice: it asks for the motors' names first
const { WebSocketServer } = require("ws");
const sockets = new WebSocketServer({ host: "127.0.0.1", port: 0 });
sockets.on("listening", () => say("port", sockets.address().port));
sockets.on("connection", (socket) => {
  let server = null;
  socket.on("message", (data) => {
    const text = data.toString();
    say("got", text);
    if (text.includes("ProtocolVersionMajor")) {
      // This wrapper of the server panics at a greeting of version 4, to which Intiface answers an error.
      socket.send('[{"Error":{"Id":0,"ErrorMessage":"not of version 3","ErrorCode":3}}]');
      return;
    }
    server ??= servers.shift();
    server.socket = socket;
    if (server.waiting && text.includes("RequestDeviceList")) server.waiting.push(text);
    else server.tell(text);
  });
});
