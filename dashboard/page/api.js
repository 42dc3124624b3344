// Questions to the server, and wishes.

function tokenOfAddress() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) sessionStorage.setItem("lab-token", given);
  return given ?? sessionStorage.getItem("lab-token") ?? "";
}

let token = tokenOfAddress();
addEventListener("hashchange", () => {
  token = tokenOfAddress();
});

function request(path, options = {}, patience = 4000) {
  return fetch(path, {
    ...options,
    cache: "no-store",
    headers: {"X-Lab-Token": token, ...options.headers},
    signal: AbortSignal.timeout(patience),
  });
}

/** @return the JSON, null: there is none, or nobody answers. */
export async function get(path) {
  const {ok, answer} = await ask(path);
  return ok ? answer : null;
}

/** @return the bytes, null: there are none. */
export async function getBytes(path) {
  try {
    const response = await request(path);
    return response.ok ? new Uint8Array(await response.arrayBuffer()) : null;
  } catch {
    return null;
  }
}

/** @return {ok, answer, error}: `error` in words when it was not given or not taken. */
export async function ask(path, options = {}, patience = 4000) {
  try {
    const response = await request(path, options, patience);
    const answer = await response.json().catch(() => null);
    if (response.ok) return {ok: true, answer};
    return {ok: false, answer, error: answer?.error ?? `the server answers ${response.status}`};
  } catch (error) {
    const late = error.name === "TimeoutError";
    return {ok: false, error: late ? "the server does not answer" : "the server cannot be reached"};
  }
}

export const post = (path, body, patience) =>
    ask(path, {
      method: "POST",
      headers: {"Content-Type": "application/json"},
      body: JSON.stringify(body),
      keepalive: true,   // a wish survives the page that sent it
      priority: "high",  // and waits behind no question
    },
        patience);

export const wish = (name, fields = {}, patience = 4000) =>
    post("/api/wish", {wish: name, ...fields}, patience);
