// The lab's state by topic, as /api/stream tells it.
//
// Read with fetch, not EventSource: topics need no list in advance, a refusal (503) is tried again,
// and a page that is too slow leaves bytes with the server, which then skips states instead of
// queueing them here.

const SILENT_MS =
    6000;  // the server speaks once a second; beyond this the connection is taken for dead

export class Stream {
  topics = new Map();
  connected = false;
  lastPulse = 0;  // [ms] performance.now()
  attempts = 0;
  hiddenPatience = 20000;  // [ms] a page that nobody sees gives its connection back: a browser has
                           // six for a server
  #listeners = [];
  #abort = null;
  #lastBytes = 0;
  #hidden = false;

  /**
   * Calls call(value, topic) for each news of a topic; "pool/" stands for all that begin so.
   * gone(topic): it is there no longer. Who listens to a family looks at all of it anyway.
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

  /** Forgets all topics that begin with `start`: they told of an earlier run or place. */
  forget(start) {
    for (const [topic] of this.all(start)) this.#drop(topic);
  }

  /** Frees a connection for what cannot wait: a browser has six for a server. */
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
        }, this.hiddenPatience);
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
        // The banner says it (connection.js); what matters here is to try again.
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

  /** Of what came at once only a topic's newest counts. */
  #take(text) {
    const news = new Map();
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
      news.delete(topic);
      news.set(topic, data.join("\n"));
    }
    for (const [topic, data] of news) this.#tell(topic, data);
  }

  #tell(topic, data) {
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

  #each(topic, tell) {
    for (const listener of this.#listeners) {
      if (!matches(listener.topic, topic)) continue;
      try {
        tell(listener);  // one part that fails must not silence the others
      } catch (error) {
        console.error(`topic ${topic}:`, error);
      }
    }
  }
}

const matches = (wanted, topic) =>
    wanted === topic || (wanted.endsWith("/") && topic.startsWith(wanted));
