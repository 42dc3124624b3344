// The tracker's picture. It is requested only while it is visible.

import {find, pollWhileSeen, setText} from "./dom.js";
import {number} from "./format.js";

export class CameraPicture {
  constructor(stream) {
    const picture = find("camera-picture");
    let available = false;
    stream.on(
        "camera",
        (camera) => {
          available = camera.picture === true;
          find("show-camera-label").hidden = false;
          setText(
              find("camera-text"),
              `${camera.state ?? ""} ${camera.width_px ?? "?"} × ${camera.height_px ?? "?"} px, ` +
                  `${number(camera.fps)} frames per second${
                      camera.trouble ? `; ${camera.trouble}` :
                                       ""}${available ? "" : "; no picture"}`);
          picture.hidden = !available;
        },
        () => {
          available = false;
          find("show-camera").checked = false;
          find("show-camera-label").hidden = find("camera").hidden = true;
        });
    find("show-camera").addEventListener("change", (event) => {
      find("camera").hidden = !event.target.checked;
    });
    let count = 0;
    pollWhileSeen(find("camera"), 200, async () => {
      if (!available || !stream.connected) return;
      count += 1;
      await new Promise((done) => {
        picture.onload = picture.onerror = done;
        picture.src = `/api/camera.jpg?n=${
            count}`;  // a new address, or the browser would show the cached one
      });
    });
  }
}
