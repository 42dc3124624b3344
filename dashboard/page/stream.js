// The lab's state by topic, received from /api/stream.
//
// Uses fetch instead of EventSource: topics need not be listed in advance, a refusal (503) is tried
// again, and a slow page does not queue states; it leaves them to the server, which skips old ones.

const SILENT_MS =
    6000;  // the server sends once per second; after this time the connection counts as dead

export class Stream {
  topics = new Map();
  connected = false;
  lastPulse = 0;  // [ms] performance.now()
  attempts = 0;
  hiddenTimeout = 20000;  // [ms] a hidden page then closes its connection, because a browser has
                          // only six per server
  #listeners = [];
  #abort = null;
  #lastBytes = 0;
  #hidden = false;

  /**
   * Calls call(value, topic) after each change of a topic, and gone(topic) when it is removed.
   * "pool/" stands for all topics that begin with it.
   */
  on(topic, call, gone = topic.endsWith("/") ? () => call() : () => {}) {
    this.#listeners.push({topic, call, gone});
    for (const [known, value] of this.topics)
      if (matches(topic, known)) call(value, known);
  }

  /** All [topic, value] that begin with `start`. */
  all(start) {
    return [...this.topics].filter(([topic]) => topic.startsWith(start));
  }

  /** Removes all topics that begin with `start`, because they belong to an earlier run or time. */
  remove(start) {
    for (const [topic] of this.all(start)) this.#drop(topic);
  }

  /** Frees a connection for an urgent request: a browser has only six per server. */
  makeRoom() {
    this.#abort?.abort();
  }

  run() {
    setInterval(() => {
      if (this.#abort && performance.now() - this.#lastBytes > SILENT_MS) this.#abort.abort();
    }, 1000);
    let timer = 0;
    document.addEventListener("visibilitychange", () => {
      clearTimeout(timer);
      if (!document.hidden)
        this.#hidden = false;
      else
        timer = setTimeout(() => {
          this.#hidden = true;
          this.#abort?.abort();
        }, this.hiddenTimeout);
    });
    this.#keepListening();
  }

  async #keepListening() {
    let pause = 0;
    for (;;) {
      await new Promise((done) => setTimeout(done, pause));
      pause = Math.min(3000, pause + 500);
      if (this.#hidden) continue;
      try {
        await this.#listen();
      } catch {
        // connection.js shows the problem; here the connection is only tried again.
      }
      if (this.connected) pause = 300;
      this.connected = false;
      this.#abort = null;
      this.attempts += 1;
    }
  }

  async #listen() {
    this.#abort = new AbortController();
    this.#lastBytes = performance.now();
    const response = await fetch("/api/stream", {signal: this.#abort.signal, cache: "no-store"});
    if (!response.ok) throw new Error(String(response.status));
    this.connected = true;
    const decoder = new TextDecoder();
    const reader = response.body.getReader();
    let rest = "";
    for (;;) {
      const {value, done} = await reader.read();
      if (done) return;
      this.#lastBytes = performance.now();
      rest += decoder.decode(value, {stream: true}).replaceAll("\r", "");
      const end = rest.lastIndexOf("\n\n");
      if (end < 0) continue;
      this.#take(rest.slice(0, end));
      rest = rest.slice(end + 2);
    }
  }

  /** Of events that arrive together, only the newest of each topic is used. */
  #take(text) {
    const changes = new Map();
    for (const event of text.split("\n\n")) {
      let topic = "";
      const data = [];
      for (const line of event.split("\n")) {
        if (line.startsWith("event:"))
          topic = line.slice(6).trim();
        else if (line.startsWith("data:"))
          data.push(line.slice(5));
      }
      if (!topic || !data.length) continue;
      changes.delete(topic);
      changes.set(topic, data.join("\n"));
    }
    for (const [topic, data] of changes) this.#update(topic, data);
  }

  #update(topic, data) {
    let value;
    try {
      value = JSON.parse(data);
    } catch {
      console.error(`topic ${topic}: not JSON`);
      return;
    }
    if (value === null) {
      this.#drop(topic);
      return;
    }
    this.topics.set(topic, value);
    if (topic === "pulse") this.lastPulse = performance.now();
    this.#each(topic, ({call}) => call(value, topic));
  }

  #drop(topic) {
    if (this.topics.delete(topic)) this.#each(topic, ({gone}) => gone(topic));
  }

  #each(topic, notify) {
    for (const listener of this.#listeners) {
      if (!matches(listener.topic, topic)) continue;
      try {
        notify(listener);  // a part that fails must not stop the others
      } catch (error) {
        console.error(`topic ${topic}:`, error);
      }
    }
  }
}

const matches = (wanted, topic) =>
    wanted === topic || (wanted.endsWith("/") && topic.startsWith(wanted));
