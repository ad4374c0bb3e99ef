// The way to the server: a socket that is opened again when it breaks, and requests. All of them
// carry the token that the page's own address has.

import { decodeFrame } from "./frame.js";

/** @import { Frame } from "./frame.js" */
/** @import { Status } from "./types.js" */

/** @typedef {{[name: string]: string | number | boolean}} Query */

/**
 * The handlers of messages.
 * @typedef {object} Listener
 * @property {(status: Status) => void} onStatus
 * @property {(frame: Frame) => void} onFrame
 * @property {(seconds: number | null) => void} onBreak The way broke, and is tried again after so
 *   many seconds; null: it is there again.
 */

/**
 * The wait before another try: twice as long each time, up to a quarter of a minute.
 * @param {number} tries
 */
export function backoff(tries) {
  return Math.min(0.5 * 2 ** tries, 15);
}

/**
 * An address on this server.
 * @param {string | null} token
 * @param {string} path
 * @param {Query} query
 */
export function address(token, path, query = {}) {
  const parts = Object.entries(query).map(([name, value]) => [name, String(value)]);
  if (token !== null) parts.push(["token", token]);
  const search = new URLSearchParams(parts).toString();
  return search === "" ? path : `${path}?${search}`;
}

export class Link {
  /** @param {Listener} listener */
  constructor(listener) {
    this.listener = listener;
    this.token = new URLSearchParams(location.search).get("token");
    this.tries = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
    this.open();
  }

  open() {
    const url = new URL(this.url("/live"), location.href);
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = () => this.wait();
    this.socket = socket;
  }

  /** @param {string | ArrayBuffer} data */
  receive(data) {
    // Only a message shows that the server is there: something else may answer at its port.
    this.tries = 0;
    if (typeof data === "string") {
      this.listener.onBreak(null);
      this.listener.onStatus(JSON.parse(data));
    } else {
      this.listener.onFrame(decodeFrame(data));
    }
  }

  wait() {
    const seconds = backoff(this.tries);
    this.tries += 1;
    this.listener.onBreak(seconds);
    setTimeout(() => this.open(), 1000 * seconds);
  }

  /**
   * Sends a command; false where the server is away.
   * @param {string} command
   * @param {{[name: string]: unknown}} fields
   */
  send(command, fields = {}) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify({ command, ...fields }));
    return true;
  }

  /**
   * @param {string} path
   * @param {Query} query
   */
  url(path, query = {}) {
    return address(this.token, path, query);
  }

  /**
   * Asks for JSON.
   *
   * Errors: what the server says is wrong, or that it is away.
   * @template T
   * @param {string} path
   * @param {Query} query
   * @returns {Promise<T>}
   */
  async ask(path, query) {
    const answer = await fetch(this.url(path, query)).catch(() => {
      throw new Error("the server does not answer");
    });
    const body = await answer.json().catch(() => ({}));
    if (!answer.ok) throw new Error(body.error ?? `the server answers ${answer.status}`);
    return body;
  }
}
