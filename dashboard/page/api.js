// Requests to the server.

function tokenOfAddress() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) {
    sessionStorage.setItem("lab-token", given);
    // The address bar is seen over shoulders, kept in the history and copied into messages.
    history.replaceState(history.state, "", location.pathname + location.search);
  }
  return given ?? sessionStorage.getItem("lab-token") ?? "";
}

let token = tokenOfAddress();
addEventListener("hashchange", () => {
  token = tokenOfAddress();
});

function request(path, options = {}, timeout = 4000) {
  return fetch(path, {
    ...options,
    cache: "no-store",
    headers: {"X-Lab-Token": token, ...options.headers},
    signal: AbortSignal.timeout(timeout),
  });
}

/** @return the JSON; null if there is none or the server does not respond */
export async function get(path) {
  const {ok, answer} = await ask(path);
  return ok ? answer : null;
}

/** @return the bytes; null if there are none */
export async function getBytes(path) {
  try {
    const response = await request(path);
    return response.ok ? new Uint8Array(await response.arrayBuffer()) : null;
  } catch {
    return null;
  }
}

/** @return {ok, answer, error}; `error` is a text for the user if the request failed */
export async function ask(path, options = {}, timeout = 4000) {
  try {
    const response = await request(path, options, timeout);
    const answer = await response.json().catch(() => null);
    if (response.ok) return {ok: true, answer};
    return {
      ok: false,
      answer,
      error: answer?.error ?? `the server responds with status ${response.status}`
    };
  } catch (error) {
    const late = error.name === "TimeoutError";
    return {
      ok: false,
      error: late ? "the server does not respond" : "the server cannot be reached"
    };
  }
}

export const post = (path, body, timeout) =>
    ask(path, {
      method: "POST",
      headers: {"Content-Type": "application/json"},
      body: JSON.stringify(body),
      keepalive: true,   // the request is completed even if the page is closed
      priority: "high",  // it goes before the queries
    },
        timeout);

/** Sends a request of the operator (docs/dashboard.md). */
export const sendRequest = (name, fields = {}, timeout = 4000) =>
    post("/api/request", {request: name, ...fields}, timeout);
